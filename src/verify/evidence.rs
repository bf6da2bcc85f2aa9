//! The pictures behind a verdict, and the page that shows them side by side.

use std::path::{Path, PathBuf};

use image::RgbImage;

use super::{Compared, Verdict};
use crate::error::Result;
use crate::format;
use crate::measure::image::{self as measure, BLOCK};
use crate::report::page::{Mark, Number, Page, Picture, View};
use crate::report::png;

/// How much brighter the difference picture is than the difference.
const GAIN: u8 = 8;

/// FLIP that has the brightest colour of the heat map: a clear difference, as FLIP goes.
const BRIGHTEST: f32 = 0.25;

/// Room around the marked block, in blocks, so that the frame does not hide it.
const MARGIN: f64 = 2.0;

/// Writes four PNGs a view and `index.html`.
pub(super) fn write(verdict: &Verdict, file: &Path, golden: &Path, directory: &Path) -> Result<PathBuf> {
    let mut views = Vec::with_capacity(verdict.views.len());
    for compared in &verdict.views {
        let pictures = write_pictures(compared, directory)?;
        views.push(section(verdict, compared, pictures));
    }
    let failed = views.iter().filter(|view| !view.passed).count();
    let mut notes = verdict.broken.clone();
    notes.push(format!("golden images: {}", golden.display()));
    notes.push(format!("the frame is around the {BLOCK} by {BLOCK} pixels with the greatest difference; below each picture it is enlarged"));
    let verdict_line = if verdict.passed() {
        format!("passed: all {} views agree with their golden images", views.len())
    } else {
        let broken = if verdict.broken.is_empty() { "" } else { ", and the file breaks a promise" };
        format!("FAILED: {failed} of {} views differ{broken}", views.len())
    };
    let title = format!("qsplat verify {}", file.display());
    let page = Page { title, verdict: verdict_line, passed: verdict.passed(), notes, views };
    let path = directory.join("index.html");
    format::write_file(&path, page.html().as_bytes())?;
    Ok(path)
}

fn write_pictures(compared: &Compared, directory: &Path) -> Result<Vec<Picture>> {
    let difference = measure::difference(&compared.golden, &compared.drawn, GAIN)?;
    let heat = compared.map.heat_map(BRIGHTEST);
    let four: [(&'static str, &str, &RgbImage); 4] = [
        ("input: the file, drawn now", "input", &compared.drawn),
        ("golden: the stored image", "golden", &compared.golden),
        ("difference, 8 times brighter", "difference", &difference),
        ("FLIP heat map: black is equal, yellow 0.25 and more", "heat", &heat),
    ];
    let mut pictures = Vec::with_capacity(four.len());
    for (caption, suffix, picture) in four {
        let file = format!("{}-{suffix}.png", compared.view.name);
        png::write(&directory.join(&file), picture)?;
        pictures.push(Picture { caption, file });
    }
    Ok(pictures)
}

fn section(verdict: &Verdict, compared: &Compared, pictures: Vec<Picture>) -> View {
    let (scores, limits) = (&compared.scores, &verdict.limits);
    let judged = |name, value: f64, limit: f64| Number {
        name,
        value: format!("{value:.5}"),
        limit: limit.to_string(),
        kept: value <= limit,
    };
    let told = |name, value: String| Number { name, value, limit: String::new(), kept: true };
    let psnr = if scores.psnr.is_finite() { format!("{:.1} dB", scores.psnr) } else { "equal".into() };
    View {
        name: compared.view.name.clone(),
        passed: scores.keep(limits),
        numbers: vec![
            judged("FLIP mean", scores.mean, limits.flip_mean),
            judged("FLIP p99", scores.p99, limits.flip_p99),
            judged("FLIP worst block", scores.block.mean, limits.flip_block),
            told("PSNR", psnr),
            told("SSIM", format!("{:.5}", scores.ssim)),
        ],
        notes: Vec::new(),
        pictures,
        mark: (scores.block.mean > 0.0).then(|| mark(compared)),
    }
}

/// A square around the worst block, moved inside the picture where it would reach out of it.
fn mark(compared: &Compared) -> Mark {
    let (width, height) = compared.golden.dimensions();
    let [width, height] = [width, height].map(f64::from);
    let (block, side) = (compared.scores.block, f64::from(BLOCK));
    let framed = ((1.0 + 2.0 * MARGIN) * side).min(width).min(height);
    let start = |at: u32, room: f64| (f64::from(at) - MARGIN * side).clamp(0.0, room - framed);
    Mark {
        x: start(block.x, width) / width,
        y: start(block.y, height) / height,
        width: framed / width,
        height: framed / height,
    }
}
