//! T Table 2: the same edges with fewer bytes, by curved cuts.

use qsplat::bake::{Clips, MaxError, Options, Silent, feature_lines};
use qsplat::measure::edge::edge;
use qsplat::{Result, deliver};

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
#[derive(Clone, Copy)]
struct Baked {
    splats: usize,
    file: usize,
    layout: usize,
    /// Distance between lines and cuts, both ways, root mean square, a share of the diagonal.
    edge: Option<f64>,
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
         cuts. Where chords cannot follow an edge as near as the bound asks, splats become smaller and \
         more. *Edge* is the measured distance between lines and cuts, both \
         ways, root mean square. *Share* is bytes of the coded file, with all cuts over chords alone: at \
         the same bound; with plain numbers, as T counts; and at the same measured edge error, the bytes \
         of the chords read off between their bakes. A bound finer than a model's own facets fits the \
         facets, which curves help little.",
    );
    let (mut rows, mut curves) = (Vec::new(), Vec::new());
    let parts = parts()?;
    for part in &parts {
        let straight = BOUNDS.iter().map(|&bound| bake(part, bound, Clips::Straight));
        let straight = straight.collect::<Result<Vec<_>>>()?;
        let mut curve = Vec::new();
        for (&bound, chords) in BOUNDS.iter().zip(&straight) {
            let all = bake(part, bound, Clips::Curved)?;
            curve.push((100.0 * bound, 100.0 * all.file as f64 / chords.file as f64));
            rows.push(row(&part.name, bound, chords, &all, at_edge(&straight, all.edge)));
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
        "edge / D, chords",
        "edge / D, all cuts",
        "share, same bound",
        "share, as T counts",
        "share, same edge",
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

/// A row of ours; `same_edge` is the bytes of chords at the edge error of all cuts.
fn row(name: &str, bound: f64, chords: &Baked, all: &Baked, same_edge: Option<f64>) -> Vec<String> {
    let share = |of: f64, over: f64| format!("{:.1} %", 100.0 * of / over);
    let edge = |edge: Option<f64>| edge.map_or_else(|| "–".to_owned(), |edge| format!("{edge:.2e}"));
    vec![
        name.to_owned(),
        format!("{:.3} %", 100.0 * bound),
        chords.splats.to_string(),
        all.splats.to_string(),
        chords.file.to_string(),
        all.file.to_string(),
        edge(chords.edge),
        edge(all.edge),
        share(all.file as f64, chords.file as f64),
        share(all.layout as f64, chords.layout as f64),
        same_edge.map_or_else(|| "–".to_owned(), |bytes| share(all.file as f64, bytes)),
    ]
}

/// The bytes at an edge error, between the two bakes it lies between, both on logarithmic scales;
/// `None` where it was not measured or lies beyond all bakes.
fn at_edge(bakes: &[Baked], edge: Option<f64>) -> Option<f64> {
    let edge = libm::log(edge?);
    bakes.windows(2).find_map(|pair| {
        let [a, b] = [pair[0], pair[1]];
        let (from, to) = (libm::log(a.edge?), libm::log(b.edge?));
        let along = (edge - from) / (to - from);
        let (few, many) = (libm::log(a.file as f64), libm::log(b.file as f64));
        (0.0..=1.0).contains(&along).then(|| libm::exp(few + along * (many - few)))
    })
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
    let asset = &delivery.asset;
    let lines = feature_lines(
        &part.input,
        &options.edges,
        delivery.baked.noise,
        options.edge_angle,
        asset.max_error,
    )?;
    let found = lines.and_then(|lines| edge(asset, &lines));
    Ok(Baked {
        splats: asset.splats.len(),
        file: delivery.bytes.len(),
        layout: Layout::of(asset).bytes().1,
        edge: found.map(|found| found.rms / asset.diagonal),
    })
}
