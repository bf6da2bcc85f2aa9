//! The conic nearest to a polyline, between ends that stay.
//!
//! Ivo 2020, section 3.3.3, asks for the `P2` and the shape that bring points at equal shares of arc
//! length on curve and line together, a search whose every step walks the curve. Here the line's
//! points are held against the curve's equation instead, which is linear in what is sought.

use glam::DVec2;
use nalgebra::{Matrix3, Vector3};

use crate::model::clip_curve::{Conic, turn};

/// A line of fewer sides is looked at in more places along each: a curve may not leave a long side unseen.
const LEAST_SIDES: usize = 8;

/// Slopes of the equation are not less: near a corner, where it vanishes, the first order says nothing.
const LEAST_SLOPE: f64 = 1e-2;

/// Rounds in which places are weighed by the slope of the curve before alone.
const SQUARES: usize = 4;

/// Rounds after these in which places also weigh the more the farther they were off.
const GREATEST: usize = 12;

/// Where places are off by so many tolerances on the whole, no weighing brings all within one.
const HOPELESS: f64 = 1.5;

/// A polyline's inner vertices, and places at equal shares of each of its sides: their middles, so that curves
/// along pieces of one line miss all of its sides alike, and more where sides are few.
fn places(line: &[DVec2]) -> impl Iterator<Item = DVec2> + '_ {
    let parts = 2 * LEAST_SIDES.div_ceil(line.len() - 1);
    line.windows(2).enumerate().flat_map(move |(n, side)| {
        let first = usize::from(n == 0);
        (first..parts).map(move |part| side[0].lerp(side[1], part as f64 / parts as f64))
    })
}

/// Coordinates beside a chord: `x` along it in chord lengths, `y` across it in heights of the line.
struct Frame {
    p1: DVec2,
    p3: DVec2,
    /// Height of the line above its chord, in chord lengths; negative where it lies to the right.
    height: f64,
}

impl Frame {
    fn of(line: &[DVec2]) -> Option<Self> {
        let (&p1, &p3) = (line.first()?, line.last()?);
        let length = p1.distance_squared(p3);
        let height =
            line.iter().map(|&p| turn(p1, p3, p) / length).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        (length > 0.0 && height != 0.0 && height.is_finite()).then_some(Self { p1, p3, height })
    }

    fn inside(&self, p: DVec2) -> DVec2 {
        let (chord, from) = (self.p3 - self.p1, p - self.p1);
        DVec2::new(chord.dot(from), chord.perp_dot(from) / self.height) / chord.length_squared()
    }

    fn outside(&self, p: DVec2) -> DVec2 {
        let chord = self.p3 - self.p1;
        self.p1 + p.x * chord + p.y * self.height * chord.perp()
    }
}

/// All conics through the chord's ends but the chord: `x (1 - x) - a y + d x y + c y² = 0`.
///
/// With `P2 = (a, 1) / s`, `s = 2a - d`, the tangents at the ends are `x = a y` and `1 - x = (a - d) y`,
/// and the conic is `(s y)² = 4 w² l1 l3` with the areas of [`Conic::cuts`] as shares of the triangle's.
#[derive(Clone, Copy)]
struct Equation {
    a: f64,
    d: f64,
    c: f64,
}

impl Equation {
    /// The parabola through the ends whose shoulder is as high as the line.
    const PARABOLA: Self = Self { a: 0.25, d: 0.0, c: 0.0 };

    /// The least squares of the distances from places to first order, each over the slope that this equation
    /// has there.
    fn again(&self, places: &[DVec2], weights: &[f64], height: f64) -> Option<Self> {
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (&p, weight) in places.iter().zip(weights) {
            let row = Vector3::new(-p.y, p.x * p.y, p.y * p.y) / self.slope(p, height);
            let value = -p.x * (1.0 - p.x) / self.slope(p, height);
            matrix.syger(*weight, &row, &row, 1.0);
            right.axpy(weight * value, &row, 1.0);
        }
        let solved = matrix.cholesky()?.solve(&right);
        solved.iter().all(|x| x.is_finite()).then_some(Self { a: solved[0], d: solved[1], c: solved[2] })
    }

    /// Its slope at a place, per chord length.
    fn slope(&self, p: DVec2, height: f64) -> f64 {
        let along = 1.0 - 2.0 * p.x + self.d * p.y;
        let across = (-self.a + self.d * p.x + 2.0 * self.c * p.y) / height;
        DVec2::new(along, across).length().max(LEAST_SLOPE)
    }

    /// How far off a place is, to first order, in chord lengths (Taubin 1991).
    fn miss(&self, p: DVec2, height: f64) -> f64 {
        let value = p.x * (1.0 - p.x) - self.a * p.y + self.d * p.x * p.y + self.c * p.y * p.y;
        value.abs() / self.slope(p, height)
    }

    /// As a Bézier curve; a corner where the arms of a hyperbola would not meet. `None` where the tangents meet
    /// on the line's other side.
    fn conic(&self, frame: &Frame) -> Option<Conic> {
        let &Self { a, d, c } = self;
        let s = 2.0 * a - d;
        let roundness = 2.0 * (a * (a - d) - c).max(0.0).sqrt();
        let p2 = frame.outside(DVec2::new(a, 1.0) / s);
        (s > 0.0 && p2.is_finite()).then(|| Conic {
            p1: frame.p1,
            p2,
            p3: frame.p3,
            rho: s / (s + roundness),
        })
    }
}

/// Fits a conic to a polyline so that `is_near` holds of it; its ends are the polyline's.
///
/// Least squares of the distances to first order (Taubin 1991), then rounds of Lawson's weighing
/// (Lawson 1961), which go to the least greatest distance: of all these the conic whose greatest distance is
/// the least. `None` where that is more than `miss`.
#[must_use]
pub fn fit(line: &[DVec2], miss: f64, is_near: impl Fn(&Conic) -> bool) -> Option<Conic> {
    let frame = Frame::of(line)?;
    let miss = miss / frame.p1.distance(frame.p3);
    let places: Vec<DVec2> = places(line).map(|p| frame.inside(p)).collect();
    let mut weights = vec![1.0 / places.len() as f64; places.len()];
    let mut equation = Equation::PARABOLA;
    let mut best: Option<(Conic, f64)> = None;
    for round in 1..=SQUARES + GREATEST {
        let Some(next) = equation.again(&places, &weights, frame.height) else { break };
        equation = next;
        if round < SQUARES {
            continue;
        }
        let misses: Vec<f64> = places.iter().map(|&p| equation.miss(p, frame.height)).collect();
        let greatest = misses.iter().copied().fold(0.0, f64::max);
        if greatest <= best.map_or(miss, |(_, least)| least) {
            let conic = equation.conic(&frame).filter(&is_near);
            best = conic.map(|conic| (conic, greatest)).or(best);
        }
        let mean_square: f64 = weights.iter().zip(&misses).map(|(weight, off)| weight * off * off).sum();
        if mean_square > (HOPELESS * miss).powi(2) {
            break;
        }
        weights.iter_mut().zip(&misses).for_each(|(weight, off)| *weight *= off);
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= total);
    }
    best.map(|(conic, _)| conic)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_conics_come_back() {
        for rho in [0.2, 0.414, 0.5, 0.8] {
            let plant =
                Conic { p1: DVec2::new(-1.0, 0.2), p2: DVec2::new(0.3, -0.9), p3: DVec2::new(0.9, 0.4), rho };
            let line: Vec<DVec2> = plant.points(200).collect();
            let found = fit(&line, MISS, |_| true).expect("a conic");
            assert!(worst(&line, &found) < 2e-4, "rho {rho}: {}, {found:?}", worst(&line, &found));
        }
    }

    const MISS: f64 = 1e-3;

    fn worst(line: &[DVec2], conic: &Conic) -> f64 {
        line.iter().map(|&p| nearest(conic, p)).fold(0.0, f64::max)
    }

    #[test]
    fn a_place_that_least_squares_miss_is_weighed_until_it_is_near() {
        let plant = Conic { p1: DVec2::NEG_X, p2: DVec2::new(0.2, 1.1), p3: DVec2::X, rho: 0.45 };
        let mut line: Vec<DVec2> = plant.points(200).collect();
        line[70].y += 1.5 * MISS;
        let found = fit(&line, MISS, |_| true).expect("a conic");
        assert!(worst(&line, &found) <= MISS, "{}", worst(&line, &found) / MISS);
    }

    #[test]
    fn a_corner_whose_arms_bend_inward_becomes_a_corner() {
        let arm = |from: DVec2, to: DVec2| {
            (0..8).map(move |n| {
                let t = f64::from(n) / 8.0;
                from.lerp(to, t) - DVec2::new(0.0, 2.0 * MISS * t * (1.0 - t))
            })
        };
        let line: Vec<DVec2> =
            arm(DVec2::NEG_X, DVec2::Y).chain(arm(DVec2::Y, DVec2::X)).chain([DVec2::X]).collect();
        let found = fit(&line, MISS, |_| true).expect("a corner");
        assert!(found.rho > 0.99 && worst(&line, &found) <= MISS, "{found:?}");
    }

    #[test]
    fn no_conic_follows_a_dent() {
        let dented = |x: f64| 1.0 - x * x - 40.0 * MISS * (1.0 - 36.0 * x * x).max(0.0);
        let line: Vec<DVec2> =
            (-24..=24).map(|n| f64::from(n) / 24.0).map(|x| DVec2::new(x, dented(x))).collect();
        assert_eq!(fit(&line, MISS, |_| true), None);
    }

    fn nearest(conic: &Conic, p: DVec2) -> f64 {
        conic.points(4000).map(|q| q.distance(p)).fold(f64::MAX, f64::min)
    }
}
