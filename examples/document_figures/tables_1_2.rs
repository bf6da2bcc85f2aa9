//! T Tables 1 and 2: what straight and curved clipping cost.

use qsplat::bake::{Edges, MaxError, Options, Silent};
use qsplat::model::asset::Asset;
use qsplat::model::clip_curve::ClipCurve;
use qsplat::{Result, deliver, format};

use super::models::{Model, external, fixture};
use super::page::Page;

/// Bytes of a splat in the document: 16 numbers of 4 bytes (T 5.3, pages 78 to 80).
const SPLAT: usize = 64;
/// Bytes it adds for a straight cut: 2 numbers.
const STRAIGHT: usize = 8;
/// Bytes it adds for a curved cut: 5 numbers.
const CURVED: usize = 20;

/// The rows of T Table 1, page 79: model, splats, clipped ones.
const TABLE_1: [(&str, usize, usize); 3] =
    [("Cube-S", 619, 233), ("Piston Rod", 4937, 3237), ("Fandisk", 3163, 1060)];

/// The rows of T Table 2, page 80: radii in percent of `D`, splats, clipped ones.
const TABLE_2: [(&str, usize, usize); 4] =
    [("0.5 to 4.0", 548, 336), ("1.5 to 4.0", 248, 120), ("2.5 to 4.0", 186, 81), ("3.5 to 4.0", 153, 60)];

/// The sections.
///
/// # Errors
/// Those of reading, baking and writing.
pub fn make(page: &mut Page) -> Result<()> {
    page.section("T Table 1: bytes of straight and curved clipping");
    page.say(
        "The document (section 5.3, pages 78 to 80) counts 64 bytes a splat, 8 more for a straight cut \
         and 20 more for a curved one, uncompressed. Ours are whole files at the program's defaults, and \
         the same splats stored without cuts, with every cut replaced by its chord, and as they are: what \
         cuts cost is what the file grows by. A splat may carry several cuts; one that is straight in \
         truth is stored as a chord in either column.",
    );
    let mut rows: Vec<Vec<String>> = TABLE_1.iter().map(|row| document(row.0, row.1, row.2)).collect();
    for model in models()? {
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
    ];
    page.table("table-1", &columns, &rows)?;
    page.section("T Table 2: the same look with fewer bytes");
    page.say(
        "The document (section 5.3, page 80; a face of the Fandisk): curved cuts of splats of 2.5 % to \
         4 % look like straight cuts of splats of 0.5 % to 4 %, in 35.8 % of the bytes (13.21 of 36.88 \
         KB). Its rows, from its own counts:",
    );
    let rows: Vec<Vec<String>> = TABLE_2
        .iter()
        .map(|&(radii, splats, clipped)| {
            let (straight, curved) = document_bytes(splats, clipped);
            vec![
                format!("{radii} %"),
                splats.to_string(),
                clipped.to_string(),
                straight.to_string(),
                curved.to_string(),
                format!("{:.1} %", 100.0 * curved as f64 / document_bytes(548, 336).0 as f64),
            ]
        })
        .collect();
    let columns =
        ["radii / D", "splats", "clipped", "bytes straight", "bytes curved", "curved / first straight"];
    page.table("table-2-document", &columns, &rows)
}

/// CAD parts with their lines.
fn models() -> Result<Vec<Model>> {
    let mut models = vec![fixture("capped-cylinder.ply")?, fixture("plate.ply")?, fixture("part.ply")?];
    models.extend(external("fandisk.obj")?);
    models.extend(external("bumpy-cube.obj")?);
    Ok(models)
}

/// Bytes with straight and with curved cuts, as the document counts.
fn document_bytes(splats: usize, clipped: usize) -> (usize, usize) {
    (SPLAT * splats + STRAIGHT * clipped, SPLAT * splats + CURVED * clipped)
}

/// How many bytes more `larger` has, in percent.
fn more(smaller: usize, larger: usize) -> String {
    format!("{:.2} %", 100.0 * (larger as f64 / smaller as f64 - 1.0))
}

fn document(name: &str, splats: usize, clipped: usize) -> Vec<String> {
    let (straight, curved) = document_bytes(splats, clipped);
    vec![
        format!("T: {name}"),
        splats.to_string(),
        clipped.to_string(),
        "–".into(),
        "–".into(),
        SPLAT.to_string(),
        straight.to_string(),
        curved.to_string(),
        more(straight, curved),
    ]
}

fn ours(model: &Model) -> Result<Vec<String>> {
    let asset = deliver::deliver(&model.input, &options(model), &mut Silent)?.asset;
    let counts = asset.counts();
    let bytes = |change: fn(&ClipCurve) -> Option<ClipCurve>| -> Result<usize> {
        Ok(format::encode(&with_cuts(&asset, change))?.len())
    };
    let uncut = bytes(|_| None)?;
    let chords = bytes(|clip| Some(ClipCurve::chord(clip.alpha1, clip.alpha3)))?;
    let curves = bytes(|clip| Some(*clip))?;
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

/// The program's defaults, with the model's lines where they are known.
fn options(model: &Model) -> Options {
    Options {
        max_error: MaxError::default(),
        edges: model.lines.clone().map_or(Edges::Auto, Edges::Given),
        edge_angle: 40.0,
        effort: 5,
        normals: Default::default(),
        colors: Default::default(),
    }
}
