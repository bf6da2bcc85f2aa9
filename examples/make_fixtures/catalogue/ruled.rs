//! A strip of quads between two curves of as many points: walls of extrusions.

use super::curve::{Curve, count, divided};
use super::surface::Surface;

/// Meshes the ruled surface between two curves, in rows no higher than the step.
///
/// Walked along `low`, with `high` to the left, one sees the outside, unless `flip`.
pub fn ruled(surface: &mut Surface, low: &Curve, high: &Curve, step: f64, flip: bool) {
    let height = low.iter().zip(high).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let rows = count(height, step);
    let columns: Vec<Vec<u32>> = low
        .iter()
        .zip(high)
        .map(|(a, b)| divided(*a, *b, rows).into_iter().map(|p| surface.vertex(p)).collect())
        .collect();
    for (n, pair) in columns.windows(2).enumerate() {
        for row in 0..rows {
            quad(surface, [pair[0][row], pair[1][row], pair[1][row + 1], pair[0][row + 1]], n + row, flip);
        }
    }
}

/// Two triangles; the diagonal alternates, so that the mesh leans to no side.
pub fn quad(surface: &mut Surface, [a, b, c, d]: [u32; 4], parity: usize, flip: bool) {
    let halves = if parity.is_multiple_of(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
    for half in halves {
        surface.triangle(half, flip);
    }
}
