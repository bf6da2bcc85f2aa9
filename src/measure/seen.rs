//! `holes` and `image`: input and splats from the same 26 views, pixel by pixel.

use image::{DynamicImage, RgbImage};
use rayon::prelude::*;

use super::holes::{self, HoleMap, Mark, Rules};
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

/// One view, drawn.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Where only one of both is hit.
    pub holes: HoleMap,
    /// What the splats show first, by pixel.
    pub splats: Visibility,
    /// The lit input and the lit splats.
    pub shaded: [RgbImage; 2],
    /// Normals of the input and of the splats.
    pub normals: [RgbImage; 2],
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

/// Draws input and splats from one view.
///
/// # Errors
/// [`crate::Error::Usage`] for a view that cannot be drawn.
pub fn draw(asset: &Asset, input: &Prepared<'_>, view: &View) -> Result<Pair> {
    let size = [SIDE; 2];
    let own = input.survey(&view.camera, size)?;
    let other = cpu::survey(asset, &view.camera, size)?;
    let opaque = |picture: Picture| DynamicImage::from(picture.rgba).to_rgb8();
    Ok(Pair {
        holes: holes::compare(&own.visibility, &other.visibility, &Rules::new(asset, input, view, SIDE)),
        splats: other.visibility,
        shaded: [opaque(own.shaded), opaque(other.shaded)],
        normals: [opaque(own.normals), opaque(other.normals)],
        fragments: other.fragments,
    })
}

/// Compares input and splats from all views.
///
/// # Errors
/// As [`draw`].
pub fn seen(asset: &Asset, input: &Prepared<'_>, views: &[View]) -> Result<Seen> {
    let scores: Vec<Scores> = views
        .par_iter()
        .map(|view| draw(asset, input, view).and_then(|pair| Scores::of(view, &pair)))
        .collect::<Result<_>>()?;
    let count = scores.len().max(1) as f64;
    let mean = |part: &dyn Fn(&Scores) -> f64| scores.iter().map(part).sum::<f64>() / count;
    let sum = |part: &dyn Fn(&ViewMeasures) -> u64| scores.iter().map(|scores| part(&scores.view)).sum();
    let image = Image {
        flip_mean: mean(&|s| s.view.flip_mean),
        flip_p99: scores.iter().map(|s| s.view.flip_p99).fold(0.0, f64::max),
        psnr: decibels(mean(&|s| s.mean_square)),
        ssim: mean(&|s| s.view.ssim),
        normal_flip_mean: mean(&|s| s.view.normal_flip_mean),
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
    fn of(view: &View, pair: &Pair) -> Result<Self> {
        let [input, splats] = &pair.shaded;
        let (flip, normals) = rayon::join(
            || difference::flip(input, splats),
            || difference::flip(&pair.normals[0], &pair.normals[1]),
        );
        let flip = flip?;
        let mean_square = difference::mean_square(input, splats)?;
        let view = ViewMeasures {
            name: view.name.clone(),
            missing: pair.holes.count(Mark::Missing),
            extra: pair.holes.count(Mark::Extra),
            through: pair.holes.count(Mark::Through),
            pixels: pair.holes.compared(),
            flip_mean: flip.mean(),
            flip_p99: flip.quantile(0.99),
            psnr: decibels(mean_square),
            ssim: difference::ssim(input, splats)?,
            normal_flip_mean: normals?.mean(),
        };
        Ok(Self { view, mean_square, fragments: pair.fragments })
    }
}

/// A mean square of byte differences as PSNR, capped.
fn decibels(mean_square: f64) -> f64 {
    difference::decibels(mean_square).min(MOST_DECIBELS)
}

#[cfg(test)]
mod tests;
