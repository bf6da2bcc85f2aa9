//! A quadric that misses no place by more than it may: least squares, reweighted where they do not do.
//!
//! Least squares let a few places lie far off where that brings many nearer. Weights that grow from fit
//! to fit, the more the farther a place lies off for what it may, lead to the fit whose greatest miss
//! is the least (Lawson 1961; Rice and Usow 1968). One that keeps all limits is enough here.

use glam::DVec3;

use super::pose::{Fitting, Principal, above, principal};

/// Fits that are tried before the limits count as too narrow for any quadric. Five keep files about
/// 1 % smaller than three, two make them 1 to 2 % larger.
const FITS: usize = 4;

/// A fit that misses by more than this many times the limit is too far from keeping it.
const HOPELESS: f64 = 3.0;

/// By how much the weight of the place that lies off the farthest grows: it counts so many times more
/// in the next fit, others less by the square of how far they lie off.
const HEAVIER: f64 = 6.0;

/// A place that a quadric has to pass within limits.
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// The place.
    pub point: DVec3,
    /// How many times it counts in a first fit.
    pub weight: f64,
    /// How far it may lie above the quadric, along `k`: lowest, negative, and highest.
    pub range: [f64; 2],
}

impl Limited {
    /// How far it lies off for what it may; at most 1 within the limits.
    fn share(&self, fit: &Principal) -> f64 {
        let above = above(fit.curvature, fit.pose.to_local(self.point));
        above / self.range[usize::from(above > 0.0)]
    }
}

/// The quadric fitted to places that keeps all their limits, from their least-squares fit; `None` if
/// none is found. Their weights grow on the way.
#[must_use]
pub fn within(first: &Principal, fitting: &Fitting, places: &mut [Limited]) -> Option<Principal> {
    let mut fit = *first;
    for _ in 0..FITS {
        let most = most(&fit, places);
        if most <= 1.0 {
            return Some(fit);
        }
        if most > HOPELESS {
            return None;
        }
        for place in places.iter_mut() {
            let share = place.share(&fit) / most;
            place.weight *= 1.0 + HEAVIER * share * share;
        }
        let weighted = places.iter().map(|place| (place.point, place.weight));
        fit = principal(&fit.pose, &fitting.again(), weighted);
    }
    (most(&fit, places) <= 1.0).then_some(fit)
}

/// How far the place that lies off the farthest for what it may does so.
fn most(fit: &Principal, places: &[Limited]) -> f64 {
    places.iter().map(|place| place.share(fit)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::pose::Pose;

    /// A disc that slopes by a cubic, most of its places beside the middle, and its least-squares fit.
    fn cubic(range: [f64; 2]) -> (Vec<Limited>, Fitting, Principal) {
        let place = |n: u32| {
            let (sin, cos) = libm::sincos(2.4 * f64::from(n));
            let radius = (f64::from(n) / 300.0).powi(2);
            let point = DVec3::new(radius * cos, radius * sin, 0.1 * (radius * cos).powi(3));
            Limited { point, weight: 1.0, range }
        };
        let places: Vec<Limited> = (0..=300).map(place).collect();
        let fitting = Fitting::within(1.0);
        let weighted = places.iter().map(|place| (place.point, place.weight));
        let first = principal(&Pose::at(DVec3::ZERO, DVec3::Z), &fitting, weighted);
        (places, fitting, first)
    }

    #[test]
    fn limits_are_kept_that_least_squares_do_not_keep() {
        // Chebyshev: the best line through a cubic misses it by a quarter; along `v` there is none.
        let range = [-0.03, 0.03];
        let (mut places, fitting, first) = cubic(range);
        assert!(most(&first, &places) > 1.2, "{}", most(&first, &places));
        let fit = within(&first, &fitting, &mut places).expect("a cubic can be missed by less");
        for place in &places {
            let above = above(fit.curvature, fit.pose.to_local(place.point));
            assert!((range[0]..=range[1]).contains(&above), "{above} at {}", place.point);
        }
    }

    #[test]
    fn a_side_that_may_sink_more_is_used() {
        let (mut places, fitting, first) = cubic([-0.015, 0.06]);
        assert!(most(&first, &places) > 1.0 && within(&first, &fitting, &mut places).is_some());
    }

    #[test]
    fn no_quadric_keeps_limits_that_are_too_narrow() {
        let (mut places, fitting, first) = cubic([-0.02, 0.02]);
        assert!(within(&first, &fitting, &mut places).is_none(), "a quarter of 0.1 is the least");
        let (mut places, fitting, first) = cubic([-0.005, 0.005]);
        assert!(within(&first, &fitting, &mut places).is_none());
    }
}
