//! Golden images and what belongs to them, on disc.

use std::path::{Path, PathBuf};

use image::{Rgb, RgbImage};
use serde::{Deserialize, Serialize};

use super::Draw;
use crate::error::{Error, Result};
use crate::format;
use crate::model::asset::Asset;
use crate::render::camera::{Framing, View as Direction};
use crate::render::{Camera, Settings, Show};
use crate::report::png;

/// Name and version of the schema of `golden.json`.
pub const SCHEMA: &str = "qsplat-golden/2";

/// The file beside the images.
pub const FILE: &str = "golden.json";

/// `golden.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Golden {
    /// [`SCHEMA`].
    pub schema: String,
    /// Width and height of every image, pixels.
    pub size: [u32; 2],
    /// What a view may differ by.
    pub limits: Limits,
    /// The views.
    pub views: Vec<View>,
}

/// What a view may differ by, in FLIP, `[0, 1]`. See the module [`crate::verify`] for why
/// there are three.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Greatest mean.
    pub flip_mean: f64,
    /// Greatest 99th percentile.
    pub flip_p99: f64,
    /// Greatest mean over 8 by 8 pixels.
    pub flip_block: f64,
}

impl Default for Limits {
    /// The CPU reference repeats itself exactly, so these leave room for other renderers only:
    /// 32-bit arithmetic moves a rim by a rounding error, which turns single samples, of which
    /// a pixel has 16. Between CPU and software Vulkan the worst of seven models, with
    /// 96 to 3594 splats, came to 0.00001, 0.00006 and 0.009. Of thirty single splats of three of them,
    /// lifted by five error budgets, those of more than ten budgets' radius came to a block of 0.11 and more,
    /// three of a pixel's size to 0.034 to 0.042.
    fn default() -> Self {
        Self { flip_mean: 0.001, flip_p99: 0.01, flip_block: 0.04 }
    }
}

/// One view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Its name: letters, digits and `-`.
    pub name: String,
    /// What is shown.
    pub show: Show,
    /// From where.
    pub camera: Camera,
}

/// Pixels a side of new goldens: a splat of a hundredth of the model is five pixels wide, and
/// a view takes some ten kilobytes.
const SIDE: u32 = 384;

/// Samples along each side of a pixel. A sample on a rim is all that rounding can turn, and what it then shows may
/// be as far away as a picture has room for, a wall behind a face: with 2 a side one such sample came to a worst
/// block of 0.043, as much as a wrong splat.
const SAMPLES: u32 = 4;

/// `golden.json` above this size is refused unread; a view takes some 400 bytes.
const FILE_LIMIT: u64 = 1 << 20;

/// Views of one directory, at most.
const VIEW_LIMIT: usize = 256;

/// Directions of new goldens: four corners of a cube that are a tetrahedron's. Every part of a
/// convex surface faces at least one of them.
const CORNERS: [(&str, f64, f64); 4] = [
    ("iso", 45.0, 35.264_389_682_754_654),
    ("back", 225.0, 35.264_389_682_754_654),
    ("below-left", 315.0, -35.264_389_682_754_654),
    ("below-right", 135.0, -35.264_389_682_754_654),
];

impl Golden {
    /// Default views, size and limits for an asset: the front, and four corners both shaded
    /// and as normals.
    #[must_use]
    pub fn of(asset: &Asset) -> Self {
        let size = [SIDE, SIDE];
        let camera =
            |direction| Camera::framing(&asset.frame, asset.diagonal, direction, Framing::default(), size);
        let mut views =
            vec![View { name: "front".into(), show: Show::Shaded, camera: camera(Direction::Front) }];
        for (name, azimuth, elevation) in CORNERS {
            let camera = camera(Direction::Angles { azimuth, elevation });
            views.push(View { name: name.into(), show: Show::Shaded, camera });
            views.push(View { name: format!("{name}-normals"), show: Show::Normals, camera });
        }
        Self { schema: SCHEMA.into(), size, limits: Limits::default(), views }
    }

    /// Whether a directory holds goldens.
    #[must_use]
    pub fn exists(directory: &Path) -> bool {
        directory.join(FILE).exists()
    }

    /// Reads and checks `golden.json`.
    ///
    /// # Errors
    /// [`Error::Usage`] if there is none, [`Error::Input`] if it is broken.
    pub fn read(directory: &Path) -> Result<Self> {
        let path = directory.join(FILE);
        let bytes = match std::fs::metadata(&path) {
            Ok(metadata) => metadata.len(),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let what = format!("{} holds no {FILE}; make goldens with --bless", directory.display());
                return Err(Error::Usage(what));
            }
            Err(error) => return Err(Error::io(&path)(error)),
        };
        if bytes > FILE_LIMIT {
            return Err(Error::input(
                &path,
                "file",
                format!("{bytes} bytes are more than the limit of {FILE_LIMIT}"),
            ));
        }
        let text = std::fs::read_to_string(&path).map_err(Error::io(&path))?;
        let golden: Self = serde_json::from_str(&text).map_err(|error| {
            let place = format!("line {}, column {}", error.line(), error.column());
            Error::input(&path, place, format!("{error}; make it anew: delete it and run with --bless"))
        })?;
        golden.sound().map_err(|what| Error::input(&path, "file", what))?;
        Ok(golden)
    }

    fn sound(&self) -> std::result::Result<(), String> {
        if self.schema != SCHEMA {
            return Err(format!(
                "schema `{}` is not `{SCHEMA}`; make it anew with this version",
                self.schema
            ));
        }
        if self.views.is_empty() || self.views.len() > VIEW_LIMIT {
            return Err(format!("{} views; there must be 1 to {VIEW_LIMIT}", self.views.len()));
        }
        let limits = [self.limits.flip_mean, self.limits.flip_p99, self.limits.flip_block];
        if let Some(limit) = limits.iter().find(|limit| !(0.0..=1.0).contains(*limit)) {
            return Err(format!("limit {limit} is not within 0 and 1"));
        }
        let mut names: Vec<&str> = self.views.iter().map(|view| view.name.as_str()).collect();
        // Names become file names, so nothing that a path could be made of.
        let plain =
            |name: &&str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-') && !name.is_empty();
        if let Some(name) = names.iter().find(|name| !plain(name)) {
            return Err(format!("view name `{name}` must be letters, digits and `-`"));
        }
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("two views are named `{}`", pair[0]));
        }
        Ok(())
    }

    /// Draws a view.
    ///
    /// Every picture is drawn larger than it is kept and averaged, data such as normals too, which
    /// the renderer does not antialias: here they are pictures like any other.
    ///
    /// # Errors
    /// Whatever `draw` returns, and [`Error::Internal`] if it gives another size than asked.
    pub(super) fn draw(&self, view: &View, draw: &mut Draw<'_>) -> Result<RgbImage> {
        let plain = Settings { show: view.show, ..Settings::default() };
        let factor = SAMPLES / plain.factor();
        let size = self.size.map(|side| side.saturating_mul(factor));
        let picture = draw(&view.camera, &Settings { size, ..plain })?;
        if picture.dimensions() != size.into() {
            return Err(Error::Internal(format!(
                "asked for {size:?} pixels, drew {:?}",
                picture.dimensions()
            )));
        }
        Ok(averaged(&picture, factor))
    }

    /// Reads the image of a view.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Input`] if it is no PNG or has another size.
    pub fn picture(&self, directory: &Path, view: &View) -> Result<RgbImage> {
        let path = image_path(directory, view);
        let broken = |error: image::ImageError| {
            Error::input(&path, "file", format!("{error}; make it anew with --bless"))
        };
        let mut reader = image::ImageReader::open(&path).map_err(Error::io(&path))?;
        reader.set_format(image::ImageFormat::Png);
        let mut limits = image::Limits::default();
        let [width, height] = self.size;
        (limits.max_image_width, limits.max_image_height) = (Some(width), Some(height));
        reader.limits(limits);
        let picture = reader.decode().map_err(broken)?.to_rgb8();
        if picture.dimensions() != (width, height) {
            let (w, h) = picture.dimensions();
            let what = format!("{w}x{h} pixels, but {FILE} says {width}x{height}; make it anew with --bless");
            return Err(Error::input(&path, "size", what));
        }
        Ok(picture)
    }

    /// Writes the images and, when they are whole, `golden.json`.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub(super) fn write(&self, directory: &Path, pictures: &[RgbImage]) -> Result<()> {
        std::fs::create_dir_all(directory).map_err(Error::io(directory))?;
        for (view, picture) in self.views.iter().zip(pictures) {
            png::write(&image_path(directory, view), picture)?;
        }
        let json = serde_json::to_string_pretty(self)
            .map_err(|error| Error::Internal(format!("{FILE}: {error}")))?;
        let path = directory.join(FILE);
        format::write_file(&path, (json + "\n").as_bytes())
    }
}

/// Means of squares of `factor` by `factor` pixels, as bytes are.
fn averaged(picture: &RgbImage, factor: u32) -> RgbImage {
    let count = factor * factor;
    RgbImage::from_fn(picture.width() / factor, picture.height() / factor, |x, y| {
        let mut sums = [count / 2; 3];
        for place in 0..count {
            let pixel = picture.get_pixel(factor * x + place % factor, factor * y + place / factor).0;
            sums.iter_mut().zip(pixel).for_each(|(sum, byte)| *sum += u32::from(byte));
        }
        Rgb(sums.map(|sum| (sum / count) as u8))
    })
}

fn image_path(directory: &Path, view: &View) -> PathBuf {
    directory.join(format!("{}.png", view.name))
}
