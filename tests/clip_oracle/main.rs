//! The clip test against exact arithmetic: random and adversarial conics, a million points.
//!
//! The oracle takes the very bits of the 64-bit inputs and evaluates the same predicate (Ivo 2020,
//! section 3.3, with the conic in implicit form) without rounding, in big integers. Where the two
//! disagree the point must be nearer to the curve, or to the chord, than rounding explains.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

mod cases;
mod exact;

use glam::DVec2;
use qsplat::model::clip_curve::Conic;
use rayon::prelude::*;

/// Points tested in all.
const POINTS: u64 = 1_000_000;

/// Points tested against one conic.
const POINTS_A_CONIC: u64 = 50;

/// Rounding moves the decision by no more than this share of the coordinates' greatest size.
///
/// A signed area is a product of two differences, each right to one rounding, so over the side
/// it stands on it is off by a few roundings of the height; the conic's form adds as many.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// Distance from the curve within which rounding may decide.
fn allowance(conic: &Conic, q: DVec2) -> f64 {
    let sizes = [conic.p1, conic.p2, conic.p3, q].map(|p| p.abs().max_element());
    ROUNDINGS * sizes.into_iter().fold(0.0, f64::max)
}

/// Directions in which the border is looked for.
const DIRECTIONS: u32 = 32;

/// Steps are doubled so many times, from 2^-6 allowances up.
const DOUBLINGS: i32 = 40;

/// How far the point must move, in allowances, for exact arithmetic to decide as the test did: an
/// upper bound of the distance to the border between kept and cut. Finding it needs no distance to
/// the curve, which is hard to trust on a needle.
fn flips_within(conic: &Conic, q: DVec2) -> f64 {
    let (said, allowed) = (conic.cuts(q), allowance(conic, q));
    let around = (0..DIRECTIONS).map(|n| std::f64::consts::TAU * f64::from(n) / f64::from(DIRECTIONS));
    // Into and across a needle, which even directions would pass by.
    let middle = 0.5 * (conic.p1 + conic.p3);
    let special =
        [middle - q, middle - conic.p2, conic.p1 - conic.p2, conic.p3 - conic.p2, conic.p3 - conic.p1]
            .into_iter()
            .map(DVec2::normalize_or_zero)
            .flat_map(|along| [along, -along, along.perp(), -along.perp()]);
    let directions: Vec<DVec2> = around.map(DVec2::from_angle).chain(special).collect();
    let flips =
        |step: &f64| directions.iter().any(|&along| exact::cuts(conic, q + step * allowed * along) == said);
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

struct Miss {
    conic: Conic,
    q: DVec2,
    /// In allowances.
    share: f64,
}

#[test]
fn a_million_points_are_decided_as_exact_arithmetic_decides() {
    let misses: Vec<Miss> = (0..POINTS / POINTS_A_CONIC)
        .into_par_iter()
        .flat_map_iter(|index| {
            let mut random = cases::Random::new(index);
            let conic = cases::conic(index, &mut random);
            let points: Vec<DVec2> =
                (0..POINTS_A_CONIC).map(|n| cases::point(n, &conic, &mut random)).collect();
            points.into_iter().filter_map(move |q| {
                let differ = conic.cuts(q) != exact::cuts(&conic, q);
                differ.then(|| Miss { conic, q, share: flips_within(&conic, q) })
            })
        })
        .collect();
    let worst = misses.iter().max_by(|a, b| a.share.total_cmp(&b.share));
    eprintln!("{POINTS} points, {} decided otherwise by rounding", misses.len());
    if let Some(Miss { conic, q, share }) = worst {
        eprintln!("the farthest is {share:.3} allowances from the curve: {conic:?}, {q:?}");
        let far = misses.iter().filter(|miss| miss.share > 1.0 || miss.share.is_nan()).count();
        assert_eq!(far, 0, "rounding does not explain {far} of {} disagreements", misses.len());
    }
}

#[test]
fn the_oracle_knows_a_circle() {
    // A quarter of the unit circle: inside and outside are known from the radius alone.
    let w = std::f64::consts::FRAC_1_SQRT_2;
    let conic = Conic { p1: DVec2::X, p2: DVec2::ONE, p3: DVec2::Y, rho: w / (1.0 + w) };
    let mut random = cases::Random::new(1);
    let mut near = 0;
    for _ in 0..20_000 {
        let q = DVec2::new(random.unit(), random.unit());
        let outside = q.length() - 1.0;
        if outside.abs() > 1e-14 {
            assert_eq!(exact::cuts(&conic, q), outside > 0.0, "{q:?}");
            near += 1;
        }
    }
    assert!(near > 19_000);
}

#[test]
fn nothing_is_ever_undecided_at_the_extremes() {
    for size in [1e-150, 1e-30, 1.0, 1e30] {
        for rho in [0.0, f64::MIN_POSITIVE, 0.5, 1.0 - f64::EPSILON, 1.0] {
            let at = |x: f64, y: f64| DVec2::new(x, y) * size;
            let conic = Conic { p1: at(-1.0, 0.0), p2: at(0.0, 1.0), p3: at(1.0, 0.0), rho };
            // P2 lies to the left, so the curve turns right: below the chord all is cut, and
            // above P2 nothing is.
            assert!(conic.cuts(at(0.0, -0.5)), "{size} {rho}");
            assert!(!conic.cuts(at(0.0, 1.5)), "{size} {rho}");
        }
    }
}
