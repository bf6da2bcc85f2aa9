//! `qsplat verify`: a file against its golden images.

use std::path::PathBuf;

use clap::Args;
use image::{DynamicImage, RgbImage};
use qsplat::error::Result;
use qsplat::model::asset::Asset;
use qsplat::render::device::Choice;
use qsplat::render::{Camera, Settings};
use qsplat::verify;

use super::device::{self, Draw};
use super::{Notes, Outcome, source};

/// Compares a .qsplat with its golden images by FLIP; ends in exit code 1 if they differ.
///
/// The directory holds `golden.json` (cameras, size, limits) and one PNG a view. Three numbers
/// of each view have limits: the mean FLIP, its 99th percentile, and the greatest mean over 8 by
/// 8 pixels, which sees a single wrong splat. The promises that the file makes of itself are
/// checked too: it decodes, and the error stored in it is within its bound.
#[derive(Args)]
pub(super) struct Arguments {
    /// The .qsplat
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Where the golden images are
    #[arg(long, value_name = "DIR")]
    golden: PathBuf,
    /// Makes the golden images from this file, on the CPU; keeps the views and limits of an
    /// existing golden.json
    #[arg(long, conflicts_with_all = ["report", "max_flip"])]
    bless: bool,
    /// Width and height of the images that --bless makes; the default is that of an existing
    /// golden.json, or 384x384
    #[arg(long, value_name = "WxH", requires = "bless", value_parser = super::render::size)]
    size: Option<[u32; 2]>,
    /// Writes input, golden, difference and heat map of every view and a page that shows them
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// What draws: `auto` takes the GPU, or the CPU reference where there is none
    #[arg(long, value_name = device::NAMES, default_value = "auto")]
    device: Choice,
    /// Greatest mean FLIP, instead of the limit stored beside the images
    #[arg(long, value_name = "X", value_parser = flip)]
    max_flip: Option<f64>,
}

fn flip(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "give a number between 0 and 1".to_owned())?;
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err("FLIP lies between 0 and 1".into()) }
}

impl Arguments {
    pub(super) fn run(self, notes: &mut Notes<'_>) -> Result<Outcome> {
        let asset = source::asset(&self.file)?;
        if self.bless { self.make(&asset, notes) } else { self.check(&asset, notes) }
    }

    /// Goldens come from the reference alone, so that they are the same on every machine.
    fn make(&self, asset: &Asset, notes: &mut Notes<'_>) -> Result<Outcome> {
        if self.device == Choice::Gpu {
            notes.note("golden images always come from the CPU reference; --device gpu is left aside");
        }
        let golden = device::with(Choice::Cpu, asset, notes, |draw| {
            verify::bless(asset, &self.golden, self.size, &mut |camera, settings| {
                opaque(draw, camera, settings)
            })
        })?;
        Ok(Outcome::text(format!("{}: {} golden images\n", self.golden.display(), golden.views.len())))
    }

    fn check(&self, asset: &Asset, notes: &mut Notes<'_>) -> Result<Outcome> {
        let verdict = device::with(self.device, asset, notes, |draw| {
            verify::check(asset, &self.golden, self.max_flip, &mut |camera, settings| {
                opaque(draw, camera, settings)
            })
        })?;
        match &self.report {
            Some(directory) => {
                let page = verify::write_evidence(&verdict, &self.file, &self.golden, directory)?;
                notes.note(&format!("pictures side by side: {}", page.display()));
            }
            None if !verdict.passed() => {
                notes.note("add --report DIR for a page that shows where they differ")
            }
            None => {}
        }
        Ok(Outcome { text: verdict.text(), passed: verdict.passed() })
    }
}

/// Golden images have no alpha: the background of the default settings is opaque.
fn opaque(draw: &mut Draw<'_>, camera: &Camera, settings: &Settings) -> Result<RgbImage> {
    Ok(DynamicImage::from(draw(camera, settings)?.rgba).to_rgb8())
}
