//! What to draw of a scene, and how large.

use crate::error::{Error, Result};

/// What the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Show {
    /// The lit surface in its colours, or a matte grey.
    #[default]
    Shaded,
    /// The blended unit normal `n`, turned towards the eye, in input coordinates, as the bytes
    /// of `(n + 1) / 2`.
    Normals,
    /// View depth as grey, light near and dark far, over the bounding sphere.
    Depth,
    /// Each splat, or each input triangle or point, in a colour of its own, lit. Of several
    /// splats of one surface, the one seen nearest its centre.
    Splats,
    /// Splats by kind, lit: flat blue, flat and clipped green, cylinder violet, cylinder and
    /// clipped pink, quadric orange, quadric and clipped red.
    Kinds,
}

impl Show {
    /// All of them, in the order of their documentation.
    pub const ALL: [Self; 5] = [Self::Shaded, Self::Normals, Self::Depth, Self::Splats, Self::Kinds];

    /// Whether pixels are data, which no filter may mix.
    #[must_use]
    pub fn is_data(self) -> bool {
        matches!(self, Self::Normals | Self::Depth)
    }

    /// Whether pixels tell which splat they are of.
    #[must_use]
    pub fn is_identity(self) -> bool {
        matches!(self, Self::Splats | Self::Kinds)
    }

    /// The name, as the command line takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaded => "shaded",
            Self::Normals => "normals",
            Self::Depth => "depth",
            Self::Splats => "splats",
            Self::Kinds => "kinds",
        }
    }
}

impl std::str::FromStr for Show {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|show| show.name() == text).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|show| show.name()).collect();
            Error::Usage(format!("cannot show `{text}`; choose one of {}", names.join(", ")))
        })
    }
}

/// One directional light that moves with the camera, and light from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Towards the light, in view coordinates (right, up, forward); need not be unit.
    pub direction: [f64; 3],
    /// Part of the colour that is always seen.
    pub ambient: f64,
    /// Part of the colour that falls with the cosine to the light.
    pub diffuse: f64,
    /// How far the light reaches around: it ends where the cosine is `-wrap`, not at 0, so
    /// that faces turned away still show their shape.
    pub wrap: f64,
    /// Brightness of the highlight (Blinn and Phong), white.
    pub specular: f64,
    /// Exponent of the highlight.
    pub shininess: f64,
}

impl Default for Light {
    /// A key light above the photographer's left shoulder, so far up that the three faces of
    /// a cube's corner differ from every usual view.
    fn default() -> Self {
        Self {
            direction: [-0.3, 0.7, -0.7],
            ambient: 0.15,
            diffuse: 0.85,
            wrap: 0.3,
            specular: 0.06,
            shininess: 40.0,
        }
    }
}

/// How to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Width and height in pixels, each in `1..=MAX_SIDE`.
    pub size: [u32; 2],
    /// What the picture shows.
    pub show: Show,
    /// sRGB and alpha where nothing is hit.
    pub background: [u8; 4],
    /// The light.
    pub light: Light,
    /// Whether each pixel is the mean of 2 by 2 samples. Without effect on normals and depth,
    /// whose pixels are data.
    pub antialias: bool,
}

/// The greatest width and height, pixels.
pub const MAX_SIDE: u32 = 16_384;

/// The most samples of one picture: 512 MiB of colour, more than any screen or poster needs.
pub const MAX_SAMPLES: u64 = 1 << 27;

/// Samples along each side of a pixel when antialiasing.
pub const SUPERSAMPLING: u32 = 2;

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [512, 512],
            show: Show::Shaded,
            background: [255, 255, 255, 255],
            light: Light::default(),
            antialias: true,
        }
    }
}

impl Settings {
    /// Defaults for a size, with one sample a pixel.
    #[must_use]
    pub fn plain(size: [u32; 2]) -> Self {
        Self { size, antialias: false, ..Self::default() }
    }

    /// Samples along each side of a pixel: 1 or [`SUPERSAMPLING`].
    #[must_use]
    pub fn factor(&self) -> u32 {
        if self.antialias && !self.show.is_data() { SUPERSAMPLING } else { 1 }
    }

    /// Width and height in samples.
    ///
    /// # Errors
    /// [`Error::Usage`] for a side of 0 or above [`MAX_SIDE`], for more than [`MAX_SAMPLES`],
    /// or for a light that is not finite or has no direction.
    pub fn samples(&self) -> Result<[u32; 2]> {
        let [width, height] = self.size;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(Error::Usage(format!(
                "a picture of {width}x{height} pixels cannot be drawn; give 1 to {MAX_SIDE} for each side"
            )));
        }
        let samples = [width * self.factor(), height * self.factor()];
        let count = u64::from(samples[0]) * u64::from(samples[1]);
        if count > MAX_SAMPLES {
            return Err(Error::Usage(format!(
                "a picture of {width}x{height} pixels needs {count} samples, the limit is {MAX_SAMPLES}; \
                 give a smaller size or turn antialiasing off"
            )));
        }
        let light = &self.light;
        let amounts = [light.ambient, light.diffuse, light.wrap, light.specular, light.shininess];
        let length: f64 = light.direction.iter().map(|x| x * x).sum();
        if !(amounts.iter().all(|x| x.is_finite() && *x >= 0.0) && length > 0.0 && length.is_finite()) {
            return Err(Error::Usage(format!(
                "{light:?} must be finite, not negative, and have a direction"
            )));
        }
        Ok(samples)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn sizes_are_limited_before_anything_is_allocated() {
        let samples = |size, antialias| Settings { size, antialias, ..Settings::default() }.samples();
        assert_eq!(samples([3, 4], true).unwrap(), [6, 8]);
        assert_eq!(samples([3, 4], false).unwrap(), [3, 4]);
        for size in [[0, 4], [4, 0], [MAX_SIDE + 1, 4], [u32::MAX, u32::MAX], [MAX_SIDE, MAX_SIDE]] {
            assert!(samples(size, true).is_err(), "{size:?}");
        }
    }

    #[test]
    fn data_is_never_filtered() {
        for show in Show::ALL {
            let settings = Settings { show, ..Settings::default() };
            assert_eq!(settings.factor() == 1, show.is_data());
            assert_eq!(show.name().parse::<Show>().unwrap(), show);
        }
        assert!("shiny".parse::<Show>().is_err());
    }

    #[test]
    fn a_light_must_be_one() {
        for light in [
            Light { direction: [0.0; 3], ..Light::default() },
            Light { ambient: f64::NAN, ..Light::default() },
            Light { diffuse: -1.0, ..Light::default() },
            Light { shininess: f64::INFINITY, ..Light::default() },
        ] {
            assert!(Settings { light, ..Settings::default() }.samples().is_err(), "{light:?}");
        }
    }
}
