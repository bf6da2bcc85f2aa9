//! How far a point is from where it would be decided otherwise.

use glam::DVec2;
use qsplat::model::clip_curve::Conic;

/// Directions in which the border is looked for.
const DIRECTIONS: u32 = 32;

/// Steps are doubled so many times, from 2^-6 allowances up.
const DOUBLINGS: i32 = 40;

/// How far the point must move, in allowances, until it is decided as the test did: an upper bound
/// of the distance to the border between kept and cut. Finding it needs no distance to the curve,
/// which is hard to trust on a needle.
pub fn within(conic: &Conic, q: DVec2, allowed: f64, decided_so: impl Fn(DVec2) -> bool) -> f64 {
    let around = (0..DIRECTIONS).map(|n| std::f64::consts::TAU * f64::from(n) / f64::from(DIRECTIONS));
    // Into and across a needle, which even directions would pass by.
    let middle = 0.5 * (conic.p1 + conic.p3);
    let special =
        [middle - q, middle - conic.p2, conic.p1 - conic.p2, conic.p3 - conic.p2, conic.p3 - conic.p1]
            .into_iter()
            .map(DVec2::normalize_or_zero)
            .flat_map(|along| [along, -along, along.perp(), -along.perp()]);
    let directions: Vec<DVec2> = around.map(DVec2::from_angle).chain(special).collect();
    let flips = |step: &f64| directions.iter().any(|&along| decided_so(q + step * allowed * along));
    let mut steps = (0..DOUBLINGS).map(|n| libm::ldexp(1.0, n - 6));
    // In a needle about as thin as the grid of floats no step may find the inside. But its ends and
    // its shoulder are on the border, and its axis is no farther from it than the triangle is wide.
    let shoulder = conic.point(0.5);
    let (axis, away) = (shoulder - middle, q - middle);
    let t = away.dot(axis) / axis.length_squared();
    let width = conic.p1.distance(conic.p3) * q.distance(conic.p2) / middle.distance(conic.p2);
    let from_axis = if (0.0..=1.0).contains(&t) { away.distance(t * axis) + width } else { f64::INFINITY };
    let known = [conic.p1, conic.p3, shoulder].map(|p| q.distance(p)).into_iter().chain([from_axis]);
    let known = known.map(|distance| distance / allowed);
    known.fold(steps.find(flips).unwrap_or(f64::INFINITY), f64::min)
}
