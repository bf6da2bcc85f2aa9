//! T Table 1: what straight and curved clipping cost.

use qsplat::bake::Silent;
use qsplat::model::asset::Asset;
use qsplat::model::clip_curve::ClipCurve;
use qsplat::{Result, deliver, format};

use super::layout::Layout;
use super::models::{Model, parts};
use super::page::Page;

/// The rows of T Table 1, page 79: model, splats, clipped ones.
const DOCUMENT: [(&str, usize, usize); 3] =
    [("Cube-S", 619, 233), ("Piston Rod", 4937, 3237), ("Fandisk", 3163, 1060)];

/// The section.
///
/// # Errors
/// Those of reading, baking and writing.
pub fn make(page: &mut Page) -> Result<()> {
    page.section("T Table 1: bytes of straight and curved clipping");
    page.say(
        "The document (section 5.3, pages 78 to 80) counts 64 bytes a splat, 8 more for a straight cut \
         and 20 more for a curved one, uncompressed; its rows follow from its counts, and agree with its \
         kibibytes. Ours are whole files at the program's defaults, coded: the same splats stored without \
         cuts, with every cut replaced by its chord, and as they are. A splat may carry several cuts, and \
         one that is straight in truth is a chord in either column. The last column counts ours as the \
         document does, with 8 bytes a straight cut and 20 a curved one.",
    );
    let mut rows: Vec<Vec<String>> = DOCUMENT.iter().map(|row| document(row.0, row.1, row.2)).collect();
    for model in parts()? {
        rows.push(ours(&model)?);
    }
    let columns = [
        "model",
        "splats",
        "clipped",
        "straight cuts",
        "curved cuts",
        "bytes a splat uncut",
        "bytes, chords",
        "bytes, curves",
        "more",
        "more as T counts",
    ];
    page.table("table-1", &columns, &rows)
}

/// How many bytes more `larger` has, in percent.
fn more(smaller: usize, larger: usize) -> String {
    format!("{:.2} %", 100.0 * (larger as f64 / smaller as f64 - 1.0))
}

fn document(name: &str, splats: usize, clipped: usize) -> Vec<String> {
    let (straight, curved) = Layout { splats, cuts: clipped, curved: clipped }.bytes();
    vec![
        format!("T: {name}"),
        splats.to_string(),
        clipped.to_string(),
        "–".into(),
        "–".into(),
        Layout { splats: 1, cuts: 0, curved: 0 }.bytes().0.to_string(),
        straight.to_string(),
        curved.to_string(),
        more(straight, curved),
        more(straight, curved),
    ]
}

fn ours(model: &Model) -> Result<Vec<String>> {
    let asset = deliver::deliver(&model.input, &model.options(), &mut Silent)?.asset;
    let counts = asset.counts();
    let bytes = |change: fn(&ClipCurve) -> Option<ClipCurve>| -> Result<usize> {
        Ok(format::encode(&with_cuts(&asset, change))?.len())
    };
    let uncut = bytes(|_| None)?;
    let chords = bytes(|clip| Some(ClipCurve::chord(clip.alpha1, clip.alpha3)))?;
    let curves = bytes(|clip| Some(*clip))?;
    let (straight, curved) = Layout::of(&asset).bytes();
    Ok(vec![
        model.name.clone(),
        counts.splats.to_string(),
        counts.clipped.to_string(),
        counts.straight_clips.to_string(),
        counts.curved_clips.to_string(),
        format!("{:.1}", uncut as f64 / counts.splats as f64),
        chords.to_string(),
        curves.to_string(),
        more(chords, curves),
        more(straight, curved),
    ])
}

/// The asset with each of its cuts changed, or dropped.
fn with_cuts(asset: &Asset, change: fn(&ClipCurve) -> Option<ClipCurve>) -> Asset {
    let mut asset = asset.clone();
    for splat in &mut asset.splats {
        splat.clips = splat.clips.iter().filter_map(change).collect();
    }
    asset
}
