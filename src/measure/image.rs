//! The difference between two pictures: FLIP, PSNR and SSIM.
//!
//! FLIP (Andersson et al. 2020) is the difference a person sees when flipping between the two
//! pictures, pixel by pixel, in `[0, 1]`. Its mean hardly moves when one splat of many is
//! wrong, so [`FlipMap`] also gives the 99th percentile and the worst block.

use image::{Rgb, RgbImage};

use crate::error::{Error, Result};

/// Side of the blocks of [`FlipMap::worst_block`], pixels.
pub const BLOCK: u32 = 8;

/// Blocks start at every multiple of this, so that every small difference lies well within one.
const BLOCK_STEP: u32 = BLOCK / 2;

/// FLIP of every pixel, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height` values in `[0, 1]`: 0 is equal, 1 is black against white.
    pub values: Vec<f32>,
}

/// A square part of a picture and the mean FLIP over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Mean FLIP in `[0, 1]`.
    pub mean: f64,
}

/// Compares a picture with its reference by FLIP, at the authors' default viewing distance.
///
/// # Errors
/// [`Error::Usage`] if the sizes differ or a picture is empty.
pub fn flip(reference: &RgbImage, test: &RgbImage) -> Result<FlipMap> {
    same_size(reference, test)?;
    let (width, height) = reference.dimensions();
    let mut map = FlipMap { width, height, values: vec![0.0; width as usize * height as usize] };
    let Some([left, top, right, bottom]) = affected(reference, test) else { return Ok(map) };
    let (across, down) = (right - left, bottom - top);
    let load = |picture: &RgbImage| {
        let part = image::imageops::crop_imm(picture, left, top, across, down).to_image();
        nv_flip::FlipImageRgb8::with_data(across, down, part.as_raw())
    };
    let errors = nv_flip::flip(load(reference), load(test), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
    for (row, line) in (top..bottom).zip(errors.chunks_exact(across as usize)) {
        let start = (row * width + left) as usize;
        for (value, &error) in map.values[start..].iter_mut().zip(line) {
            // Written so that a NaN counts as the greatest difference.
            *value = if error >= 0.0 { error.min(1.0) } else { 1.0 };
        }
    }
    Ok(map)
}

/// Pixels that FLIP's filters reach at the default viewing distance: three standard deviations,
/// at most 10.
const FLIP_REACH: u32 = 10;

/// The rectangle (left, top, right, bottom) outside which FLIP is 0, and what its filters read
/// to find the values inside: around all pixels that differ, twice the filters' reach. `None`
/// for equal pictures.
fn affected(reference: &RgbImage, test: &RgbImage) -> Option<[u32; 4]> {
    let (width, height) = reference.dimensions();
    let stride = 3 * width as usize;
    let rows = reference.as_raw().chunks_exact(stride).zip(test.as_raw().chunks_exact(stride));
    let mut found: Option<[u32; 4]> = None;
    for (y, (a, b)) in (0..).zip(rows) {
        let differ = |&n: &usize| a[n] != b[n];
        let (Some(first), Some(last)) = ((0..stride).find(differ), (0..stride).rfind(differ)) else {
            continue;
        };
        let (first, last) = (first as u32 / 3, last as u32 / 3);
        let [left, top, right, _] = found.unwrap_or([first, y, last, y]);
        found = Some([left.min(first), top, right.max(last), y]);
    }
    let room = 2 * FLIP_REACH;
    let [left, top, right, bottom] = found?;
    let end = |last: u32, side: u32| last.saturating_add(1 + room).min(side);
    Some([left.saturating_sub(room), top.saturating_sub(room), end(right, width), end(bottom, height)])
}

impl FlipMap {
    /// Mean over all pixels.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.values.iter().copied().map(f64::from).sum::<f64>() / self.values.len() as f64
    }

    /// The value that the share `q` in `[0, 1]` of the pixels does not pass (nearest rank).
    #[must_use]
    pub fn quantile(&self, q: f64) -> f64 {
        let mut sorted = self.values.clone();
        let rank = (q.clamp(0.0, 1.0) * sorted.len() as f64).ceil() as usize;
        let index = rank.saturating_sub(1).min(sorted.len() - 1);
        let (_, value, _) = sorted.select_nth_unstable_by(index, f32::total_cmp);
        f64::from(*value)
    }

    /// The block of [`BLOCK`] pixels a side with the greatest mean; the first such in reading
    /// order. Narrower pictures are one block across.
    #[must_use]
    pub fn worst_block(&self) -> Block {
        let mut worst = Block { x: 0, y: 0, mean: 0.0 };
        for y in starts(self.height) {
            for x in starts(self.width) {
                let mean = self.block_mean(x, y);
                if mean > worst.mean {
                    worst = Block { x, y, mean };
                }
            }
        }
        worst
    }

    fn block_mean(&self, x: u32, y: u32) -> f64 {
        let columns = x..(x + BLOCK).min(self.width);
        let rows = y..(y + BLOCK).min(self.height);
        let count = (columns.len() * rows.len()) as f64;
        let at = |row: u32, column: u32| f64::from(self.values[(row * self.width + column) as usize]);
        rows.map(|row| columns.clone().map(|column| at(row, column)).sum::<f64>()).sum::<f64>() / count
    }

    /// The map in the magma colours: black is equal, bright yellow a FLIP of `brightest`, which is
    /// positive, and above.
    #[must_use]
    pub fn heat_map(&self, brightest: f32) -> RgbImage {
        let table = nv_flip::magma_lut().to_vec();
        RgbImage::from_fn(self.width, self.height, |x, y| {
            let value = self.values[(y * self.width + x) as usize];
            let entry = 3 * ((value / brightest).min(1.0) * 255.0).round() as usize;
            Rgb([table[entry], table[entry + 1], table[entry + 2]])
        })
    }
}

/// Block starts along one side.
fn starts(side: u32) -> impl Iterator<Item = u32> {
    let last = side.saturating_sub(BLOCK);
    (0..last).step_by(BLOCK_STEP as usize).chain(std::iter::once(last))
}

/// Peak signal-to-noise ratio in decibels over all channels; infinite for equal pictures.
///
/// # Errors
/// [`Error::Usage`] if the sizes differ or a picture is empty.
pub fn psnr(reference: &RgbImage, test: &RgbImage) -> Result<f64> {
    mean_square(reference, test).map(decibels)
}

/// Mean square of the difference over all channels, in squared levels of 255.
///
/// # Errors
/// [`Error::Usage`] if the sizes differ or a picture is empty.
pub fn mean_square(reference: &RgbImage, test: &RgbImage) -> Result<f64> {
    same_size(reference, test)?;
    let pairs = reference.as_raw().iter().zip(test.as_raw());
    // Exact in integers: 2^64 holds the squares of 10^14 bytes.
    let sum: u64 = pairs.map(|(&a, &b)| u64::from(a.abs_diff(b)).pow(2)).sum();
    Ok(sum as f64 / reference.as_raw().len() as f64)
}

/// Peak signal-to-noise ratio in decibels of a [`mean_square`]; infinite for 0.
#[must_use]
pub fn decibels(mean_square: f64) -> f64 {
    10.0 * libm::log10(255.0 * 255.0 / mean_square)
}

/// The magnitude of the difference, channel by channel, `|reference - test|`, brightened `gain`
/// times so that small differences show.
///
/// # Errors
/// [`Error::Usage`] if the sizes differ or a picture is empty.
pub fn difference(reference: &RgbImage, test: &RgbImage, gain: u8) -> Result<RgbImage> {
    same_size(reference, test)?;
    Ok(RgbImage::from_fn(reference.width(), reference.height(), |x, y| {
        let (a, b) = (reference.get_pixel(x, y).0, test.get_pixel(x, y).0);
        Rgb([0, 1, 2].map(|c| a[c].abs_diff(b[c]).saturating_mul(gain)))
    }))
}

/// Width of the Gaussian window of SSIM (Wang et al. 2004, section III.B).
const SSIM_WINDOW: usize = 11;
/// Standard deviation of that window, pixels.
const SSIM_SIGMA: f64 = 1.5;
/// `(K1 L)²` and `(K2 L)²` with the paper's `K1 = 0.01, K2 = 0.03` and `L = 255`.
const SSIM_C: [f64; 2] = [2.55 * 2.55, 7.65 * 7.65];

/// Mean structural similarity of the luma, 1 for equal pictures (Wang et al. 2004).
///
/// The window is taken only where it lies wholly inside, as the authors do.
///
/// # Errors
/// [`Error::Usage`] if the sizes differ or a side is below the window's 11 pixels.
pub fn ssim(reference: &RgbImage, test: &RgbImage) -> Result<f64> {
    same_size(reference, test)?;
    let (width, height) = (reference.width() as usize, reference.height() as usize);
    if width.min(height) < SSIM_WINDOW {
        let message =
            format!("SSIM needs at least {SSIM_WINDOW} pixels a side, these pictures are {width}x{height}");
        return Err(Error::Usage(message));
    }
    let (a, b) = (luma(reference), luma(test));
    let product = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(x, y)| x * y).collect::<Vec<_>>();
    let [mean_a, mean_b, aa, bb, ab] =
        [a.clone(), b.clone(), product(&a, &a), product(&b, &b), product(&a, &b)]
            .map(|plane| blur(&plane, width, height));
    let [c1, c2] = SSIM_C;
    let each = (0..mean_a.len()).map(|n| {
        let (ma, mb) = (mean_a[n], mean_b[n]);
        let (va, vb, cov) = (aa[n] - ma * ma, bb[n] - mb * mb, ab[n] - ma * mb);
        (2.0 * ma * mb + c1) * (2.0 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
    });
    Ok(each.sum::<f64>() / mean_a.len() as f64)
}

/// Rec. 601 luma, as the authors' own program takes it.
fn luma(picture: &RgbImage) -> Vec<f64> {
    let weigh =
        |&Rgb([r, g, b]): &Rgb<u8>| 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
    picture.pixels().map(weigh).collect()
}

/// The Gaussian window over a plane, kept where it lies wholly inside.
fn blur(plane: &[f64], width: usize, height: usize) -> Vec<f64> {
    let kernel = gaussian();
    let (inner_width, inner_height) = (width - SSIM_WINDOW + 1, height - SSIM_WINDOW + 1);
    let mut rows = Vec::with_capacity(inner_width * height);
    for row in plane.chunks_exact(width) {
        rows.extend(row.windows(SSIM_WINDOW).map(|w| w.iter().zip(&kernel).map(|(v, k)| v * k).sum::<f64>()));
    }
    let mut out = Vec::with_capacity(inner_width * inner_height);
    for y in 0..inner_height {
        let column =
            |x: usize| (0..SSIM_WINDOW).map(|k| kernel[k] * rows[(y + k) * inner_width + x]).sum::<f64>();
        out.extend((0..inner_width).map(column));
    }
    out
}

/// The window's weights along one axis, adding up to 1.
fn gaussian() -> [f64; SSIM_WINDOW] {
    let mut kernel = [0.0; SSIM_WINDOW];
    for (n, weight) in kernel.iter_mut().enumerate() {
        let x = (n as f64 - (SSIM_WINDOW / 2) as f64) / SSIM_SIGMA;
        *weight = libm::exp(-0.5 * x * x);
    }
    let sum: f64 = kernel.iter().sum();
    kernel.map(|weight| weight / sum)
}

fn same_size(reference: &RgbImage, test: &RgbImage) -> Result<()> {
    let (a, b) = (reference.dimensions(), test.dimensions());
    if a == b && a.0 > 0 && a.1 > 0 {
        return Ok(());
    }
    let [a, b] = [a, b].map(|(width, height)| format!("{width}x{height}"));
    Err(Error::Usage(format!("only pictures of one size can be compared, these are {a} and {b}")))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;

    fn ramp() -> RgbImage {
        RgbImage::from_fn(64, 48, |x, y| Rgb([(x * 4) as u8, (y * 5) as u8, 128]))
    }

    #[test]
    fn a_picture_does_not_differ_from_itself() {
        let picture = ramp();
        let map = flip(&picture, &picture).unwrap();
        assert!(map.mean() < 1e-6 && map.worst_block().mean < 1e-6);
        assert!(psnr(&picture, &picture).unwrap().is_infinite());
        assert!((ssim(&picture, &picture).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn black_against_white_is_the_greatest_difference() {
        let (black, white) = (RgbImage::new(32, 32), RgbImage::from_pixel(32, 32, Rgb([255; 3])));
        assert!(flip(&black, &white).unwrap().mean() > 0.95);
        assert!(psnr(&black, &white).unwrap().abs() < 1e-12, "0 dB by definition");
        // Both flat: SSIM is c1 / (255² + c1).
        let expected = SSIM_C[0] / (255.0 * 255.0 + SSIM_C[0]);
        assert!((ssim(&black, &white).unwrap() - expected).abs() < 1e-9);
    }

    #[test]
    fn one_grey_level_everywhere_is_48_decibels() {
        let (a, b) = (RgbImage::from_pixel(16, 16, Rgb([7; 3])), RgbImage::from_pixel(16, 16, Rgb([8; 3])));
        assert!((psnr(&a, &b).unwrap() - 48.130_803_608_679_1).abs() < 1e-9);
    }

    #[test]
    fn a_planted_patch_is_found_where_it_is() {
        let clean = ramp();
        let mut marked = clean.clone();
        for (x, y) in (40..46).flat_map(|x| (20..26).map(move |y| (x, y))) {
            marked.put_pixel(x, y, Rgb([255, 0, 255]));
        }
        let map = flip(&clean, &marked).unwrap();
        let block = map.worst_block();
        assert!((36..=44).contains(&block.x) && (16..=24).contains(&block.y), "{block:?}");
        assert!(map.mean() < 0.03 && block.mean > 0.3, "mean {} block {}", map.mean(), block.mean);
        assert!(map.quantile(0.99) > map.quantile(0.5));
    }

    #[test]
    fn only_what_differs_is_looked_at_and_the_values_stay() {
        let clean = RgbImage::from_fn(120, 90, |x, y| Rgb([(x * 2) as u8, (y * 31 % 200) as u8, 128]));
        for (left, top) in [(0, 0), (50, 40), (112, 84), (119, 3)] {
            let mut marked = clean.clone();
            for (x, y) in
                (left..(left + 7).min(120)).flat_map(|x| (top..(top + 5).min(90)).map(move |y| (x, y)))
            {
                marked.put_pixel(x, y, Rgb([255, 0, 255]));
            }
            let load = |picture: &RgbImage| nv_flip::FlipImageRgb8::with_data(120, 90, picture.as_raw());
            let whole =
                nv_flip::flip(load(&clean), load(&marked), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
            assert_eq!(flip(&clean, &marked).unwrap().values, whole, "a patch at {left}, {top}");
        }
        assert_eq!(flip(&clean, &clean).unwrap().mean(), 0.0);
    }

    #[test]
    fn heat_goes_from_black_to_yellow() {
        let map = FlipMap { width: 3, height: 1, values: vec![0.0, 0.1, 0.9] };
        let heat = map.heat_map(0.2);
        let sums: Vec<u32> = heat.pixels().map(|p| p.0.iter().copied().map(u32::from).sum()).collect();
        assert!(sums[0] < 10 && sums[0] < sums[1] && sums[1] < sums[2] && sums[2] > 600, "{sums:?}");
    }

    #[test]
    fn quantiles_are_ranks() {
        let values = (1..=100).rev().map(|n| n as f32 / 100.0).collect();
        let map = FlipMap { width: 10, height: 10, values };
        assert!((map.quantile(0.99) - 0.99).abs() < 1e-6 && (map.quantile(1.0) - 1.0).abs() < 1e-6);
        assert!((map.quantile(0.0) - 0.01).abs() < 1e-6);
    }

    #[test]
    fn pictures_of_different_sizes_are_refused() {
        let message = flip(&RgbImage::new(4, 4), &RgbImage::new(4, 5)).unwrap_err().to_string();
        assert!(message.contains("4x4") && message.contains("4x5"), "{message}");
        assert!(ssim(&RgbImage::new(10, 40), &RgbImage::new(10, 40)).is_err());
    }
}
