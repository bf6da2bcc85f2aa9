//! The clip test against exact arithmetic: random and adversarial conics, a million points.
//!
//! The oracle takes the very bits of the 64-bit inputs and evaluates the same predicate (Ivo 2020,
//! section 3.3, with the conic in implicit form) without rounding, in big integers. Where the two
//! disagree the point must be nearer to the curve, or to the chord, than rounding explains. The
//! WGSL twin answers to the same oracle, in 32 bits.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

mod cases;
#[cfg(feature = "gpu")]
mod device;
mod exact;
mod flips;
#[cfg(feature = "gpu")]
mod twin;

use glam::DVec2;
use qsplat::model::clip_curve::Conic;
use rayon::prelude::*;

use cases::Random;

/// Points tested in all.
const POINTS: u64 = 1_000_000;

/// Points tested against one conic.
const POINTS_A_CONIC: u64 = 50;

/// Rounding moves the decision by no more than this many roundings of the coordinates' greatest
/// size.
///
/// A signed area is a product of two differences, each right to one rounding, so over the side
/// it stands on it is off by a few roundings of the height; the conic's form adds as many.
const ROUNDINGS: f64 = 32.0;

/// The conics of a test by number, and the points that are tested against each.
fn drawn(index: u64, conic: impl Fn(&mut Random) -> Conic) -> (Conic, Vec<DVec2>) {
    let mut random = Random::new(index);
    let conic = conic(&mut random);
    let points = (0..POINTS_A_CONIC).map(|n| cases::point(n, &conic, &mut random)).collect();
    (conic, points)
}

/// Distance from the curve within which rounding by shares of `epsilon` may decide.
fn allowance(conic: &Conic, q: DVec2, epsilon: f64) -> f64 {
    let sizes = [conic.p1, conic.p2, conic.p3, q].map(|p| p.abs().max_element());
    ROUNDINGS * epsilon * sizes.into_iter().fold(0.0, f64::max)
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
            let (conic, points) = drawn(index, |random| {
                let (clip, radii) = cases::clip(index, f64::EPSILON, random);
                clip.conic(radii)
            });
            points.into_iter().filter_map(move |q| {
                let said = conic.cuts(q);
                let allowed = allowance(&conic, q, f64::EPSILON);
                let share = || flips::within(&conic, q, allowed, |q| exact::cuts(&conic, q) == said);
                (said != exact::cuts(&conic, q)).then(|| Miss { conic, q, share: share() })
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
    let mut random = Random::new(1);
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
