//! `holes` and `image`: input and splats from the same 26 views, pixel by pixel.

use image::{DynamicImage, RgbImage};
use rayon::prelude::*;

use super::holes::{self, Depths, HoleMap, Mark};
use super::image as difference;
use super::measures::{Holes, Image, ViewMeasures};
use super::views::{SIDE, View};
use crate::error::Result;
use crate::model::asset::Asset;
use crate::render::cpu;
use crate::render::input::Prepared;
use crate::render::picture::{Picture, Visibility};

/// PSNR of equal pictures, dB: JSON has no infinity.
const MOST_DECIBELS: f64 = 99.0;

/// The input from one view, drawn once for all files that are compared with it. Fifteen bytes
/// a pixel.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The view.
    pub view: View,
    /// The lit input.
    pub shaded: RgbImage,
    /// Its normals.
    pub normals: RgbImage,
    pub(super) depths: Depths,
}

impl Drawn {
    /// Draws the input from one view.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] for a view that cannot be drawn.
    pub fn new(input: &Prepared<'_>, view: View) -> Result<Self> {
        let own = input.survey(&view.camera, [SIDE; 2])?;
        let depths = Depths::new([SIDE; 2], input.met(&view.camera, [SIDE; 2])?);
        Ok(Self { view, shaded: opaque(own.shaded), normals: opaque(own.normals), depths })
    }
}

/// The splats from one view, beside the input.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Where only one of both is hit.
    pub holes: HoleMap,
    /// What the splats show first, by pixel.
    pub splats: Visibility,
    /// The lit splats.
    pub shaded: RgbImage,
    /// Their normals.
    pub normals: RgbImage,
    /// Rays that met a splat, once for each splat met.
    pub fragments: u64,
}

/// What all views came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Sums over the views.
    pub holes: Holes,
    /// Means over the views.
    pub image: Image,
    /// Each view.
    pub views: Vec<ViewMeasures>,
    /// Mean over the views.
    pub fragments: f64,
}

/// Draws splats as an input was drawn, and compares where both are hit.
///
/// # Errors
/// [`crate::Error::Usage`] for a view that cannot be drawn.
pub fn compare(asset: &Asset, input: &Drawn) -> Result<Compared> {
    let own = cpu::survey(asset, &input.view.camera, [SIDE; 2])?;
    Ok(Compared {
        holes: holes::compare(&input.depths, &own.visibility, holes::behind(asset)),
        splats: own.visibility,
        shaded: opaque(own.shaded),
        normals: opaque(own.normals),
        fragments: own.fragments,
    })
}

fn opaque(picture: Picture) -> RgbImage {
    DynamicImage::from(picture.rgba).to_rgb8()
}

/// Compares splats with an input from all views.
///
/// # Errors
/// As [`compare`].
pub fn seen(asset: &Asset, inputs: &[Drawn]) -> Result<Seen> {
    let scores: Vec<Scores> = inputs
        .par_iter()
        .map(|input| compare(asset, input).and_then(|splats| Scores::of(input, &splats)))
        .collect::<Result<_>>()?;
    let count = scores.len().max(1) as f64;
    let mean = |part: &dyn Fn(&Scores) -> f64| scores.iter().map(part).sum::<f64>() / count;
    let sum = |part: &dyn Fn(&ViewMeasures) -> u64| scores.iter().map(|scores| part(&scores.view)).sum();
    let image = Image {
        flip_mean: mean(&|s| s.view.image.flip_mean),
        flip_p99: scores.iter().map(|s| s.view.image.flip_p99).fold(0.0, f64::max),
        psnr: decibels(mean(&|s| s.mean_square)),
        ssim: mean(&|s| s.view.image.ssim),
        normal_flip_mean: mean(&|s| s.view.image.normal_flip_mean),
    };
    let holes = Holes {
        missing: sum(&|view| view.missing),
        extra: sum(&|view| view.extra),
        through: sum(&|view| view.through),
        views: sum(&|view| u64::from(view.missing + view.extra > 0)),
        pixels: sum(&|view| view.pixels),
    };
    let fragments = mean(&|s| s.fragments as f64);
    Ok(Seen { holes, image, views: scores.into_iter().map(|scores| scores.view).collect(), fragments })
}

/// What one view came to.
struct Scores {
    view: ViewMeasures,
    mean_square: f64,
    fragments: u64,
}

impl Scores {
    fn of(input: &Drawn, splats: &Compared) -> Result<Self> {
        let (flip, normals) = rayon::join(
            || difference::flip(&input.shaded, &splats.shaded),
            || difference::flip(&input.normals, &splats.normals),
        );
        let flip = flip?;
        let mean_square = difference::mean_square(&input.shaded, &splats.shaded)?;
        let view = ViewMeasures {
            name: input.view.name.clone(),
            missing: splats.holes.count(Mark::Missing),
            extra: splats.holes.count(Mark::Extra),
            through: splats.holes.count(Mark::Through),
            pixels: splats.holes.compared(),
            image: Image {
                flip_mean: flip.mean(),
                flip_p99: flip.quantile(0.99),
                psnr: decibels(mean_square),
                ssim: difference::ssim(&input.shaded, &splats.shaded)?,
                normal_flip_mean: normals?.mean(),
            },
        };
        Ok(Self { view, mean_square, fragments: splats.fragments })
    }
}

/// A mean square of byte differences as PSNR, capped.
fn decibels(mean_square: f64) -> f64 {
    difference::decibels(mean_square).min(MOST_DECIBELS)
}

#[cfg(test)]
pub(super) mod tests;
