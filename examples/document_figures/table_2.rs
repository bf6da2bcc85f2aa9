//! T Table 2: the same edges with fewer bytes, by curved cuts.

use qsplat::Result;
use qsplat::bake::{Clips, MaxError, Options, Silent};
use qsplat::deliver;

use super::layout::Layout;
use super::models::{Model, parts};
use super::page::Page;
use super::plot::Plot;

/// The rows of T Table 2, page 80: radii in percent of `D`, splats, clipped ones.
const DOCUMENT: [(&str, usize, usize); 4] =
    [("0.5 to 4.0", 548, 336), ("1.5 to 4.0", 248, 120), ("2.5 to 4.0", 186, 81), ("3.5 to 4.0", 153, 60)];

/// Error bounds, shares of the diagonal.
const BOUNDS: [f64; 5] = [0.004, 0.002, 0.001, 0.0005, 0.00025];

/// One bake.
struct Baked {
    splats: usize,
    file: usize,
    layout: usize,
}

/// The section.
///
/// # Errors
/// Those of reading, baking and writing.
pub fn make(page: &mut Page) -> Result<()> {
    page.section("T Table 2: the same edges with fewer bytes");
    page.say(
        "The document (section 5.3, page 80; a face of the Fandisk, by eye): curved cuts of splats of \
         2.5 % to 4 % look like straight cuts of splats of 0.5 % to 4 %, in 35.8 % of the bytes (13.21 of \
         36.88 KB). Its rows, from its own counts:",
    );
    document(page)?;
    page.say(
        "Ours: each part baked twice under the same error bound, once with chords alone and once with all \
         cuts. The bound holds cuts and surfaces alike, so both keep the same distance from the edges; \
         where chords cannot follow an edge that near, splats become smaller and more. *Bytes* are of the \
         coded file, *T* counts plain numbers as the document does.",
    );
    let (mut rows, mut curves) = (Vec::new(), Vec::new());
    let parts = parts()?;
    for part in &parts {
        let mut curve = Vec::new();
        for bound in BOUNDS {
            let [straight, curved] = [bake(part, bound, Clips::Straight)?, bake(part, bound, Clips::Curved)?];
            let share = curved.file as f64 / straight.file as f64;
            curve.push((100.0 * bound, 100.0 * share));
            rows.push(vec![
                part.name.clone(),
                format!("{:.3} %", 100.0 * bound),
                straight.splats.to_string(),
                curved.splats.to_string(),
                straight.file.to_string(),
                curved.file.to_string(),
                format!("{:.1} %", 100.0 * share),
                format!("{:.1} %", 100.0 * curved.layout as f64 / straight.layout as f64),
            ]);
        }
        curves.push((part.name.as_str(), curve));
    }
    let columns = [
        "model",
        "bound / D",
        "splats, chords",
        "splats, all cuts",
        "bytes, chords",
        "bytes, all cuts",
        "share",
        "share, T",
    ];
    page.table("table-2", &columns, &rows)?;
    curves.push(("document", vec![(0.0, 35.8), (100.0 * BOUNDS[0], 35.8)]));
    let plot = Plot {
        title: "Bytes with all cuts, in % of those with chords alone",
        across: "error bound, % of D",
        up: "bytes, %",
        curves,
    };
    page.picture("table-2", "bytes with all cuts against bytes with chords alone", &plot.svg()?)
}

fn document(page: &mut Page) -> Result<()> {
    let bytes = |splats, cuts| Layout { splats, cuts, curved: cuts }.bytes();
    let (first, _) = bytes(DOCUMENT[0].1, DOCUMENT[0].2);
    let row = |&(radii, splats, clipped): &(&str, usize, usize)| {
        let (straight, curved) = bytes(splats, clipped);
        vec![
            format!("{radii} %"),
            splats.to_string(),
            clipped.to_string(),
            straight.to_string(),
            curved.to_string(),
            format!("{:.1} %", 100.0 * curved as f64 / first as f64),
        ]
    };
    let columns =
        ["radii / D", "splats", "clipped", "bytes, straight", "bytes, curved", "curved / first straight"];
    page.table("table-2-document", &columns, &DOCUMENT.iter().map(row).collect::<Vec<_>>())
}

fn bake(part: &Model, bound: f64, clips: Clips) -> Result<Baked> {
    let options = Options { max_error: MaxError::Relative(bound), clips, ..part.options() };
    let delivery = deliver::deliver(&part.input, &options, &mut Silent)?;
    let layout = Layout::of(&delivery.asset).bytes().1;
    Ok(Baked { splats: delivery.asset.splats.len(), file: delivery.bytes.len(), layout })
}
