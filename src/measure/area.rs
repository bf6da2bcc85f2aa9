//! The area of a clipped quadric.

use glam::DVec2;

use super::border::Piece;
use super::segment;
use crate::model::splat::Splat;

/// Abscissae and weights of Gauss and Legendre's rule of 8 points on `[-1, 1]`, one half.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// The area of the quadric over the domain within a border, by Green's theorem:
/// `∬ sqrt(1 + |∇w|²) du dv = ∮ P dv` with `∂P/∂u` the integrand. Exact but for the rule of 8
/// points that integrates along each of the flat pieces.
pub(super) fn area(splat: &Splat, border: &[Piece]) -> f64 {
    let piece = |piece: &Piece| -> f64 {
        let term = |x: f64, weight: f64| {
            let (at, along) = segment::conic(&piece.conic, 0.5 + 0.5 * x);
            0.5 * weight * strip(splat.curvature, at) * along.y
        };
        GAUSS.iter().map(|&(x, weight)| term(x, weight) + term(-x, weight)).sum()
    };
    border.iter().map(piece).sum::<f64>().max(0.0)
}

/// `P(u, v)`: the integral of `sqrt(1 + 4a²s² + 4b²v²)` for `s` from 0 to `u`.
fn strip(curvature: DVec2, at: DVec2) -> f64 {
    let slope = 2.0 * curvature.abs() * at.abs();
    let across = libm::sqrt(1.0 + slope.y * slope.y);
    let share = slope.x / across;
    // asinh(x)/x goes to 1, which no division shows near 0.
    let bent = if share > 1e-6 { libm::asinh(share) / share } else { 1.0 };
    0.5 * at.x * across * (libm::sqrt(1.0 + share * share) + bent)
}
