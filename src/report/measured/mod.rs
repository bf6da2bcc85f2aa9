//! Measures as a table for people; with pictures as a page, see [`write_page`].

mod page;

use super::table::{Table, points};
use crate::measure::Measures;
use crate::measure::measures::Distances;
use crate::tolerance::STEP_SHARE;
pub use page::write_page;

/// The measures as lines of plain text, ending in a line break.
#[must_use]
pub fn table(measures: &Measures) -> String {
    let mut text = Table::default();
    text.row(
        "budget",
        format!("{:.3e} of the diagonal of {:.6} input units", measures.budget, measures.diagonal),
    );
    if measures.outliers > 0 {
        text.row("outliers", format!("{} that belong to no surface left out", points(measures.outliers)));
    }
    errors(&mut text, measures);
    pictures(&mut text, measures);
    cost(&mut text, measures);
    text.0
}

fn errors(text: &mut Table, measures: &Measures) {
    let distances = |d: &Distances| {
        let budgets = if measures.budget > 0.0 { d.max / measures.budget } else { 0.0 };
        let at = d.at.map(|at| format!(" at {}", measures.place(at))).unwrap_or_default();
        format!("rms {:.2e}, p99 {:.2e}, max {:.2e} ({budgets:.2} budgets){at}", d.rms, d.p99, d.max)
    };
    let uncovered = match measures.uncovered {
        0 => String::new(),
        count => format!("; {count} points not covered"),
    };
    text.row("fit", distances(&measures.fit) + &uncovered);
    text.row("forward", distances(&measures.forward));
    text.row("backward", distances(&measures.backward));
    let normal = &measures.normal;
    text.row("normal", format!("rms {:.2}°, p99 {:.2}°", normal.rms_deg, normal.p99_deg));
    text.row("edge", measures.edge.as_ref().map_or_else(|| "no feature lines".into(), distances));
    if let Some(steps) = &measures.steps {
        let budgets = if measures.budget > 0.0 { steps.max / measures.budget } else { 0.0 };
        let of = format!("of {} ends of clip curves by more than {STEP_SHARE} budgets", steps.ends);
        text.row("steps", format!("{} {of}, max {:.2e} ({budgets:.2} budgets)", steps.uneven, steps.max));
    }
}

fn pictures(text: &mut Table, measures: &Measures) {
    let (holes, image) = (&measures.holes, &measures.image);
    text.row(
        "holes",
        format!(
            "{} missing, {} extra in {} of {} views; {} seen through; {} pixels compared",
            holes.missing,
            holes.extra,
            holes.views,
            measures.views.len(),
            holes.through,
            holes.pixels
        ),
    );
    let faulty = measures.views.iter().filter(|view| view.missing + view.extra > 0);
    for view in faulty {
        text.row("", format!("{:<20} {:>6} missing {:>6} extra", view.name, view.missing, view.extra));
    }
    text.row(
        "image",
        format!(
            "FLIP mean {:.5}, p99 {:.4}; PSNR {:.2} dB, SSIM {:.5}; normals FLIP {:.5}",
            image.flip_mean, image.flip_p99, image.psnr, image.ssim, image.normal_flip_mean
        ),
    );
}

fn cost(text: &mut Table, measures: &Measures) {
    let cost = &measures.cost;
    text.row(
        "bytes",
        format!("{} ({:.1} a splat, {:.2} a point)", cost.bytes, cost.bytes_per_splat, cost.bytes_per_point),
    );
    text.row(
        "splats",
        format!(
            "{} ({} flat, {} cylinder, {} quadric, {} clipped)",
            cost.splats, cost.flat, cost.cylinder, cost.quadric, cost.clipped
        ),
    );
    let area = cost.overlap.map_or_else(
        || "the area of a cloud is not known".into(),
        |overlap| format!("{overlap:.2} of the input's area"),
    );
    text.row("overlap", area);
    text.row(
        "decoding",
        format!("{:.2} ms, {:.1} MB/s", 1e3 * cost.decode_seconds, cost.decode_megabytes_per_second),
    );
    let frame = format!("{:.1} ms on the CPU ({} threads)", cost.cpu_frame_ms, cost.threads);
    let gpu = cost.gpu.as_ref().map(|gpu| format!(", {:.2} ms on {}", gpu.frame_ms, gpu.adapter));
    text.row("frame", format!("{frame}{}, {:.0} fragments", gpu.unwrap_or_default(), cost.fragments));
}
