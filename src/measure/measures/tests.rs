//! The schema against its document, and the check against planted faults.

use std::collections::BTreeSet;

use serde_json::Value;

use super::*;

/// Measures that keep every promise, with everything that may be `None` there.
fn sound() -> Measures {
    let distances = Distances { rms: 1e-4, p99: 2e-4, max: 9e-4 };
    Measures {
        schema: SCHEMA.into(),
        diagonal: 3.0,
        kind: MESH.into(),
        budget: 1e-3,
        fit: distances,
        uncovered: 0,
        forward: distances,
        backward: Distances { max: 2e-3, ..distances },
        normal: Angles { rms_deg: 1.0, p99_deg: 3.0 },
        edge: Some(distances),
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

/// Every key as a path: `cost.chunks[].name`.
fn paths(value: &Value, at: &str, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
                into.insert(path.clone());
                paths(value, &path, into);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| paths(item, &format!("{at}[]"), into)),
        _ => {}
    }
}

#[test]
fn every_key_is_documented_and_nothing_else() {
    let mut written = BTreeSet::new();
    paths(&serde_json::to_value(sound()).unwrap(), "", &mut written);
    let document = include_str!("../../../docs/measure-schema.md");
    let rows = document.lines().filter_map(|line| line.strip_prefix("| `"));
    let documented: BTreeSet<String> =
        rows.filter_map(|row| row.split('`').next()).map(str::to_owned).collect();
    assert_eq!(documented, written);
    assert!(document.contains(SCHEMA));
}

#[test]
fn measures_survive_their_json() {
    let back: Measures = serde_json::from_str(&sound().json().unwrap()).unwrap();
    assert_eq!(back, sound());
}

#[test]
fn each_broken_promise_is_one_fault() {
    assert_eq!(sound().faults(), Vec::<String>::new());
    type Plant = fn(&mut Measures);
    let breaks: [(&str, Plant); 6] = [
        ("fit max", |m| m.fit.max = 1.1e-3),
        ("fit max", |m| m.fit.max = f64::NAN),
        ("backward max", |m| m.backward.max = 2.1e-3),
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
    (cloud.kind, cloud.uncovered) = (CLOUD.into(), 3);
    assert_eq!(cloud.faults(), Vec::<String>::new(), "a cloud may have outliers");
}
