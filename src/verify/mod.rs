//! An asset against its golden images and its promises.
//!
//! A golden directory holds `golden.json` ([`golden::Golden`]: cameras, size, what is shown,
//! limits) and one PNG a view. [`check`] draws the asset from the same cameras and compares by
//! FLIP. Three numbers decide, because each is blind to something:
//!
//! - the *mean* sees a change of the whole picture, such as another light;
//! - the *99th percentile* sees a change of a hundredth of it, such as a lost part;
//! - the *worst block*, the greatest mean over 8 by 8 pixels, sees a single wrong splat, which
//!   moves neither of the others, and passes over single pixels on a rim, which two renderers
//!   may round to different sides.
//!
//! What can be checked without the input is checked too: [`promises`].

mod evidence;
pub mod golden;

use std::path::Path;

use image::RgbImage;

use crate::error::{Error, Result};
use crate::measure::image::{self as measure, Block, FlipMap};
use crate::model::asset::Asset;
use crate::render::{Camera, Settings};
use golden::{Golden, Limits, View};

/// Draws a picture of the asset at hand; the caller chooses the device.
pub type Draw<'a> = dyn FnMut(&Camera, &Settings) -> Result<RgbImage> + 'a;

/// What the comparison came to.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Promises of the asset that do not hold, in words.
    pub broken: Vec<String>,
    /// Every view in the order of `golden.json`.
    pub views: Vec<Compared>,
    /// The limits that were in force.
    pub limits: Limits,
}

/// One view, compared.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The view.
    pub view: View,
    /// What was drawn now.
    pub drawn: RgbImage,
    /// What is stored.
    pub golden: RgbImage,
    /// FLIP of every pixel.
    pub map: FlipMap,
    /// The numbers that decide.
    pub scores: Scores,
}

/// The numbers of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// Mean FLIP.
    pub mean: f64,
    /// 99th percentile of FLIP.
    pub p99: f64,
    /// The block with the greatest mean FLIP.
    pub block: Block,
    /// Decibels; infinite for equal pictures. Told, not judged.
    pub psnr: f64,
    /// Structural similarity. Told, not judged.
    pub ssim: f64,
}

impl Scores {
    fn of(golden: &RgbImage, drawn: &RgbImage, map: &FlipMap) -> Result<Self> {
        Ok(Self {
            mean: map.mean(),
            p99: map.quantile(0.99),
            block: map.worst_block(),
            psnr: measure::psnr(golden, drawn)?,
            ssim: measure::ssim(golden, drawn)?,
        })
    }

    /// Whether every limit is kept; a NaN keeps none.
    #[must_use]
    pub fn keep(&self, limits: &Limits) -> bool {
        self.mean <= limits.flip_mean && self.p99 <= limits.flip_p99 && self.block.mean <= limits.flip_block
    }
}

impl Verdict {
    /// Whether the asset passed.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.broken.is_empty() && self.views.iter().all(|view| view.scores.keep(&self.limits))
    }

    /// One line a view, for people.
    #[must_use]
    pub fn text(&self) -> String {
        let mut lines: Vec<String> = self.broken.iter().map(|promise| format!("FAILED  {promise}")).collect();
        lines.extend(self.views.iter().map(|view| self.line(view)));
        lines.push(String::new());
        lines.join("\n")
    }

    fn line(&self, compared: &Compared) -> String {
        let (scores, limits) = (&compared.scores, &self.limits);
        let word = if scores.keep(limits) { "passed" } else { "FAILED" };
        let part = |name: &str, value: f64, limit: f64| {
            let sign = if value <= limit { "<=" } else { "> " };
            format!("{name} {value:.5} {sign} {limit}")
        };
        format!(
            "{word}  {:<18} FLIP {}, {}, {} at ({}, {})",
            compared.view.name,
            part("mean", scores.mean, limits.flip_mean),
            part("p99", scores.p99, limits.flip_p99),
            part("block", scores.block.mean, limits.flip_block),
            scores.block.x,
            scores.block.y,
        )
    }
}

/// Compares an asset with the golden images of a directory.
///
/// `max_flip` overrides the stored limit of the mean.
///
/// # Errors
/// [`Error::Usage`] if the directory holds no goldens; [`Error::Input`] if they are broken;
/// whatever drawing returns.
pub fn check(asset: &Asset, directory: &Path, max_flip: Option<f64>, draw: &mut Draw<'_>) -> Result<Verdict> {
    let stored = Golden::read(directory)?;
    let mut limits = stored.limits;
    if let Some(mean) = max_flip {
        limits.flip_mean = mean;
    }
    let mut views = Vec::with_capacity(stored.views.len());
    for view in &stored.views {
        let golden = stored.picture(directory, view)?;
        let drawn = stored.draw(view, draw)?;
        let map = measure::flip(&golden, &drawn)?;
        let scores = Scores::of(&golden, &drawn, &map)?;
        views.push(Compared { view: view.clone(), drawn, golden, map, scores });
    }
    Ok(Verdict { broken: promises(asset), views, limits })
}

/// Draws and stores the golden images of an asset.
///
/// Views, size and limits of an existing `golden.json` stay, so that hand-made ones survive;
/// without one they are [`Golden::of`]'s. A `size` in pixels overrides either.
///
/// # Errors
/// [`Error::Input`] if an existing `golden.json` is broken; whatever drawing and writing
/// return.
pub fn bless(asset: &Asset, directory: &Path, size: Option<[u32; 2]>, draw: &mut Draw<'_>) -> Result<Golden> {
    let mut golden = if Golden::exists(directory) { Golden::read(directory)? } else { Golden::of(asset) };
    golden.size = size.unwrap_or(golden.size);
    let mut pictures = Vec::with_capacity(golden.views.len());
    for view in &golden.views {
        pictures.push(golden.draw(view, draw)?);
    }
    golden.write(directory, &pictures)?;
    Ok(golden)
}

/// Promises of a file that do not hold, in words; empty for a sound one.
#[must_use]
pub fn promises(asset: &Asset) -> Vec<String> {
    let mut broken = Vec::new();
    let (fit, bound) = (&asset.fit, asset.max_error);
    // Phrased so that a NaN breaks the promise.
    let ordered = fit.rms >= 0.0 && fit.rms <= fit.max && fit.p99 >= 0.0 && fit.p99 <= fit.max;
    if !ordered {
        broken.push(format!(
            "the stored errors contradict each other: rms {:e}, p99 {:e}, max {:e}",
            fit.rms, fit.p99, fit.max
        ));
    }
    let within = fit.max <= bound;
    if !within {
        broken.push(format!("the stored fit max {:e} is above the stored bound {bound:e}", fit.max));
    }
    if asset.splats.is_empty() {
        broken.push("the file has no splats".into());
    }
    broken
}

/// Writes the pictures of a verdict and a page that shows them, and returns the page's path.
///
/// # Errors
/// [`Error::Io`].
pub fn write_evidence(
    verdict: &Verdict,
    file: &Path,
    golden: &Path,
    directory: &Path,
) -> Result<std::path::PathBuf> {
    std::fs::create_dir_all(directory).map_err(Error::io(directory))?;
    evidence::write(verdict, file, golden, directory)
}

#[cfg(test)]
mod tests;
