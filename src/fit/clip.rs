//! Clip curves from the outline of a splat's own patch.
//!
//! An outline is walked with the surface on its left; what lies to its right is cut away.
//! A smooth run from border to border is one chord or conic, a corner of two straight arms
//! one curve with `rho = 1` (Ivo 2020, 3.2 to 3.3). Where one curve does not do, the run is
//! split at its convex corners: their arms go on straight to the border and become curves of
//! their own, whose cuts unite to the corner.

use glam::DVec2;

use super::conic;
use super::ellipse::{Run, angle, exit, holds, runs};
use super::offset::outward;
use crate::model::clip_curve::{ClipCurve, Conic, turn};

/// How near a clip curve must follow its line, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipTolerance {
    /// Curves follow the outline moved outward by this much.
    pub outset: f64,
    /// How far a curve may miss that; no more than `outset`, or it could cut the surface.
    pub miss: f64,
    /// How far outside its line a curve must lie at least.
    pub least: f64,
    /// How far from its line, in space, a curve of a splat that is done may lie.
    pub edge: f64,
    /// Which curves may be used.
    pub clips: Clips,
}

impl ClipTolerance {
    /// How far outside its line a curve may lie before it is rounded, with one miss to spare: where the
    /// surface is looked for just inside a curve, none need be.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.outset + 2.0 * self.miss
    }

    /// A share of all of it.
    #[must_use]
    pub fn scaled(&self, share: f64) -> Self {
        let &Self { outset, miss, least, edge, clips } = self;
        Self { outset: share * outset, miss: share * miss, least: share * least, edge: share * edge, clips }
    }
}

/// Which clip curves a splat may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clips {
    /// Chords, conics, and corners of straight arms.
    #[default]
    Curved,
    /// Chords alone, for comparison: where none follows the line, the splat must be smaller.
    Straight,
    /// None along feature lines, for comparison: there splats are cut by their partners across
    /// the line ([`crate::model::partner`]). They are as large as conics would let them be, and
    /// conics still cut them where the surface ends, since nothing lies across.
    Partners,
}

/// How much to do for a clip curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Care {
    /// Enough to know that there is one within the tolerance.
    Feasible,
    /// The nearest one.
    Nearest,
}

/// Control points farther out than this many radii are refused: the file's grid ends there.
const FARTHEST_CONTROL: f64 = 16.0;

/// A polyline that turns by more than this at a vertex (sine of 15°) may have a corner there.
const CORNER_SINE: f64 = 0.26;

/// Where there are only chords, every left turn that one of them cannot follow is a corner.
const STRAIGHT_CORNER_SINE: f64 = 0.0;

/// Fits clip curves to one outline, in the splat's `(u, v)`; `None` where they cannot follow it.
#[must_use]
pub fn fit(
    line: &[DVec2],
    closed: bool,
    radii: DVec2,
    tolerance: &ClipTolerance,
    care: Care,
) -> Option<Vec<ClipCurve>> {
    let moved = outward(line, closed, tolerance.outset);
    let mut clips = Vec::new();
    for run in runs(&moved, closed, radii)? {
        clips.extend(cut_run(&run, radii, tolerance, care)?);
    }
    Some(clips)
}

fn cut_run(run: &Run, radii: DVec2, tolerance: &ClipTolerance, care: Care) -> Option<Vec<ClipCurve>> {
    if !run.closed
        && let Some(clip) = one_curve(&run.points, radii, tolerance, care)
    {
        return Some(vec![clip]);
    }
    let sine = match tolerance.clips {
        Clips::Curved | Clips::Partners => CORNER_SINE,
        Clips::Straight => STRAIGHT_CORNER_SINE,
    };
    let arcs = split_at_convex_corners(run, sine)?;
    arcs.iter().map(|arc| one_curve(&extend(arc, radii)?, radii, tolerance, care)).collect()
}

/// The cheapest single curve from the first to the last point, which lie on the border:
/// the chord, a corner of straight arms, a conic.
fn one_curve(line: &[DVec2], radii: DVec2, tolerance: &ClipTolerance, care: Care) -> Option<ClipCurve> {
    let (&p1, &p3) = (line.first()?, line.last()?);
    let (alpha1, alpha3) = (angle(p1), angle(p3));
    let chord = p1.distance(p3);
    if chord == 0.0 || !chord.is_finite() {
        return None;
    }
    if line.iter().all(|&p| turn(p1, p3, p).abs() <= 0.5 * tolerance.miss * chord) {
        return Some(ClipCurve::chord(alpha1, alpha3));
    }
    if tolerance.clips == Clips::Straight {
        return None;
    }
    if let Some(clip) = corner(line, radii, tolerance) {
        return Some(clip);
    }
    // A conic lies on one side of its chord.
    let off = |p: DVec2| turn(p1, p3, p) / chord;
    if line.iter().any(|&p| off(p) > tolerance.miss) && line.iter().any(|&p| off(p) < -tolerance.miss) {
        return None;
    }
    let near = |conic: &Conic| {
        conic.p2.abs().max_element() <= FARTHEST_CONTROL * radii.max_element()
            && passes(conic, line, tolerance.miss)
    };
    let quick = conic::through_tangents(line).filter(near);
    let conic = match (care, quick) {
        (Care::Feasible, Some(quick)) => quick,
        _ => conic::fit(line).filter(near).or(quick)?,
    };
    Some(ClipCurve { alpha1, alpha3, p2: conic.p2, rho: conic.rho })
}

/// Sides of the polyline that stands for a curve while its distance is measured: its
/// sagitta is below 1/8192 of the chord for an arc of 90°.
const SIDES: usize = 64;

/// Whether every vertex of a line lies within `miss` of a curve.
fn passes(conic: &Conic, line: &[DVec2], miss: f64) -> bool {
    let curve: Vec<DVec2> = conic.points(SIDES).collect();
    line.iter().all(|&p| curve.windows(2).any(|side| squared_distance(side[0], side[1], p) <= miss * miss))
}

/// Squared distance from the segment `a b` to a point.
fn squared_distance(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let (along, length) = (b - a, a.distance_squared(b));
    let t = if length > 0.0 { ((p - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance_squared(a + t * along)
}

/// A curve with `rho = 1` through the sharpest corner, if its arms are straight.
fn corner(line: &[DVec2], radii: DVec2, tolerance: &ClipTolerance) -> Option<ClipCurve> {
    let sharpest = (1..line.len().saturating_sub(1)).min_by(|&a, &b| {
        let cosine = |n: usize| {
            (line[n] - line[n - 1]).normalize_or_zero().dot((line[n + 1] - line[n]).normalize_or_zero())
        };
        cosine(a).total_cmp(&cosine(b))
    })?;
    let straight = |arm: &[DVec2]| {
        let (from, to) = (arm[0], arm[arm.len() - 1]);
        arm.iter().all(|&p| turn(from, to, p).abs() <= tolerance.miss * from.distance(to))
    };
    let (p1, p2, p3) = (line[0], line[sharpest], line[line.len() - 1]);
    let inside = (p2 / radii).length_squared() < 1.0;
    (inside && straight(&line[..=sharpest]) && straight(&line[sharpest..])).then(|| ClipCurve {
        alpha1: angle(p1),
        alpha3: angle(p3),
        p2,
        rho: 1.0,
    })
}

/// Cuts a run at the vertices where it turns left by more than `sine`: convex corners of the
/// surface.
///
/// `None` for a loop without any, which no curve from border to border can follow.
fn split_at_convex_corners(run: &Run, sine: f64) -> Option<Vec<Vec<DVec2>>> {
    let (points, count) = (&run.points, run.points.len());
    let is_corner = |n: usize| {
        let before = (points[n] - points[(n + count - 1) % count]).normalize_or_zero();
        let after = (points[(n + 1) % count] - points[n]).normalize_or_zero();
        before.perp_dot(after) > sine || (before.dot(after) < 0.0 && before.perp_dot(after) > 0.0)
    };
    if run.closed {
        let corners: Vec<usize> = (0..count).filter(|&n| is_corner(n)).collect();
        let arc = |k: usize| {
            let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
            let steps = (to + count - from - 1) % count + 1;
            (0..=steps).map(|n| points[(from + n) % count]).collect()
        };
        return (!corners.is_empty()).then(|| (0..corners.len()).map(arc).collect());
    }
    let mut arcs = Vec::new();
    let mut from = 0;
    for n in (1..count.saturating_sub(1)).filter(|&n| is_corner(n)) {
        arcs.push(points[from..=n].to_vec());
        from = n;
    }
    arcs.push(points[from..].to_vec());
    Some(arcs)
}

/// Carries an arc's ends straight on to the border.
fn extend(arc: &[DVec2], radii: DVec2) -> Option<Vec<DVec2>> {
    let inside = |p: DVec2| (p / radii).length_squared() < 1.0;
    let (first, last) = (arc[0], arc[arc.len() - 1]);
    let mut line = Vec::with_capacity(arc.len() + 2);
    if inside(first) {
        line.push(exit(first, first - arc[1], radii)?);
    }
    line.extend_from_slice(arc);
    if inside(last) {
        line.push(exit(last, last - arc[arc.len() - 2], radii)?);
    }
    Some(line)
}

/// Whether clip curves follow an outline: its points are kept, and points a little outside
/// it are cut away.
///
/// Along every side inside the ellipse, the place itself must not be cut and the place moved
/// outward by `outset + miss` must be; within that distance of a corner the second is not
/// asked, since there outward is no single direction.
#[must_use]
pub fn follows(
    line: &[DVec2],
    closed: bool,
    radii: DVec2,
    cuts: impl Fn(DVec2) -> bool,
    tolerance: &ClipTolerance,
) -> bool {
    let count = if closed { line.len() } else { line.len().saturating_sub(1) };
    let reach = tolerance.outset + tolerance.miss;
    let inside = |p: DVec2| (p / radii).length_squared() < 1.0;
    (0..count).all(|n| {
        let (a, b) = (line[n], line[(n + 1) % line.len()]);
        let length = a.distance(b);
        let out = -(b - a).perp().normalize_or_zero();
        let clear = (2.0 * reach / length).min(0.5);
        [clear, 0.5, 1.0 - clear].into_iter().map(|t| a.lerp(b, t)).all(|p| {
            let (inner, outer) = (p + tolerance.least * out, p + reach * out);
            (!inside(inner) || !cuts(inner)) && (!inside(outer) || cuts(outer))
        })
    })
}

/// Fewest and most places looked at along a curve.
const PLACES: (f64, f64) = (16.0, 256.0);

/// Whether clip curves bound nothing but outlines: the other side of [`follows`].
///
/// A place on a curve that no other curve cuts away is a border of what is kept. It must lie
/// along an outline, or the splat would go on beyond its surface.
pub fn bounds_only(
    along: impl Fn(DVec2) -> bool,
    conics: &[Conic],
    radii: DVec2,
    tolerance: &ClipTolerance,
) -> bool {
    let apart = tolerance.reach();
    conics.iter().enumerate().all(|(index, conic)| {
        let length = conic.p1.distance(conic.p2) + conic.p2.distance(conic.p3);
        let length = if conic.rho == 0.0 { conic.p1.distance(conic.p3) } else { length };
        let step = apart.min(length / PLACES.0).max(length / PLACES.1);
        conic.walk(step).into_iter().filter(|&p| holds(p, radii)).all(|p| {
            let cut = conics.iter().enumerate().any(|(other, conic)| other != index && conic.cuts(p));
            cut || along(p)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: ClipTolerance =
        ClipTolerance { outset: 0.002, miss: 0.002, least: 0.0, edge: 0.004, clips: Clips::Curved };
    const STRAIGHT: ClipTolerance = ClipTolerance { clips: Clips::Straight, ..TOLERANCE };

    fn check(line: &[DVec2], closed: bool, radii: DVec2) -> Option<usize> {
        check_within(line, closed, radii, &TOLERANCE)
    }

    fn check_within(line: &[DVec2], closed: bool, radii: DVec2, tolerance: &ClipTolerance) -> Option<usize> {
        let clips = fit(line, closed, radii, tolerance, Care::Nearest)?;
        if tolerance.clips == Clips::Straight {
            assert!(clips.iter().all(ClipCurve::is_straight), "{clips:?}");
        }
        let cuts = |p: DVec2| clips.iter().any(|clip| clip.cuts(p, radii));
        follows(line, closed, radii, cuts, tolerance).then_some(clips.len())
    }

    #[test]
    fn a_curve_that_strays_along_its_arm_or_at_its_end_does_not_follow() {
        let (radii, rho) = (DVec2::ONE, 0.995);
        let conic = Conic { p1: DVec2::NEG_X, p2: DVec2::new(0.0, 0.3), p3: DVec2::X, rho };
        let follows = |along: &dyn Fn(DVec2) -> bool| bounds_only(along, &[conic], radii, &TOLERANCE);
        assert!(follows(&|_| true));
        assert!(!follows(&|p| !(-0.7..-0.69).contains(&p.x)), "in the middle of an arm");
        assert!(!follows(&|p| p.distance(DVec2::NEG_X) > 1e-6), "where it meets the rim");
    }

    fn arc(radius: f64, center: DVec2, from: f64, to: f64) -> Vec<DVec2> {
        (0..=200)
            .map(|n| {
                let (sin, cos) = libm::sincos(from + (to - from) * f64::from(n) / 200.0);
                center + radius * DVec2::new(cos, sin)
            })
            .collect()
    }

    #[test]
    fn straight_curved_and_cornered_outlines_are_followed() {
        let points = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| DVec2::new(x, y)).collect::<Vec<_>>();
        let radii = DVec2::new(1.0, 0.6);
        assert_eq!(check(&points(&[(-2.0, 0.1), (0.0, 0.12), (2.0, 0.14)]), false, radii), Some(1));
        assert_eq!(
            check(&points(&[(-2.0, 0.0), (0.1, -0.2), (0.3, 2.0)]), false, radii),
            Some(1),
            "convex corner"
        );
        assert_eq!(
            check(&points(&[(0.3, 2.0), (0.1, -0.2), (-2.0, 0.0)]), false, radii),
            Some(1),
            "concave corner"
        );
        let square = points(&[(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)]);
        assert_eq!(check(&square, true, radii), Some(4), "a whole square face");
    }

    #[test]
    fn circles_are_followed_from_both_sides() {
        let center = DVec2::new(0.2, 1.4);
        let inner = arc(1.2, center, -2.6, -0.5);
        assert_eq!(check(&inner, false, DVec2::ONE), Some(1), "kept inside");
        let outer: Vec<DVec2> = inner.into_iter().rev().collect();
        assert_eq!(check(&outer, false, DVec2::ONE), Some(1), "kept outside");
    }

    #[test]
    fn chords_follow_what_is_convex_and_straight_and_nothing_else() {
        let points = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| DVec2::new(x, y)).collect::<Vec<_>>();
        let chords = |line: &[DVec2], closed| check_within(line, closed, DVec2::new(1.0, 0.6), &STRAIGHT);
        assert_eq!(chords(&points(&[(-2.0, 0.1), (0.0, 0.12), (2.0, 0.14)]), false), Some(1));
        let convex = points(&[(-2.0, 0.0), (0.1, -0.2), (0.3, 2.0)]);
        assert_eq!(chords(&convex, false), Some(2), "their cuts unite to the corner");
        let concave: Vec<DVec2> = convex.into_iter().rev().collect();
        assert_eq!(chords(&concave, false), None, "no union of half planes is a concave corner");
        assert_eq!(
            chords(&points(&[(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)]), true),
            Some(4),
            "a whole square face"
        );
        let blunt = points(&[(-0.6, 0.0), (0.6, 0.0), (0.0, 0.05)]);
        assert_eq!(chords(&blunt, true), Some(5), "moved outward, its two sharp tips end in a side each");
        let hole: Vec<DVec2> = arc(1.2, DVec2::new(0.2, 1.4), -2.6, -0.5).into_iter().rev().collect();
        assert_eq!(chords(&hole, false), None, "the outside of a circle");
    }

    #[test]
    fn what_one_conic_cannot_say_is_refused() {
        let wave: Vec<DVec2> = (0..=200)
            .map(|n| {
                let x = f64::from(n) * 0.02 - 2.0;
                DVec2::new(x, 0.3 * libm::sin(5.0 * x))
            })
            .collect();
        assert_eq!(check(&wave, false, DVec2::ONE), None, "inflections");
        assert_eq!(
            check(&arc(0.3, DVec2::ZERO, 0.0, 6.25), true, DVec2::ONE),
            None,
            "a loop without corners"
        );
    }
}
