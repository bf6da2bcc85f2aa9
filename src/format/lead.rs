//! What the clip curves already decoded say about the next one.
//!
//! Along a feature line the splats of both its sides are cut by one line, and those side by side by the same
//! one: a curve carried over from a splat to another is often all that the other's curve needs to be. It is
//! carried in space: a rational curve is projected by its control points, onto whatever plane.
//!
//! A guess must come out the same in every decoder, so only `+ - * /`, square roots and comparisons of
//! 64-bit floats are used, in the order written.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::grid::{CONTROL_LIMIT, Grids, Size, rho_steps};
use super::homogeneous::Homogeneous;
use super::record::{ClipRecord, chord_frame};
use super::turns;
use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;

/// What a clip curve may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A chord, `rho = 0`.
    Straight,
    /// `0 < rho < 1`.
    Curved,
    /// The two arms of a corner, `rho = 1`.
    Corner,
}

impl Form {
    /// That of a record.
    #[must_use]
    pub fn of(clip: &ClipRecord) -> Self {
        match clip.rho {
            0 => Self::Straight,
            rho if rho == rho_steps(clip.control) => Self::Corner,
            _ => Self::Curved,
        }
    }
}

/// What a clip curve is guessed to be, on the finest grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guess {
    /// Border step of `P1`.
    pub start: u64,
    /// Border step of `P3`.
    pub end: u64,
    /// `P2`, as a record has it.
    pub control: [i64; 2],
    /// The shape.
    pub rho: f64,
}

/// A clip curve in space.
#[derive(Clone, Copy, Debug)]
pub struct Lead {
    /// The curve.
    own: [DVec3; 3],
    /// The line that it lies outside of, as far as that can be told.
    line: Option<[DVec3; 3]>,
    rho: f64,
}

/// Where a curve that goes on is looked for: by its parameter, which is 0 to 1 on the curve itself.
const SPAN: (f64, f64) = (-1.0, 2.0);

/// Steps of the parameter over that span.
const STEPS: u32 = 24;

/// Halvings of such a step where the border is crossed: far below a step of the border's.
const HALVINGS: u32 = 24;

/// A curve lies so many budgets outside of its line, in its splat's plane.
const OUTSET: f64 = 0.5;

/// A corner of the control polygon that turns back so far, measured by `1 + cos` of the angle, is not moved
/// to the side: its mitre would be longer than six times that move.
const SHARPEST: f64 = 0.05;

impl Lead {
    /// A clip curve of a splat, as it lies on its quadric.
    ///
    /// Over a chord the quadric is a parabola. Over a conic its height is not that of one; the ends and
    /// their tangents are kept as far as they meet.
    #[must_use]
    pub fn of(splat: &Splat, conic: &Conic, budget: f64) -> Self {
        let arms = [conic.p1, conic.p2, conic.p3];
        let line = moved_right(arms, -(OUTSET * budget));
        let rho = if conic.rho == 0.0 { 0.5 } else { conic.rho };
        Self { own: lifted(splat, arms), line: line.map(|arms| lifted(splat, arms)), rho }
    }

    /// The squared distance of a place from the curve's chord.
    #[must_use]
    pub fn distance_squared(&self, place: DVec3) -> f64 {
        let [from, _, to] = self.own;
        let (chord, off) = (to - from, place - from);
        let (length, along) = (dot(chord, chord), dot(off, chord));
        let share = if along > 0.0 && length > 0.0 { (along / length).min(1.0) } else { 0.0 };
        let d = off - share * chord;
        dot(d, d)
    }

    /// What a clip curve of a splat, whose own clip curves do not matter, would be if it were this one, in
    /// the splat's plane; `across` if it is one of the other side of the line, which runs the other way.
    /// `None` where that does not cross the splat from border to border. Its ends may lie off the border by
    /// rounding.
    pub fn crossing(&self, splat: &Splat, form: Form, across: bool, budget: f64) -> Option<Conic> {
        let local = |place: DVec3| {
            let d = place - splat.center;
            DVec2::new(dot(d, splat.axes.x_axis), dot(d, splat.axes.y_axis))
        };
        let [p1, p2, p3] = if across {
            let [p3, p2, p1] = chord_for(form, self.line?.map(local));
            moved_right([p1, p2, p3], OUTSET * budget)?
        } else {
            chord_for(form, self.own.map(local))
        };
        match (form, self.rho < 1.0) {
            (Form::Straight, _) => {
                let (enter, leave) = crossings(p1, p3, splat.radii)?;
                let (p1, p3) = (p1 + enter * (p3 - p1), p1 + leave * (p3 - p1));
                Some(Conic { p1, p2: 0.5 * (p1 + p3), p3, rho: 0.0 })
            }
            (Form::Corner, false) => {
                let (_, one) = crossings(p2, p1, splat.radii).filter(|(enter, _)| *enter < 0.0)?;
                let (_, three) = crossings(p2, p3, splat.radii).filter(|(enter, _)| *enter < 0.0)?;
                let (p1, p3) = (p2 + one * (p1 - p2), p2 + three * (p3 - p2));
                Some(Conic { p1, p2, p3, rho: 1.0 })
            }
            (Form::Curved, true) => {
                let curve = Homogeneous::new(&Conic { p1, p2, p3, rho: self.rho });
                let (from, to) = span_inside(&curve, splat.radii)?;
                curve.span(from, to)
            }
            (Form::Corner, true) | (Form::Curved, false) => None,
        }
    }
}

fn dot(a: DVec3, b: DVec3) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// A curve as the nearest on the finest grid, or next to that; `None` where it is out of range.
#[must_use]
pub fn guess(conic: &Conic, sizes: [Size; 2], grids: &Grids) -> Option<Guess> {
    let [along, across] = chord_frame(conic.p1, conic.p3);
    let (arm, step) = (conic.p2 - 0.5 * (conic.p1 + conic.p3), grids.clip());
    let steps = |axis: DVec2| ((arm.x * axis.x + arm.y * axis.y) / step + 0.5).floor();
    let control = [steps(along), steps(across)];
    // Phrased so that what is not finite is no guess.
    let holds = control.iter().all(|steps| steps.abs() <= CONTROL_LIMIT as f64) && conic.rho <= 1.0;
    holds.then(|| Guess {
        start: border_step(conic.p1, sizes, grids),
        end: border_step(conic.p3, sizes, grids),
        control: control.map(|steps| steps as i64),
        rho: conic.rho,
    })
}

/// A control polygon in a splat's plane, lifted to its quadric.
fn lifted(splat: &Splat, [p1, p2, p3]: [DVec2; 3]) -> [DVec3; 3] {
    let (a, b) = (splat.curvature.x, splat.curvature.y);
    let height = |p: DVec2| a * p.x * p.x + b * p.y * p.y;
    let tangent = |p: DVec2| height(p) + 2.0 * a * p.x * (p2.x - p.x) + 2.0 * b * p.y * (p2.y - p.y);
    let lift = |p: DVec2, w: f64| {
        splat.center + p.x * splat.axes.x_axis + p.y * splat.axes.y_axis + w * splat.axes.z_axis
    };
    [lift(p1, height(p1)), lift(p2, 0.5 * (tangent(p1) + tangent(p3))), lift(p3, height(p3))]
}

/// What of a control polygon counts for a curve of a form.
fn chord_for(form: Form, [p1, p2, p3]: [DVec2; 3]) -> [DVec2; 3] {
    if form == Form::Straight { [p1, 0.5 * (p1 + p3), p3] } else { [p1, p2, p3] }
}

/// A control polygon moved to its right, corner mitred.
fn moved_right([p1, p2, p3]: [DVec2; 3], by: f64) -> Option<[DVec2; 3]> {
    let right = |from: DVec2, to: DVec2| {
        let d = to - from;
        let length = (d.x * d.x + d.y * d.y).sqrt();
        (length > 0.0).then(|| DVec2::new(d.y / length, -(d.x / length)))
    };
    let (one, three) = (right(p1, p2)?, right(p2, p3)?);
    let share = 1.0 + (one.x * three.x + one.y * three.y);
    let mitre = by / share;
    (share > SHARPEST).then(|| [p1 + by * one, p2 + mitre * (one + three), p3 + by * three])
}

/// The parameters, ascending, at which a line from `a`, at 0, to `b`, at 1, crosses an ellipse's border.
fn crossings(a: DVec2, b: DVec2, radii: DVec2) -> Option<(f64, f64)> {
    let (p, d) = (a / radii, (b - a) / radii);
    let (square, half, rest) = (d.x * d.x + d.y * d.y, p.x * d.x + p.y * d.y, p.x * p.x + p.y * p.y - 1.0);
    let root = half * half - square * rest;
    if root > 0.0 && square > 0.0 {
        let root = root.sqrt();
        Some(((-half - root) / square, (-half + root) / square))
    } else {
        None
    }
}

/// The parameters between which a curve lies inside an ellipse, around its place farthest inside.
fn span_inside(curve: &Homogeneous, radii: DVec2) -> Option<(f64, f64)> {
    let at = |n: u32| SPAN.0 + (SPAN.1 - SPAN.0) * f64::from(n) / f64::from(STEPS);
    let reach: Vec<f64> = (0..=STEPS).map(|n| curve.reach(at(n), radii)).collect();
    let mut inmost = 0;
    for n in 1..=STEPS {
        if reach[n as usize] < reach[inmost as usize] {
            inmost = n;
        }
    }
    let outside = |n: &u32| reach[*n as usize] > 1.0;
    if outside(&inmost) {
        return None;
    }
    let before = (0..inmost).rev().find(outside)?;
    let after = (inmost + 1..=STEPS).find(outside)?;
    Some((
        border_between(curve, at(before + 1), at(before), radii),
        border_between(curve, at(after - 1), at(after), radii),
    ))
}

/// The parameter at which a curve crosses a border on the way out.
fn border_between(curve: &Homogeneous, mut inside: f64, mut outside: f64, radii: DVec2) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if curve.reach(middle, radii) > 1.0 {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    inside
}

/// The step of the border nearest to the direction of a point.
fn border_step(point: DVec2, sizes: [Size; 2], grids: &Grids) -> u64 {
    let (count, radii) = (grids.border_steps(sizes[0]), grids.radii(sizes));
    let (x, y) = (point.x / radii.x, point.y / radii.y);
    let (x, y, first) = if y < 0.0 { (-x, -y, count / 2) } else { (x, y, 0) };
    let is_passed = |number: u64, count: u64| {
        let (sin, cos) = turns::sin_cos(number, count);
        cos * y - sin * x >= 0.0
    };
    // The last step whose direction is not beyond (x, y), by halving what an estimate leaves; how good that is does not
    // matter for what is found.
    let half = count / 2;
    let near = (libm::atan2(y, x) / PI * half as f64) as u64;
    let (mut low, mut high) = (near.saturating_sub(1).min(half), (near + 2).min(half));
    if low > 0 && !is_passed(low, count) {
        low = 0;
    }
    if high < half && is_passed(high, count) {
        high = half;
    }
    while high > low + 1 {
        let middle = (low + high) / 2;
        if is_passed(middle, count) {
            low = middle;
        } else {
            high = middle;
        }
    }
    (first + low + u64::from(is_passed(2 * low + 1, 2 * count))) % count
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::format::grid::STEPS;
    use glam::DMat3;

    const BUDGET: f64 = 1e-3;

    fn disc(center: DVec3, k: DVec3, radii: DVec2) -> Splat {
        let i = k.any_orthonormal_vector();
        let axes = DMat3::from_cols(i, k.cross(i), k);
        let (curvature, clips, partners) = (DVec2::ZERO, Vec::new(), Vec::new());
        Splat { center, axes, radii, curvature, clips, partners, color: [255; 3] }
    }

    /// The chord along a line in space, `outset` to its right as the splat sees it.
    fn cut(splat: &Splat, [from, to]: [DVec3; 2], outset: f64) -> Conic {
        let [a, b] = [from, to].map(|place| splat.to_local(place).truncate());
        let [a, _, b] = moved_right([a, 0.5 * (a + b), b], outset).unwrap();
        let (enter, leave) = crossings(a, b, splat.radii).unwrap();
        let (p1, p3) = (a + enter * (b - a), a + leave * (b - a));
        Conic { p1, p2: 0.5 * (p1 + p3), p3, rho: 0.0 }
    }

    #[test]
    fn the_cut_of_one_side_of_an_edge_tells_that_of_the_other() {
        // Two sides of a roof along the x axis, at whatever angle.
        for angle in [0.3, 1.0, 1.57, 2.5] {
            let (sin, cos) = libm::sincos(angle);
            let down = DVec3::new(0.0, -cos, -sin);
            let left = disc(DVec3::new(0.1, 0.03, 0.0), DVec3::Z, DVec2::new(0.09, 0.07));
            let right = disc(0.02 * down, DVec3::X.cross(-down), DVec2::new(0.05, 0.06));
            let line = [DVec3::ZERO, DVec3::X];
            let turned = [DVec3::X, DVec3::ZERO];
            let lead = Lead::of(&left, &cut(&left, line, 0.5 * BUDGET), BUDGET);
            let found = lead.crossing(&right, Form::Straight, true, BUDGET).unwrap();
            let wanted = cut(&right, turned, 0.5 * BUDGET);
            assert!(found.p1.distance(wanted.p1) < 1e-12 && found.p3.distance(wanted.p3) < 1e-12, "{angle}");
            assert!(!found.cuts(DVec2::ZERO), "the side that it keeps");
            let along = lead.crossing(&right, Form::Straight, false, BUDGET).unwrap();
            assert!(along.cuts(DVec2::ZERO), "as if both were of one side");
        }
    }

    #[test]
    fn an_arc_goes_on_from_splat_to_splat() {
        // A quarter of the unit circle and a bit, in two splats that lie side by side.
        let at = |angle: f64| DVec2::from_angle(angle);
        let middle = |angle: f64| at(angle).extend(0.0);
        let half = 0.3;
        let w = libm::cos(half);
        let arc = |splat: &Splat, angle: f64| {
            let local = |p: DVec2| splat.to_local(p.extend(0.0)).truncate();
            let [p1, p3] = [angle - half, angle + half].map(|angle| local(at(angle)));
            Conic { p1, p2: local(at(angle) / w), p3, rho: w / (1.0 + w) }
        };
        let radius = 2.0 * libm::sin(0.5 * half);
        let [one, other] = [0.0, 0.4].map(|angle| disc(middle(angle), DVec3::Z, DVec2::splat(radius)));
        let lead = Lead::of(&one, &arc(&one, 0.0), BUDGET);
        let found = lead.crossing(&other, Form::Curved, false, BUDGET).unwrap();
        let (wanted, grids) = (arc(&other, 0.4), Grids { budget: BUDGET, steps: STEPS, guesses: 0 });
        for (p, q) in [(found.p1, wanted.p1), (found.p2, wanted.p2), (found.p3, wanted.p3)] {
            assert!(p.distance(q) < 0.1 * grids.clip(), "{p} for {q}");
        }
        assert!((found.rho - wanted.rho).abs() < 1e-6);
        assert!(lead.crossing(&other, Form::Corner, false, BUDGET).is_none(), "an arc is no corner");
        let far = disc(middle(3.0), DVec3::Z, DVec2::splat(radius));
        assert!(lead.crossing(&far, Form::Curved, false, BUDGET).is_none(), "it does not go on so far");
    }
}
