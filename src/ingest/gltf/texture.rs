//! Base-colour textures, sampled as light.

use std::io::Cursor;

use gltf_json::Index;
use gltf_json::texture::{MagFilter, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use image::ImageReader;

use super::super::color;
use super::document::Document;
use crate::error::{Error, Result};

/// Bytes of a decoded pixel at most (16 bits, four channels), and of the decoder's own copy.
const PIXEL_BYTES: u64 = 2 * 8;

/// A decoded image and how it is read.
pub(super) struct Texture {
    width: usize,
    height: usize,
    /// sRGB levels, row after row from the top.
    pixels: Vec<[u8; 3]>,
    wrap: [WrappingMode; 2],
    nearest: bool,
    /// Linear light of each level.
    linear: [f64; 256],
}

impl Texture {
    pub fn load(document: &Document, index: Index<gltf_json::Texture>) -> Result<Self> {
        let place = format!("textures[{}]", index.value());
        let texture = document.get(index, &place)?;
        let default = Sampler::default();
        let sampler = match texture.sampler {
            Some(sampler) => document.get(sampler, &place)?,
            None => &default,
        };
        let image = document.get(texture.source, &place)?;
        let place = format!("images[{}]", texture.source.value());
        let owned;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                owned = document.load(uri, &place, document.source.limits.file_bytes)?;
                owned.as_slice()
            }
            (None, Some(view)) => document.view(view, &place)?.0,
            (None, None) => {
                return Err(document
                    .source
                    .at(place, "has neither uri nor bufferView; export the file again"));
            }
        };
        let decoded = decode(document, bytes, &place)?;
        let mode = |wrap| if let Checked::Valid(mode) = wrap { mode } else { WrappingMode::Repeat };
        Ok(Self {
            width: decoded.width() as usize,
            height: decoded.height() as usize,
            pixels: decoded.pixels().map(|pixel| pixel.0).collect(),
            wrap: [mode(sampler.wrap_s), mode(sampler.wrap_t)],
            nearest: sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)),
            linear: std::array::from_fn(|level| color::to_linear(level as u8)),
        })
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> u64 {
        self.pixels.len() as u64
    }

    /// Linear light at texture coordinates, bilinear unless the sampler says nearest.
    pub fn sample(&self, uv: [f64; 2]) -> [f64; 3] {
        let size = [self.width, self.height];
        let [x, y] = std::array::from_fn(|axis| reduce(uv[axis], self.wrap[axis]) * size[axis] as f64);
        if self.nearest {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        // Texel centres lie at halves.
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (s, t) = (x - left, y - top);
        let (left, top) = (left as i64, top as i64);
        let weighted = [
            (self.texel(left, top), (1.0 - s) * (1.0 - t)),
            (self.texel(left + 1, top), s * (1.0 - t)),
            (self.texel(left, top + 1), (1.0 - s) * t),
            (self.texel(left + 1, top + 1), s * t),
        ];
        std::array::from_fn(|c| weighted.iter().map(|(texel, weight)| texel[c] * weight).sum())
    }

    fn texel(&self, x: i64, y: i64) -> [f64; 3] {
        let (x, y) = (wrap(x, self.width, self.wrap[0]), wrap(y, self.height, self.wrap[1]));
        self.pixels[y * self.width + x].map(|level| self.linear[level as usize])
    }
}

fn decode(document: &Document, bytes: &[u8], place: &str) -> Result<image::RgbImage> {
    let limit = document.source.limits.texture_pixels;
    let fault = |error: image::ImageError| {
        let what = format!("{error}; the texture must be a sound PNG or JPEG, export the file again");
        document.source.at(place, what)
    };
    let reader = || {
        let guessed = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        guessed.map_err(|error| fault(image::ImageError::IoError(error)))
    };
    let (width, height) = reader()?.into_dimensions().map_err(fault)?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels > limit {
        let what = format!(
            "{place} has {width} x {height} pixels, over the limit of {limit}; shrink the texture or raise \
             `Limits::texture_pixels`"
        );
        return Err(Error::Limits { path: document.source.path.to_owned(), what });
    }
    if pixels == 0 {
        return Err(document.source.at(place, "has no pixels; export the file again"));
    }
    let mut reader = reader()?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(limit.saturating_mul(PIXEL_BYTES));
    reader.limits(limits);
    Ok(reader.decode().map_err(fault)?.to_rgb8())
}

/// Brings a coordinate near 0, so that huge ones keep their meaning and NaN gets one.
fn reduce(coordinate: f64, mode: WrappingMode) -> f64 {
    if !coordinate.is_finite() {
        return 0.0;
    }
    match mode {
        WrappingMode::ClampToEdge => coordinate.clamp(0.0, 1.0),
        // Mirrored images repeat every second time.
        WrappingMode::Repeat | WrappingMode::MirroredRepeat => coordinate.rem_euclid(2.0),
    }
}

/// The texel that stands at a place outside the image.
fn wrap(place: i64, size: usize, mode: WrappingMode) -> usize {
    let size = size as i64;
    let inside = match mode {
        WrappingMode::ClampToEdge => place.clamp(0, size - 1),
        WrappingMode::Repeat => place.rem_euclid(size),
        WrappingMode::MirroredRepeat => {
            let there = place.rem_euclid(2 * size);
            there.min(2 * size - 1 - there)
        }
    };
    inside as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_repeats_mirrors_and_clamps() {
        let all = |mode| (-3..7).map(|x| wrap(x, 3, mode)).collect::<Vec<_>>();
        assert_eq!(all(WrappingMode::Repeat), [0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(all(WrappingMode::MirroredRepeat), [2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
        assert_eq!(all(WrappingMode::ClampToEdge), [0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
    }

    #[test]
    fn sampling_is_bilinear_in_light() {
        let texture = Texture {
            width: 2,
            height: 1,
            pixels: vec![[0; 3], [255; 3]],
            wrap: [WrappingMode::ClampToEdge; 2],
            nearest: false,
            linear: std::array::from_fn(|level| color::to_linear(level as u8)),
        };
        for (u, light) in [(0.25, 0.0), (0.375, 0.25), (0.5, 0.5), (0.75, 1.0), (9.0, 1.0), (f64::NAN, 0.0)] {
            assert!((texture.sample([u, 0.5])[0] - light).abs() < 1e-12, "{u}");
        }
    }
}
