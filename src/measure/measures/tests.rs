//! The schema against its document, and the check against planted faults.

use super::*;
use crate::measure::documented::assert_documented;

/// Measures that keep every promise, with everything that may be `None` there.
fn sound() -> Measures {
    let distances = Distances { rms: 1e-4, p99: 2e-4, max: 9e-4, at: Some([1.0, 2.0, 3.0]) };
    Measures {
        schema: SCHEMA.into(),
        diagonal: 3.0,
        kind: MESH.into(),
        budget: 1e-3,
        outliers: 0,
        fit: distances,
        uncovered: 0,
        forward: distances,
        backward: Distances { max: 2e-3, ..distances },
        normal: Angles { rms_deg: 1.0, p99_deg: 3.0 },
        edge: Some(distances),
        steps: Some(Steps::default()),
        holes: Holes { pixels: 1000, ..Holes::default() },
        image: Image { psnr: 40.0, ..Image::default() },
        views: vec![ViewMeasures::default()],
        cost: Cost {
            chunks: vec![Chunk::default()],
            overlap: Some(1.5),
            gpu: Some(GpuFrame::default()),
            ..Cost::default()
        },
    }
}

#[test]
fn every_key_is_documented_and_nothing_else() {
    assert_documented(sound(), &[], include_str!("../../../docs/measure-schema.md"), SCHEMA);
}

#[test]
fn measures_survive_their_json() {
    let back: Measures = serde_json::from_str(&sound().json().unwrap()).unwrap();
    assert_eq!(back, sound());
}

#[test]
fn places_are_told_to_a_millionth_of_the_diagonal() {
    let place = |diagonal: f64| Measures { diagonal, ..sound() }.place([0.125 * diagonal; 3]);
    for (diagonal, told) in [(8.0, "1.000000"), (8e6, "1000000"), (8e-4, "0.0001000000"), (0.0, "0.000000")] {
        assert_eq!(place(diagonal), format!("({told}, {told}, {told})"));
    }
}

#[test]
fn each_broken_promise_is_one_fault() {
    assert_eq!(sound().faults(), Vec::<String>::new());
    type Plant = fn(&mut Measures);
    let breaks: [(&str, Plant); 9] = [
        ("fit max", |m| m.fit.max = 1.1e-3),
        ("fit max", |m| m.fit.max = f64::NAN),
        ("backward max", |m| m.backward.max = 2.1e-3),
        ("forward max", |m| m.forward.max = 2.1e-3),
        ("more than 1.000e-3, at (1.000000, 2.000000, 3.000000)", |m| m.fit.max = 1.1e-3),
        ("edge max", |m| m.edge = Some(Distances { max: 1.1e-3, ..Distances::default() })),
        ("1 pixels are missing", |m| m.holes.missing = 1),
        ("2 pixels are extra", |m| m.holes.extra = 2),
        ("3 points", |m| m.uncovered = 3),
    ];
    for (part, plant) in breaks {
        let mut broken = sound();
        plant(&mut broken);
        let faults = broken.faults();
        assert!(faults.len() == 1 && faults[0].contains(part), "{part}: {faults:?}");
    }
    let mut cloud = sound();
    (cloud.kind, cloud.outliers, cloud.forward.max) = (CLOUD.into(), 3, 1.0);
    assert_eq!(cloud.faults(), Vec::<String>::new(), "a cloud may have outliers");
    cloud.uncovered = 1;
    assert!(cloud.faults()[0].contains("of the cloud are not covered"), "{:?}", cloud.faults());
}
