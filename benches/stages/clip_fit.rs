//! `clip fit`: the nearest conics to pieces of curved lines. Floor: the neighbour pass over as
//! many points as the lines have.

use criterion::Criterion;
use glam::DVec2;
use qsplat::Result;
use qsplat::analyse::canonical::mix;
use qsplat::fit::clip::{ClipTolerance, Clips, fit};
use qsplat::model::clip_curve::ClipCurve;
use qsplat::sample::budget::Budget;
use rayon::prelude::*;
use serde_json::json;

use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{cloud, floor};

/// Points of a line.
const VERTICES: usize = 32;

/// Every splat's domain.
const RADII: DVec2 = DVec2::new(0.02, 0.015);

/// Bound of the error, in model units: a twentieth of the domain, about as in a bake.
const MAX_ERROR: f64 = 1e-3;

pub fn bench(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    let tolerance = Budget::new(MAX_ERROR, Clips::Curved).clip;
    for points in inputs() {
        let lines: Vec<Vec<DVec2>> = (0..points / VERTICES).map(|n| line(n as u64)).collect();
        let fitted = curves(&lines, &tolerance).iter().filter(|curves| curves.is_some()).count();
        notes.add("clip fit", points, json!({ "lines": lines.len(), "fitted": fitted }));
        let positions = cloud::cloud(points).positions;
        let stage = || curves(&lines, &tolerance);
        beside(criterion, "clip fit", points, stage, || floor::neighbour_pass(&positions));
    }
    Ok(())
}

fn curves(lines: &[Vec<DVec2>], tolerance: &ClipTolerance) -> Vec<Option<Vec<ClipCurve>>> {
    lines.par_iter().map(|line| fit(line, false, RADII, tolerance)).collect()
}

/// A seeded piece of a cosine, from outside the domain through it and out again.
fn line(n: u64) -> Vec<DVec2> {
    let random = |which: u64| (mix(5 * n + which) >> 11) as f64 / (1_u64 << 53) as f64;
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * random(0));
    let (off, bend, turn) = (random(1) - 0.5, 0.6 * random(2) - 0.3, 1.0 + random(3));
    (0..VERTICES)
        .map(|vertex| {
            let x = 3.0 * vertex as f64 / (VERTICES - 1) as f64 - 1.5;
            let y = 0.6 * off + bend * libm::cos(turn * x);
            RADII.max_element() * DVec2::new(cos * x - sin * y, sin * x + cos * y)
        })
        .collect()
}
