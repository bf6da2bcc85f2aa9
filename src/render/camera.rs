//! The camera, in the input's own coordinates, so that an input and its bake share it.

use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::model::frame::Frame;

/// Where the picture is taken from. Stored as JSON; all lengths in input units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// The eye.
    pub eye: [f64; 3],
    /// What the middle of the picture shows.
    pub target: [f64; 3],
    /// Any direction that points up in the picture; need not be unit nor perpendicular.
    pub up: [f64; 3],
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Least distance along the viewing direction that is drawn; `None` takes
    /// [`NEAR_FRACTION`] of the distance from eye to target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
}

/// How the rays of a picture spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Projection {
    /// Rays through the eye.
    Perspective {
        /// Vertical angle of view, degrees, between 0 and 180 (both excluded).
        fov_degrees: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of the picture in input units, positive.
        height: f64,
    },
}

/// Near plane of a camera that names none, as a fraction of the eye's distance to the target.
pub const NEAR_FRACTION: f64 = 1e-3;

/// Vertical angle of view of [`Projection::default`], degrees: about that of a portrait lens.
pub const DEFAULT_FOV: f64 = 30.0;

/// Room around the bounding sphere in a framed picture, as a factor of its radius.
const FRAMING_MARGIN: f64 = 1.02;

/// Camera files above this size are refused unread: a camera takes some 300 bytes.
const MAX_FILE_BYTES: u64 = 1 << 16;

impl Default for Projection {
    fn default() -> Self {
        Self::Perspective { fov_degrees: DEFAULT_FOV }
    }
}

/// A direction to look from. The up axis is `+Y`; the front looks along `-Z`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum View {
    /// From `+Z`.
    #[default]
    Front,
    /// From `(1, 1, 1)`: the isometric view.
    Iso,
    /// From any direction, in degrees.
    Angles {
        /// Around `+Y`, from `+Z` towards `+X`.
        azimuth: f64,
        /// Above the horizon, in `[-90, 90]`.
        elevation: f64,
    },
}

impl View {
    /// Azimuth and elevation, radians.
    fn angles(self) -> (f64, f64) {
        match self {
            Self::Front => (0.0, 0.0),
            Self::Iso => (std::f64::consts::FRAC_PI_4, libm::atan(std::f64::consts::FRAC_1_SQRT_2)),
            Self::Angles { azimuth, elevation } => (azimuth.to_radians(), elevation.to_radians()),
        }
    }
}

impl std::str::FromStr for View {
    type Err = Error;

    /// `front`, `iso`, or azimuth and elevation as `30,20`.
    fn from_str(text: &str) -> Result<Self> {
        let angles = || {
            let (azimuth, elevation) = text.split_once(',')?;
            let (azimuth, elevation) = (azimuth.trim().parse().ok()?, elevation.trim().parse().ok()?);
            let sound = f64::is_finite(azimuth) && f64::abs(elevation) <= 90.0;
            sound.then_some(Self::Angles { azimuth, elevation })
        };
        match text {
            "front" => Ok(Self::Front),
            "iso" => Ok(Self::Iso),
            _ => angles().ok_or_else(|| {
                Error::Usage(format!(
                    "view `{text}` is none of `front`, `iso` and AZIMUTH,ELEVATION in degrees with \
                     the elevation in -90..90, such as `30,20`"
                ))
            }),
        }
    }
}

impl Camera {
    /// A camera that looks at the middle of a model and holds its bounding sphere.
    ///
    /// `diagonal` is that of the bounding box in model units, `size` the picture's width and
    /// height in pixels.
    #[must_use]
    pub fn framing(frame: &Frame, diagonal: f64, view: View, projection: Framing, size: [u32; 2]) -> Self {
        let (azimuth, elevation) = view.angles();
        let ((sin_a, cos_a), (sin_e, cos_e)) = (libm::sincos(azimuth), libm::sincos(elevation));
        let backward = DVec3::new(cos_e * sin_a, sin_e, cos_e * cos_a);
        let up = DVec3::new(-sin_e * sin_a, cos_e, -sin_e * cos_a);
        // A single point has no diagonal; any distance shows it.
        let radius = if diagonal > 0.0 { 0.5 * diagonal * frame.scale() * FRAMING_MARGIN } else { 1.0 };
        let narrow = (f64::from(size[0]) / f64::from(size[1].max(1))).min(1.0);
        let (distance, projection) = match projection {
            Framing::Perspective { fov_degrees } => {
                let half = libm::atan(libm::tan(0.5 * fov_degrees.to_radians()) * narrow);
                (radius / libm::sin(half), Projection::Perspective { fov_degrees })
            }
            Framing::Orthographic => {
                (2.0 * radius, Projection::Orthographic { height: 2.0 * radius / narrow })
            }
        };
        let eye = frame.origin + distance * backward;
        Self { eye: eye.into(), target: frame.origin.into(), up: up.into(), projection, near: None }
    }

    /// Reads a camera from a JSON file.
    ///
    /// # Errors
    /// [`Error::Io`] when the file cannot be read, [`Error::Input`] with line and column when
    /// it is no camera.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::metadata(path).map_err(Error::io(path))?.len();
        if bytes > MAX_FILE_BYTES {
            return Err(Error::input(
                path,
                "file",
                format!("{bytes} bytes are no camera; give a camera JSON"),
            ));
        }
        let text = std::fs::read_to_string(path).map_err(Error::io(path))?;
        let camera: Self = serde_json::from_str(&text).map_err(|error| {
            let place = format!("line {}, column {}", error.line(), error.column());
            Error::input(
                path,
                place,
                format!("not a camera: {error}; expected fields eye, target, up, projection"),
            )
        })?;
        camera.check().map_err(|error| Error::input(path, "file", error.to_string()))?;
        Ok(camera)
    }

    /// Refuses a camera that sees nothing.
    ///
    /// # Errors
    /// [`Error::Usage`] with the offending value.
    pub fn check(&self) -> Result<()> {
        let fault = |what: String| Err(Error::Usage(format!("camera: {what}")));
        let numbers = self.eye.iter().chain(&self.target).chain(&self.up);
        if let Some(number) = numbers.clone().find(|x| !x.is_finite()) {
            return fault(format!("{number} is not a finite coordinate"));
        }
        let (ahead, up) = self.directions();
        if !(ahead.length() > 0.0 && ahead.is_finite()) {
            return fault(format!("eye and target must differ, both are {:?}", self.eye));
        }
        let slant = ahead.normalize().cross(up.normalize_or_zero()).length();
        if slant <= f64::EPSILON {
            return fault(format!("up {:?} must not be zero nor point along the view", self.up));
        }
        match self.projection {
            Projection::Perspective { fov_degrees } if !(fov_degrees > 0.0 && fov_degrees < 180.0) => {
                fault(format!("fov_degrees is {fov_degrees}; give a value between 0 and 180"))
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                fault(format!("height is {height}; give a positive value"))
            }
            _ if !self.near.is_none_or(|near| near > 0.0 && near.is_finite()) => {
                fault(format!("near is {:?}; give a positive value or leave it out", self.near))
            }
            _ => Ok(()),
        }
    }

    /// Unnormalised viewing and up directions.
    pub(super) fn directions(&self) -> (DVec3, DVec3) {
        (DVec3::from(self.target) - DVec3::from(self.eye), DVec3::from(self.up))
    }
}

/// The projection of a camera that [`Camera::framing`] still has to place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Framing {
    /// Rays through the eye, which moves back until the sphere fits.
    Perspective {
        /// Vertical angle of view, degrees, between 0 and 180.
        fov_degrees: f64,
    },
    /// Parallel rays; the height follows from the sphere.
    Orthographic,
}

impl Default for Framing {
    fn default() -> Self {
        Self::Perspective { fov_degrees: DEFAULT_FOV }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::render::eye::Eye;
    use glam::DVec2;

    fn frame() -> Frame {
        Frame { origin: DVec3::new(1e6, -5.0, 0.25), exponent: 3 }
    }

    fn views() -> Vec<View> {
        let mut views = vec![View::Front, View::Iso];
        for azimuth in [-170.0, -30.0, 0.0, 45.0, 90.0] {
            views
                .extend([-90.0, -45.0, 0.0, 20.0, 90.0].map(|elevation| View::Angles { azimuth, elevation }));
        }
        views
    }

    /// Where a point of the model appears, in samples.
    fn place(eye: &Eye, point: DVec3) -> DVec2 {
        let view = eye.to_view(point);
        let plane = if eye.perspective { view.truncate() / view.z } else { view.truncate() };
        eye.middle() + plane * DVec2::new(1.0, -1.0) * eye.samples_per_unit()
    }

    #[test]
    fn a_framed_sphere_fills_the_picture_and_stays_inside() {
        for view in views() {
            for framing in
                [Framing::default(), Framing::Perspective { fov_degrees: 90.0 }, Framing::Orthographic]
            {
                for size in [[400, 400], [600, 200], [200, 600]] {
                    let camera = Camera::framing(&frame(), 2.0, view, framing, size);
                    let eye = Eye::new(&camera, &frame(), size).unwrap();
                    let tangent = |direction: DVec3| {
                        // Where a ray touches the unit sphere: nearer than the centre.
                        let distance = eye.to_view(DVec3::ZERO).z;
                        let back = if eye.perspective { 1.0 / distance } else { 0.0 };
                        place(&eye, direction * (1.0 - back * back).sqrt() - back * eye.forward)
                    };
                    let (right, up) = (tangent(eye.right), tangent(eye.up));
                    let least = f64::from(size[0].min(size[1]));
                    let reach = (right.x - eye.middle().x).max(eye.middle().y - up.y);
                    assert!(
                        reach < 0.5 * least && reach > 0.45 * least,
                        "{view:?} {framing:?} {size:?} {reach}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_front_has_x_to_the_right_and_y_up() {
        let camera = Camera::framing(&frame(), 2.0, View::Front, Framing::default(), [100, 100]);
        let eye = Eye::new(&camera, &frame(), [100, 100]).unwrap();
        assert!(place(&eye, DVec3::X * 0.5).x > 60.0 && place(&eye, DVec3::Y * 0.5).y < 40.0);
        assert!(eye.forward.distance(DVec3::NEG_Z) < 1e-12);
        let iso = Eye::new(
            &Camera::framing(&frame(), 2.0, View::Iso, Framing::default(), [9, 9]),
            &frame(),
            [9, 9],
        );
        assert!(iso.unwrap().forward.distance(DVec3::splat(-1.0 / 3.0_f64.sqrt())) < 1e-9);
    }

    #[test]
    fn a_ray_runs_through_what_it_shows() {
        for framing in [Framing::default(), Framing::Orthographic] {
            let camera = Camera::framing(&frame(), 2.0, View::Iso, framing, [320, 200]);
            let eye = Eye::new(&camera, &frame(), [320, 200]).unwrap();
            let point = DVec3::new(0.3, -0.2, 0.5);
            let at = place(&eye, point);
            let view = eye.to_view(point);
            assert!(eye.ray(at.x, at.y).at(view.z).distance(view.truncate()) < 1e-12);
        }
    }

    #[test]
    fn json_comes_back_and_faults_are_named() {
        let camera = Camera::framing(&frame(), 2.0, View::Iso, Framing::Orthographic, [320, 200]);
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), serde_json::to_string(&camera).unwrap()).unwrap();
        assert_eq!(Camera::read(file.path()).unwrap(), camera);
        for (text, part) in [
            ("{", "line 1"),
            (
                r#"{"eye":[0,0,1],"target":[0,0,1],"up":[0,1,0],"projection":{"orthographic":{"height":1}}}"#,
                "differ",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"up":[0,0,2],"projection":{"orthographic":{"height":1}}}"#,
                "up",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"up":[0,1,0],"projection":{"orthographic":{"height":0}}}"#,
                "height",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"up":[0,1,0],"projection":{"perspective":{"fov_degrees":180}}}"#,
                "fov",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"up":[0,1,0],"projection":{"orthographic":{"height":1}},"near":-1}"#,
                "near",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"up":[0,1,0],"projection":{"orthographic":{"height":1}},"lens":1}"#,
                "lens",
            ),
        ] {
            std::fs::write(file.path(), text).unwrap();
            let message = Camera::read(file.path()).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn views_are_read() {
        assert_eq!("front".parse::<View>().unwrap(), View::Front);
        assert_eq!("30, -20.5".parse::<View>().unwrap(), View::Angles { azimuth: 30.0, elevation: -20.5 });
        for text in ["", "top", "30", "30,91", "nan,0", "0,nan", "1,2,3"] {
            assert!(text.parse::<View>().is_err(), "{text}");
        }
    }
}
