//! The conic nearest to a polyline, between ends that stay.
//!
//! Ivo 2020, section 3.3.3: minimises the distance between points equally spaced in arc
//! length on curve and line, over `P2` and the shape, by damped least squares (MINPACK's
//! `lmder`, in the crate `levenberg-marquardt`).

use glam::DVec2;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{OMatrix, SVector, U3, U32};

use crate::model::clip_curve::Conic;

/// Points compared on curve and line, the ends (which agree) not counted.
const COMPARED: usize = 16;

/// Sides of the polyline that stands for the curve while its arc length is measured.
const SIDES: usize = 96;

/// Step of the numeric derivative, in chord lengths: about the cube root of the rounding.
const STEP: f64 = 1e-6;

/// The fit stops when it changes by less than this share: below what the file keeps.
const ENOUGH: f64 = 1e-5;

/// Steps of the fit, times four: it starts near and converges fast where it converges.
const PATIENCE: usize = 10;

type Residuals = SVector<f64, 32>;
type Parameters = SVector<f64, 3>;

/// Points at equal shares of a polyline's arc length, its ends left out.
#[must_use]
pub fn equally_spaced(line: &[DVec2], count: usize) -> Vec<DVec2> {
    let sides: Vec<f64> = line.windows(2).map(|side| side[0].distance(side[1])).collect();
    let total: f64 = sides.iter().sum();
    let mut out = Vec::with_capacity(count);
    let (mut at, mut walked) = (0, 0.0);
    for n in 1..=count {
        let target = total * n as f64 / (count + 1) as f64;
        while at + 1 < sides.len() && walked + sides[at] < target {
            walked += sides[at];
            at += 1;
        }
        let side = sides[at];
        let share = if side > 0.0 { ((target - walked) / side).clamp(0.0, 1.0) } else { 0.0 };
        out.push(line[at].lerp(line[at + 1], share));
    }
    out
}

struct Problem<'a> {
    start: Conic,
    chord: f64,
    targets: &'a [DVec2],
    parameters: Parameters,
}

impl Problem<'_> {
    /// `P2` moves in chord lengths; the shape's free number maps the real line into (0, 1).
    fn conic(&self, x: &Parameters) -> Conic {
        let p2 = self.start.p2 + self.chord * DVec2::new(x[0], x[1]);
        Conic { p2, rho: 0.5 + 0.5 * x[2] / (1.0 + x[2] * x[2]).sqrt(), ..self.start }
    }

    fn residuals_at(&self, x: &Parameters) -> Residuals {
        let curve: Vec<DVec2> = self.conic(x).points(SIDES).collect();
        let spaced = equally_spaced(&curve, COMPARED);
        let mut out = Residuals::zeros();
        for (n, (p, target)) in spaced.iter().zip(self.targets).enumerate() {
            let miss = (*p - *target) / self.chord;
            out[2 * n] = miss.x;
            out[2 * n + 1] = miss.y;
        }
        out
    }
}

impl LeastSquaresProblem<f64, U32, U3> for Problem<'_> {
    type ResidualStorage = Owned<f64, U32>;
    type JacobianStorage = Owned<f64, U32, U3>;
    type ParameterStorage = Owned<f64, U3>;

    fn set_params(&mut self, x: &Parameters) {
        self.parameters = *x;
    }

    fn params(&self) -> Parameters {
        self.parameters
    }

    fn residuals(&self) -> Option<Residuals> {
        let r = self.residuals_at(&self.parameters);
        r.iter().all(|x| x.is_finite()).then_some(r)
    }

    fn jacobian(&self) -> Option<OMatrix<f64, U32, U3>> {
        let mut out = OMatrix::<f64, U32, U3>::zeros();
        for column in 0..3 {
            let (mut more, mut less) = (self.parameters, self.parameters);
            more[column] += STEP;
            less[column] -= STEP;
            let slope = (self.residuals_at(&more) - self.residuals_at(&less)) / (2.0 * STEP);
            out.set_column(column, &slope);
        }
        out.iter().all(|x| x.is_finite()).then_some(out)
    }
}

/// The conic with a polyline's ends, end tangents and shoulder: the one that passes through
/// where the polyline crosses the line from the chord's middle to the tangents' meeting.
///
/// Exact for a polyline on a conic, and found without iteration. `None` where the tangents do
/// not meet on one side of the chord.
#[must_use]
pub fn through_tangents(line: &[DVec2]) -> Option<Conic> {
    let (&p1, &p3) = (line.first()?, line.last()?);
    let (to1, to3) = (line.get(1)? - p1, p3 - line[line.len() - 2]);
    let across = to1.perp_dot(to3);
    // p1 + s to1 = p3 - t to3
    let (s, t) = ((p3 - p1).perp_dot(to3) / across, to1.perp_dot(p3 - p1) / across);
    if !(s > 0.0 && t > 0.0 && s.is_finite() && t.is_finite()) {
        return None;
    }
    let p2 = p1 + s * to1;
    let middle = 0.5 * (p1 + p3);
    let axis = p2 - middle;
    let side = |p: DVec2| axis.perp_dot(p - middle);
    let crossing = line.windows(2).find(|pair| side(pair[0]) * side(pair[1]) <= 0.0)?;
    let share = side(crossing[0]) / (side(crossing[0]) - side(crossing[1]));
    let shoulder = crossing[0].lerp(crossing[1], if share.is_finite() { share } else { 0.0 });
    let rho = (shoulder - middle).dot(axis) / axis.length_squared();
    (rho > 0.0 && rho < 1.0).then_some(Conic { p1, p2, p3, rho })
}

/// Ivo 2020, eq. 3.10, corrected: the symmetric parabola through a polyline's middle `I`,
/// `P2 = 2I - M` with `M` the chord's middle.
fn parabola(p1: DVec2, p3: DVec2, middle: DVec2) -> Conic {
    Conic { p1, p2: 2.0 * middle - 0.5 * (p1 + p3), p3, rho: 0.5 }
}

/// Fits a conic to a polyline of at least three points; its ends are the polyline's.
///
/// Starts from [`through_tangents`], else from a parabola. `None` where the ends coincide.
#[must_use]
pub fn fit(line: &[DVec2]) -> Option<Conic> {
    let (&p1, &p3) = (line.first()?, line.last()?);
    let chord = p1.distance(p3);
    if chord == 0.0 || !chord.is_finite() || line.len() < 3 {
        return None;
    }
    let targets = equally_spaced(line, COMPARED);
    let middle = 0.5 * (targets[COMPARED / 2 - 1] + targets[COMPARED / 2]);
    let start = through_tangents(line).unwrap_or_else(|| parabola(p1, p3, middle));
    // The inverse of the map in `Problem::conic`.
    let centred = (2.0 * start.rho - 1.0).clamp(-0.999, 0.999);
    let shape = centred / (1.0 - centred * centred).sqrt();
    let parameters = Parameters::new(0.0, 0.0, shape);
    let problem = Problem { start, chord, targets: &targets, parameters };
    let (solved, report) = LevenbergMarquardt::new()
        .with_ftol(ENOUGH)
        .with_xtol(ENOUGH)
        .with_patience(PATIENCE)
        .minimize(problem);
    let conic = solved.conic(&solved.parameters);
    (report.objective_function.is_finite() && conic.p2.is_finite()).then_some(conic)
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
            let found = fit(&line).expect("a conic");
            let worst = line.iter().map(|&p| nearest(&found, p)).fold(0.0, f64::max);
            assert!(worst < 2e-4, "rho {rho}: {worst}, {found:?}");
        }
    }

    fn nearest(conic: &Conic, p: DVec2) -> f64 {
        conic.points(4000).map(|q| q.distance(p)).fold(f64::MAX, f64::min)
    }
}
