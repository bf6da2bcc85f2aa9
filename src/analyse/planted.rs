//! Planted clouds, and numbers for them: the same in every run, as if drawn.
#![allow(clippy::unwrap_used)]

use glam::{DVec3, Vec3};

use super::canonical::mix;
use super::cloud_graph::Sites;
use super::nearest::{Nearest, Search, Spacings, spacing};

/// The numbers of [`normal`] are made of others than those of [`random`] of small arguments.
const APART: u64 = 1 << 40;

/// Within `[-1, 1]`, evenly.
pub(crate) fn random(n: u64) -> f64 {
    (mix(n) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// About normal, of variance 1: the sum of twelve numbers (Irwin and Hall).
pub(crate) fn normal(n: u64) -> f64 {
    (0..12).map(|k| 0.5 * random(APART + 16 * n + k)).sum()
}

/// How points of a [`roof`] lie apart.
pub(crate) const ROOF_STEP: f64 = 0.02;

/// How a roof falls from its ridge along x at which it turns by `degrees`.
pub(crate) fn fall(degrees: f64, y: f64) -> f64 {
    -y.abs() * libm::tan(0.5 * degrees.to_radians())
}

/// Points strewn over such a roof above `[-1, 1]²`, which scatter by `noise` in height.
pub(crate) fn roof(degrees: f64, noise: f64) -> Vec<Vec3> {
    let place = |n: u64| {
        let (x, y) = (random(2 * n), random(2 * n + 1));
        DVec3::new(x, y, fall(degrees, y) + noise * normal(n)).as_vec3()
    };
    (0..10_000).map(place).collect()
}

/// What tells what lies around points: a search, the nearest others and the spacing of each.
pub(crate) fn lay(points: &[Vec3]) -> (Search, Nearest, Vec<f32>) {
    let search = Search::new(points).unwrap();
    let nearest = search.nearest();
    let spacing = spacing(points, &nearest);
    (search, nearest, spacing)
}

/// The same as one.
pub(crate) fn spaced<'a>(search: &'a Search, positions: &'a [Vec3], spacing: &'a [f32]) -> Spacings<'a> {
    Spacings { search, positions, spacing }
}

/// Points without noise.
pub(crate) fn side_by_side<'a>(
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    nearest: &'a Nearest,
    spacing: &'a [f32],
) -> Sites<'a> {
    Sites { positions, normals, spacing, nearest, noise: 0.0 }
}

/// A place on a floor with a step up from a quarter of it, whose corner is the origin, and the normal of its face.
pub fn on_step(n: u64) -> (DVec3, DVec3) {
    let (a, b) = (0.5 * random(2 * n), 0.5 * random(2 * n + 1));
    let height = 0.25 + 0.5 * b;
    match n % 4 {
        0 => (DVec3::new(a.abs(), 0.0, height), DVec3::Y),
        1 => (DVec3::new(0.0, a.abs(), height), DVec3::X),
        _ if a > 0.0 && b > 0.0 => (DVec3::new(a, b, 0.5), DVec3::Z),
        _ => (DVec3::new(a, b, 0.0), DVec3::Z),
    }
}
