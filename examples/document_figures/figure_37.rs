//! T Figure 37: splats, their area and the time, against the radius of a uniform sampling.

use std::time::Instant;

use qsplat::{Result, deliver};

use super::models::{mesh, or_fixture};
use super::page::Page;
use super::plot::Plot;
use super::scatter::scatter;
use super::uniform::{Cloud, Sampling};

/// Radii, shares of the diagonal.
const RADII: [f64; 8] = [0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04];

/// Points of the cloud, T 5.1, page 74: exactly a million, pseudo-random over the surface.
const POINTS: usize = 1_000_000;

/// Runs whose median is the time.
const RUNS: usize = 5;

/// One row: radius, sampling, seconds.
type Row = (f64, Sampling, f64);

/// The section.
///
/// # Errors
/// Those of reading the model and writing the page.
pub fn make(page: &mut Page) -> Result<()> {
    let model = or_fixture("fertility-smooth.ply", "blob.ply")?;
    let mesh = mesh(&model)?;
    let scattered = scatter(mesh, POINTS);
    let begin = Instant::now();
    let cloud = Cloud::new(&scattered)?;
    let tree_seconds = begin.elapsed().as_secs_f64();
    let diagonal = deliver::model(&model.input).diagonal();
    let rows: Vec<Row> = RADII.iter().map(|&share| row(&cloud, share, diagonal)).collect();
    page.section("T Figure 37: uniform sampling against the radius");
    page.say(&format!(
        "The document (section 5.1, pages 73 to 76, curves without numbers): with the radius the number \
         of splats falls steeply and not linearly, the total area falls less and levels off, and the time \
         falls. Ours: {}, {POINTS} points, region growing after Wu and Kobbelt with the convex-hull rule \
         as in its sections 2.2.1 and 3.1, one thread, median of {RUNS} runs without the search tree \
         ({tree_seconds:.2} s). The area is a multiple of the surface's. {}",
        model.name,
        verdict(&rows),
    ));
    let columns = ["radius / D", "splats", "total area / surface", "seconds"];
    let cells = |(share, sampling, seconds): &Row| {
        vec![
            format!("{:.2} %", 100.0 * share),
            sampling.splats.to_string(),
            format!("{:.3}", sampling.area / scattered.area),
            format!("{seconds:.2}"),
        ]
    };
    page.table("figure-37", &columns, &rows.iter().map(cells).collect::<Vec<_>>())?;
    let curve = |value: &dyn Fn(&Row) -> f64| rows.iter().map(|row| (100.0 * row.0, value(row))).collect();
    for (name, up, values) in [
        ("splats", "splats", curve(&|row| row.1.splats as f64)),
        ("area", "total area / surface", curve(&|row| row.1.area / scattered.area)),
        ("time", "seconds", curve(&|row| row.2)),
    ] {
        let title = format!("{}: {up} against the radius", model.name);
        let plot = Plot { title: &title, across: "radius, % of D", up, curves: vec![(up, values)] };
        page.picture(&format!("figure-37-{name}"), &title, &plot.svg()?)?;
    }
    Ok(())
}

fn row(cloud: &Cloud, share: f64, diagonal: f64) -> Row {
    let mut seconds = Vec::with_capacity(RUNS);
    let mut sampling = Sampling { splats: 0, area: 0.0 };
    for _ in 0..RUNS {
        let begin = Instant::now();
        sampling = cloud.sample(share * diagonal);
        seconds.push(begin.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    (share, sampling, seconds[RUNS / 2])
}

/// Which of the document's findings hold here.
fn verdict(rows: &[Row]) -> String {
    let falls = |value: &dyn Fn(&Row) -> f64| {
        let until = rows.windows(2).take_while(|pair| value(&pair[1]) < value(&pair[0])).count();
        let least = rows.iter().map(value).fold(f64::INFINITY, f64::min);
        match rows.last() {
            Some(last) if until + 1 < rows.len() => format!(
                "falls up to a radius of {:.2} % and ends {:.0} % above its least",
                100.0 * rows[until].0,
                100.0 * (value(last) / least - 1.0)
            ),
            _ => "falls at every step".to_owned(),
        }
    };
    let exponent = match (rows.first(), rows.last()) {
        (Some(first), Some(last)) => {
            libm::log(last.1.splats as f64 / first.1.splats as f64) / libm::log(last.0 / first.0)
        }
        _ => 0.0,
    };
    format!(
        "Here the number of splats {}, as the radius to the power {exponent:.2}; the area {}; the time {}.",
        falls(&|row| row.1.splats as f64),
        falls(&|row| row.1.area),
        falls(&|row| row.2),
    )
}
