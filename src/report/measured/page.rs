//! The page of measures: every view in a table, those with holes in pictures.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use image::RgbImage;

use crate::error::Result;
use crate::format;
use crate::measure::Reference;
use crate::measure::image as difference;
use crate::measure::measures::{Measures, ViewMeasures};
use crate::measure::seen::{self, Compared, Drawn};
use crate::measure::views::SIDE;
use crate::model::asset::Asset;
use crate::report::page::{self, Mark, Number, Page, Picture};
use crate::report::png;

/// FLIP that has the brightest colour of the heat map: a clear difference, as FLIP goes.
const BRIGHTEST: f32 = 0.25;

/// Side of the enlarged part of a view, pixels: single pixels show, and what they belong to.
const PART: u32 = 32;

/// A splat is near a fault if it is seen within so many pixels: a splat cut too short is seen
/// beside the gap it leaves.
const NEAR: u32 = 3;

/// Splats named for a view, at most.
const NAMED: usize = 16;

/// Writes `measures.json`, `index.html` and the pictures of each view with holes, and of the
/// view with the greatest mean FLIP. The reference lies in the asset's frame; `names` are those
/// of the file and of the input.
///
/// # Errors
/// [`crate::Error::Io`].
pub fn write_page(
    measures: &Measures,
    asset: &Asset,
    reference: &Reference<'_>,
    names: [&Path; 2],
    directory: &Path,
) -> Result<PathBuf> {
    std::fs::create_dir_all(directory).map_err(crate::Error::io(directory))?;
    format::write_file(&directory.join("measures.json"), measures.json()?.as_bytes())?;
    let greatest = measures.views.iter().map(|view| view.image.flip_mean).fold(0.0, f64::max);
    let mut sections = Vec::with_capacity(measures.views.len());
    for (input, found) in reference.drawn.iter().zip(&measures.views) {
        let mut section = section(found);
        // Of several views with the greatest difference, the first is enough; none may have any.
        let worst = found.image.flip_mean >= greatest && greatest > 0.0;
        if faulty(found) || found.through > 0 || worst {
            illustrate(&mut section, input, &seen::compare(asset, input)?, directory)?;
        }
        sections.push(section);
    }
    let faults = measures.faults();
    let verdict = match faults.as_slice() {
        [] => "passed: error and holes are within what the file promises".into(),
        faults => format!("FAILED: {}", faults.join("; ")),
    };
    let mut notes: Vec<String> = super::table(measures).lines().map(str::to_owned).collect();
    notes.push(format!("input: {}", names[1].display()));
    notes.push(
        "red: the input is hit and no splat is; blue: the other way round; orange: the splats lie far behind \
         the input; the band along the silhouette is not compared"
            .into(),
    );
    let title = format!("qsplat measure {}", names[0].display());
    let page = Page { title, verdict, passed: faults.is_empty(), notes, views: sections };
    let path = directory.join("index.html");
    format::write_file(&path, page.html().as_bytes())?;
    Ok(path)
}

fn faulty(view: &ViewMeasures) -> bool {
    view.missing + view.extra > 0
}

/// The numbers of a view.
fn section(view: &ViewMeasures) -> page::View {
    let none =
        |name, count: u64| Number { name, value: count.to_string(), limit: "0".into(), kept: count == 0 };
    let told = |name, value: String| Number { name, value, limit: String::new(), kept: true };
    page::View {
        name: view.name.clone(),
        passed: !faulty(view),
        numbers: vec![
            none("missing", view.missing),
            none("extra", view.extra),
            told("through", view.through.to_string()),
            told("FLIP mean", format!("{:.5}", view.image.flip_mean)),
            told("FLIP p99", format!("{:.4}", view.image.flip_p99)),
            told("PSNR", format!("{:.1} dB", view.image.psnr)),
            told("SSIM", format!("{:.4}", view.image.ssim)),
            told("normals FLIP", format!("{:.5}", view.image.normal_flip_mean)),
        ],
        ..page::View::default()
    }
}

/// Adds the pictures of a view, the place to look at and the splats that are seen there.
fn illustrate(section: &mut page::View, input: &Drawn, splats: &Compared, directory: &Path) -> Result<()> {
    let heat = difference::flip(&input.shaded, &splats.shaded)?.heat_map(BRIGHTEST);
    let marked = splats.holes.picture(&splats.shaded);
    let four: [(&'static str, &str, &RgbImage); 4] = [
        ("faults: red missing, blue extra, orange through", "holes", &marked),
        ("input", "input", &input.shaded),
        ("splats", "splats", &splats.shaded),
        ("FLIP heat map: black is equal, yellow 0.25 and more", "heat", &heat),
    ];
    for (caption, suffix, picture) in four {
        let file = format!("{}-{suffix}.png", input.view.name);
        png::write(&directory.join(&file), picture)?;
        section.pictures.push(Picture { caption, file });
    }
    section.mark = mark(splats);
    section.notes.extend(nearby(splats));
    Ok(())
}

/// The part of the view with the most faults; the first such in reading order.
fn mark(seen: &Compared) -> Option<Mark> {
    let step = PART / 2;
    let mut counts: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (x, y) in seen.holes.faults() {
        let last = (SIDE - PART) / step;
        let parts = |at: u32| (at / step).saturating_sub(1)..=(at / step).min(last);
        for part in parts(y).flat_map(|row| parts(x).map(move |column| (row, column))) {
            *counts.entry(part).or_default() += 1;
        }
    }
    let most = counts.values().copied().max()?;
    let (row, column) = counts.into_iter().find(|&(_, count)| count == most)?.0;
    let [x, y, part] = [column * step, row * step, PART].map(|pixels| f64::from(pixels) / f64::from(SIDE));
    Some(Mark { x, y, width: part, height: part })
}

/// The splats seen nearest the most faults.
fn nearby(compared: &Compared) -> Option<String> {
    let mut seen: BTreeMap<u32, usize> = BTreeMap::new();
    for (x, y) in compared.holes.faults() {
        let rows = y.saturating_sub(NEAR)..=y + NEAR;
        let around = rows.flat_map(|y| (x.saturating_sub(NEAR)..=x + NEAR).map(move |x| (x, y)));
        let mut here: Vec<u32> = around
            .filter(|&(x, y)| x < SIDE && y < SIDE)
            .filter_map(|(x, y)| compared.splats.at(x, y))
            .map(|hit| hit.index)
            .collect();
        here.sort_unstable();
        here.dedup();
        here.into_iter().for_each(|splat| *seen.entry(splat).or_default() += 1);
    }
    let mut ranked: Vec<(u32, usize)> = seen.into_iter().collect();
    ranked.sort_by_key(|&(splat, count)| (std::cmp::Reverse(count), splat));
    let more =
        if ranked.len() > NAMED { format!(" and {} more", ranked.len() - NAMED) } else { String::new() };
    let names: Vec<String> = ranked.iter().take(NAMED).map(|(splat, _)| splat.to_string()).collect();
    (!names.is_empty())
        .then(|| format!("splats seen within {NEAR} pixels of a fault: {}{more}", names.join(", ")))
}
