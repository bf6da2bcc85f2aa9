//! A sweep with planted numbers: the schema against its document, the fronts, the page.

#![allow(clippy::unwrap_used)]

use super::axis::{curves, mark_fronts, slopes};
use super::pictures::{Album, Shown};
use super::schema::{Outcome, Run};
use super::*;
use crate::bake::StageTime;
use crate::measure::Measures;
use crate::measure::documented::assert_documented;
use crate::measure::measures::{Angles, Chunk, Cost, Distances, Holes, Image};

/// Numbers as a smooth surface would give them: splats as a power of the budget, twenty bytes
/// each, a second a thousand.
fn outcome(budget: f64, splats: f64) -> Outcome {
    let distances = |share: f64| Distances { rms: 0.3 * share, p99: 0.8 * share, max: share, at: None };
    let bytes = 20.0 * splats;
    let chunk = |name: &str, share: f64| Chunk {
        name: name.into(),
        raw_bytes: (2.0 * share * bytes) as u64,
        coded_bytes: (share * bytes) as u64,
    };
    let measures = Measures {
        schema: crate::measure::measures::SCHEMA.into(),
        diagonal: 3.0,
        kind: "mesh".into(),
        budget,
        outliers: 0,
        fit: distances(0.9 * budget),
        uncovered: 0,
        forward: distances(budget),
        backward: distances(1.5 * budget),
        normal: Angles { rms_deg: 1.0, p99_deg: 3.0 },
        edge: Some(distances(budget)),
        steps: None,
        holes: Holes::default(),
        image: Image {
            flip_mean: 2.0 * budget,
            flip_p99: 0.1,
            psnr: 40.0,
            ssim: 0.99,
            normal_flip_mean: 0.02,
        },
        views: Vec::new(),
        cost: Cost {
            bytes: bytes.round() as u64,
            head_bytes: 100,
            chunks: vec![chunk("POSN", 0.6), chunk("NORM", 0.3)],
            splats: splats.round() as u64,
            clipped: 5,
            ..Cost::default()
        },
    };
    let stage = |name: &str, share: f64| StageTime {
        name: name.into(),
        wall_seconds: share * splats / 1000.0,
        cpu_seconds: 2.0 * share * splats / 1000.0,
    };
    Outcome {
        bake_seconds: splats / 1000.0,
        bake_cpu_seconds: splats / 500.0,
        stages: vec![stage("sample", 0.9), stage("encode", 0.1)],
        frame_ms: 20.0,
        measures,
    }
}

const BUDGETS: [(&str, f64); 3] = [("1%", 1e-2), ("0.1%", 1e-3), ("0.01%", 1e-4)];

/// Quadrics grow by -2/3, planes by -1, chords by -2/3 from half as many again; one case failed.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (variant, effort, power, factor) in [
        ("all", 1, -2.0 / 3.0, 1.2),
        ("all", 5, -2.0 / 3.0, 1.0),
        ("flat", 5, -1.0, 1.0),
        ("straight", 5, -2.0 / 3.0, 1.5),
    ] {
        for (max_error, budget) in BUDGETS {
            let failed = variant == "straight" && budget < 1e-3;
            cases.push(Case {
                variant: variant.into(),
                max_error: max_error.into(),
                effort,
                failure: failed.then(|| "it broke at <place> & stopped".into()),
                outcome: (!failed).then(|| outcome(budget, 10.0 * factor * libm::pow(budget, power))),
                fronts: Vec::new(),
            });
        }
    }
    cases
}

fn swept() -> Swept {
    let mut cases = cases();
    mark_fronts(&mut cases);
    let slopes = slopes(&cases);
    let sound = Model {
        name: "part <1>".into(),
        path: "models/part <1>.ply".into(),
        edges: "auto".into(),
        kind: Some("mesh".into()),
        points: 12_345,
        triangles: 24_686,
        read_seconds: 0.25,
        failure: None,
        cases,
        slopes,
    };
    let lost = Model {
        name: "lost".into(),
        path: "lost.ply".into(),
        kind: None,
        failure: Some("lost.ply: no such file".into()),
        cases: vec![],
        slopes: vec![],
        ..sound.clone()
    };
    let run =
        Run { threads: 2, jobs: 1, frames: 5, frame_size: [512, 512], frame_device: "CPU reference".into() };
    let shown = Shown {
        input: Some(b"input".to_vec()),
        cases: sound
            .cases
            .iter()
            .map(|c| c.outcome.as_ref().map(|_| [b"shaded".to_vec(), b"splats".to_vec()]))
            .collect(),
    };
    let sweep =
        Sweep { schema: schema::SCHEMA.into(), generator: "qsplat 0".into(), run, models: vec![sound, lost] };
    Swept { sweep, album: Album { models: vec![shown, Shown::default()] } }
}

#[test]
fn every_key_is_documented_and_nothing_else() {
    // The measures have a document of their own.
    let document = include_str!("../../docs/sweep-schema.md");
    assert_documented(swept().sweep, &["measures"], document, schema::SCHEMA);
}

#[test]
fn a_sweep_survives_its_json() {
    let sweep = swept().sweep;
    let back: Sweep = serde_json::from_str(&sweep.json().unwrap()).unwrap();
    assert_eq!(back, sweep);
    assert_eq!(sweep.failures(), 2, "a case and an input");
}

#[test]
fn planted_exponents_and_fronts_come_back() {
    let swept = swept();
    let model = &swept.sweep.models[0];
    let curves = curves(&model.cases);
    let names: Vec<(&str, u8, usize)> = curves.iter().map(|c| (c.variant, c.effort, c.cases.len())).collect();
    assert_eq!(names, [("all", 1, 3), ("all", 5, 3), ("flat", 5, 3), ("straight", 5, 2)]);
    for (curve, expected) in curves.iter().zip([-2.0 / 3.0, -2.0 / 3.0, -1.0, -2.0 / 3.0]) {
        for (error, cost) in [(axis::BUDGET, axis::SPLATS), (axis::ERRORS[0], axis::COSTS[1])] {
            let slope = model.slope(curve, &error, &cost).unwrap();
            // Splats are counted in whole numbers.
            assert!((slope.slope - expected).abs() < 5e-3, "{slope:?}");
            assert!((slope.expected.unwrap() - expected).abs() < 1e-12, "{slope:?}");
        }
        assert_eq!(model.slope(curve, &axis::BUDGET, &axis::COSTS[0]).unwrap().expected, None);
    }
    // At equal error effort 5 is cheapest, and every budget of it is on the front. The equal
    // frame times leave only the least error.
    for case in &model.cases {
        let on = case.fronts.contains(&"fit_max/bytes".to_owned());
        assert_eq!(on, case.variant == "all" && case.effort == 5, "{case:?}");
        let frame = case.fronts.contains(&"fit_max/frame_ms".to_owned());
        assert_eq!(frame, case.outcome.is_some() && case.max_error == "0.01%", "{case:?}");
    }
}

#[test]
fn the_page_shows_everything_and_needs_no_network() {
    let swept = swept();
    let html = page::html(&swept.sweep, &swept.album).unwrap();
    assert!(!html.contains("http") || !html.replace("http://www.w3.org/2000/svg", "").contains("http"));
    assert!(html.contains("part &lt;1&gt;") && !html.contains("part <1>"), "names are escaped");
    assert_eq!(html.matches("<tr class=\"failed\">").count(), 1, "the failed case is a red row");
    assert!(
        html.contains("it broke at &lt;place&gt; &amp; stopped") && html.contains("lost.ply: no such file")
    );
    // Three errors against three costs, splats against budgets, stages, chunks; five curves' swatches.
    assert_eq!(html.matches("<figure><svg").count() + html.matches("</ul><svg").count(), 12);
    assert_eq!(html.matches("data:image/png;base64,aW5wdXQ=").count(), 1);
    assert_eq!(html.matches("alt=\"shaded\"").count(), 11);
    for text in [
        "planes only, effort 5",
        "chords only",
        "POSN",
        "sample",
        "bake time, s",
        "file size, kB",
        "mean FLIP",
    ] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn the_csv_has_a_row_a_case_and_quotes_what_must_be() {
    let sweep = swept().sweep;
    let text = csv::csv(&sweep).unwrap();
    let mut table = ::csv::Reader::from_reader(text.as_bytes());
    let head = table.headers().unwrap().clone();
    let column = |name: &str| head.iter().position(|head| head == name).unwrap();
    let rows: Vec<::csv::StringRecord> = table.records().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len(), 13, "twelve cases and an input that was lost");
    assert_eq!(&rows[1][column("bytes")], "24000");
    assert_eq!(&rows[1][column("budget")], "0.001");
    assert_eq!(&rows[11][column("failure")], "it broke at <place> & stopped");
    assert_eq!((&rows[11][column("bytes")], &rows[12][column("model")]), ("", "lost"));
}
