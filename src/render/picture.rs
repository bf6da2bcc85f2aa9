//! The finished picture, and the buffers behind it.

use image::RgbaImage;

use super::shade;
use crate::error::{Error, Result};

/// A drawn picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// sRGB and alpha, rows from the top.
    pub rgba: RgbaImage,
}

/// What each pixel's ray meets first, without any blending: one sample in the middle of each
/// pixel, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// What each pixel sees; as many as pixels.
    pub seen: Vec<Option<Seen>>,
}

/// The nearest hit of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// View depth in model units: distance from the eye along the viewing direction.
    pub depth: f64,
    /// Index of the splat, input triangle or input point.
    pub index: u32,
    /// Unit normal, turned towards the eye, in input coordinates.
    pub normal: [f32; 3],
}

/// What one camera sees, one sample a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// What each pixel's ray meets first. Index and normal are of the blended surface, which
    /// changes neither what is hit nor its depth.
    pub visibility: Visibility,
    /// The lit surface over the default background.
    pub shaded: Picture,
    /// Its normals, as [`super::Show::Normals`] gives them, over the default background.
    pub normals: Picture,
    /// Meetings of a ray with a splat, triangle or point, at any depth, over all pixels.
    pub fragments: u64,
}

impl Visibility {
    /// What a pixel sees.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Option<Seen> {
        self.seen.get(y as usize * self.size[0] as usize + x as usize).copied().flatten()
    }
}

impl Picture {
    /// Averages squares of `factor` by `factor` samples, in linear light, weighted by alpha.
    pub(super) fn from_samples(samples: Vec<[u8; 4]>, size: [u32; 2], factor: u32) -> Result<Self> {
        let lost = || Error::Internal(format!("{size:?} samples do not fill the picture"));
        let pixels = if factor == 1 { samples } else { filter(&samples, size, factor) };
        let [width, height] = [size[0] / factor, size[1] / factor];
        let bytes = pixels.into_flattened();
        Ok(Self { rgba: RgbaImage::from_raw(width, height, bytes).ok_or_else(lost)? })
    }
}

/// The box filter behind [`Picture::from_samples`].
fn filter(samples: &[[u8; 4]], size: [u32; 2], factor: u32) -> Vec<[u8; 4]> {
    let (stride, factor) = (size[0] as usize, factor as usize);
    let linear: Vec<f32> = (0..=255).map(shade::linear_from_byte).collect();
    let mut pixels = Vec::with_capacity(samples.len() / (factor * factor));
    for rows in samples.chunks_exact(stride * factor) {
        for x in (0..stride).step_by(factor) {
            let block = (0..factor).flat_map(|dy| &rows[dy * stride + x..dy * stride + x + factor]);
            pixels.push(mean(block, &linear));
        }
    }
    pixels
}

/// Mean colour of some samples; of equal samples, that sample itself.
fn mean<'a>(block: impl Iterator<Item = &'a [u8; 4]> + Clone, linear: &[f32]) -> [u8; 4] {
    let Some(&first) = block.clone().next() else { return [0; 4] };
    if block.clone().all(|&sample| sample == first) {
        return first;
    }
    let (mut color, mut alpha, mut count) = ([0.0; 3], 0.0, 0.0);
    for sample in block {
        let weight = f32::from(sample[3]);
        for (sum, &byte) in color.iter_mut().zip(sample) {
            *sum += weight * linear[usize::from(byte)];
        }
        alpha += weight;
        count += 1.0;
    }
    if alpha > 0.0 {
        let [r, g, b] = color.map(|sum| shade::byte_from_linear(sum / alpha));
        [r, g, b, (alpha / count).round() as u8]
    } else {
        first
    }
}
