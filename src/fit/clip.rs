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
use super::offset::{CORNER_SINE, is_corner, outward};
use crate::model::clip_curve::{ClipCurve, Conic, turn};

/// How near a clip curve must follow its line, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipTolerance {
    /// Curves follow the outline moved outward by this much, or by less at acute corners.
    pub outset: f64,
    /// How far a curve may miss that; no more than `outset`, or it could cut the surface.
    pub miss: f64,
    /// How far outside its line a curve must lie at least.
    pub least: f64,
    /// How far from its line, in space, a curve of a splat that is done may lie.
    pub edge: f64,
    /// How far rounding may still move a curve.
    pub rounding: f64,
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

    /// By how much the sides of a corner may be moved whose mitre is so many times as long as
    /// that: rounded, its tip must not lie beyond where a rounded curve may. `None` where they would come
    /// as near to the outline as curves that miss may.
    #[must_use]
    pub fn beside_corner(&self, miter: f64) -> Option<f64> {
        let by = ((self.edge + self.rounding) / miter - self.rounding).min(self.outset);
        (by > self.outset - self.miss).then_some(by)
    }

    /// A share of all of it but for the rounding, which stays: curves still lie so far outside that none
    /// cuts the surface once it is rounded.
    #[must_use]
    pub fn scaled(&self, share: f64) -> Self {
        let &Self { outset, miss, least, edge, rounding, clips } = self;
        let miss = share * miss;
        let outset = (share * outset).max(miss + rounding);
        Self { outset, miss, least: share * least, edge: (share * edge).max(outset + miss), rounding, clips }
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

/// Control points farther out than this many radii are refused: the file's grid ends there.
const FARTHEST_CONTROL: f64 = 16.0;

/// Where there are only chords, every left turn that one of them cannot follow is a corner.
const STRAIGHT_CORNER_SINE: f64 = 0.0;

/// Fits clip curves to one outline, in the splat's `(u, v)`; `None` where they cannot follow it.
#[must_use]
pub fn fit(line: &[DVec2], closed: bool, radii: DVec2, tolerance: &ClipTolerance) -> Option<Vec<ClipCurve>> {
    let moved = outward(line, closed, tolerance.outset, |miter| tolerance.beside_corner(miter));
    let mut clips = Vec::new();
    for run in runs(&moved, closed, radii)? {
        clips.extend(cut_run(&run, radii, tolerance)?);
    }
    Some(clips)
}

/// As [`fit`], of the straight line through two places, from outside the ellipse to outside: the chord along it, or
/// nothing where it passes the ellipse by.
#[must_use]
pub fn along([a, b]: [DVec2; 2], radii: DVec2, tolerance: &ClipTolerance) -> Option<Vec<ClipCurve>> {
    let beyond = 2.0 * radii.max_element() * (b - a).normalize_or_zero();
    fit(&[a - beyond, b + beyond], false, radii, tolerance)
}

fn cut_run(run: &Run, radii: DVec2, tolerance: &ClipTolerance) -> Option<Vec<ClipCurve>> {
    if !run.closed
        && let Some(clip) = one_curve(&run.points, radii, tolerance)
    {
        return Some(vec![clip]);
    }
    let sine = match tolerance.clips {
        Clips::Curved | Clips::Partners => CORNER_SINE,
        Clips::Straight => STRAIGHT_CORNER_SINE,
    };
    let arcs = split_at_convex_corners(run, sine)?;
    arcs.iter().map(|arc| one_curve(&extend(arc, radii)?, radii, tolerance)).collect()
}

/// The cheapest single curve from the first to the last point, which lie on the border:
/// the chord, a corner of straight arms, a conic.
fn one_curve(line: &[DVec2], radii: DVec2, tolerance: &ClipTolerance) -> Option<ClipCurve> {
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
    let conic = conic::fit(line, tolerance.miss, near)?;
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
        is_corner(before, after, sine)
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
/// asked, since there outward is no single direction. No end of a side may be cut once the curves are
/// rounded.
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
        let is_kept = |p: DVec2| !inside(p) || !cuts(p + tolerance.rounding * out);
        let ends = is_kept(a) && is_kept(b);
        ends && [clear, 0.5, 1.0 - clear].into_iter().map(|t| a.lerp(b, t)).all(|p| {
            let (inner, outer) = (p + tolerance.least * out, p + reach * out);
            (!inside(inner) || !cuts(inner)) && (!inside(outer) || cuts(outer))
        })
    })
}

/// Fewest and most places looked at along a curve on a quick look.
const PLACES: (f64, f64) = (16.0, 256.0);

/// Halvings of a step between two such places that find where the border leaves the curve: to a
/// thousandth of a step, which is at most a few bounds long.
const HALVINGS: usize = 10;

/// Places along the border that clip curves give a splat, where no other curve cuts, `finer` times as many as
/// on a quick look; ends and tips are among them.
///
/// Each must lie along an outline, or the splat would go on beyond its surface: the other side of
/// [`follows`]. So must the tip where the border goes over to another curve: at an acute corner it lies
/// farther out than all else.
pub fn border(
    conics: &[Conic],
    radii: DVec2,
    tolerance: &ClipTolerance,
    finer: f64,
) -> impl Iterator<Item = DVec2> {
    let apart = tolerance.reach();
    conics.iter().enumerate().flat_map(move |(index, conic)| {
        let length = conic.p1.distance(conic.p2) + conic.p2.distance(conic.p3);
        let length = if conic.rho == 0.0 { conic.p1.distance(conic.p3) } else { length };
        let step = apart.min(length / PLACES.0).max(length / PLACES.1) / finer;
        let bounds = move |p: DVec2| {
            holds(p, radii)
                && !conics.iter().enumerate().any(|(other, conic)| other != index && conic.cuts(p))
        };
        let places: Vec<(DVec2, bool)> = conic.walk(step).into_iter().map(|p| (p, bounds(p))).collect();
        let tips: Vec<DVec2> = places
            .windows(2)
            .filter_map(|ends| match ends {
                &[(kept, true), (cut, false)] | &[(cut, false), (kept, true)] => Some(tip(kept, cut, bounds)),
                _ => None,
            })
            .collect();
        places.into_iter().filter(|(_, bounds)| *bounds).map(|(p, _)| p).chain(tips)
    })
}

/// The last place on the way from one to another that is a border.
fn tip(mut kept: DVec2, mut cut: DVec2, bounds: impl Fn(DVec2) -> bool) -> DVec2 {
    for _ in 0..HALVINGS {
        let middle = kept.midpoint(cut);
        if bounds(middle) {
            kept = middle;
        } else {
            cut = middle;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: ClipTolerance = ClipTolerance {
        outset: 0.002,
        miss: 0.0012,
        least: 0.0,
        edge: 0.0036,
        rounding: 0.0004,
        clips: Clips::Curved,
    };
    const STRAIGHT: ClipTolerance = ClipTolerance { clips: Clips::Straight, ..TOLERANCE };

    fn check(line: &[DVec2], closed: bool, radii: DVec2) -> Option<usize> {
        check_within(line, closed, radii, &TOLERANCE)
    }

    fn check_within(line: &[DVec2], closed: bool, radii: DVec2, tolerance: &ClipTolerance) -> Option<usize> {
        let clips = fit(line, closed, radii, tolerance)?;
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
        let follows = |along: &dyn Fn(DVec2) -> bool| border(&[conic], radii, &TOLERANCE, 1.0).all(along);
        assert!(follows(&|_| true));
        assert!(!follows(&|p| !(-0.7..-0.69).contains(&p.x)), "in the middle of an arm");
        assert!(!follows(&|p| p.distance(DVec2::NEG_X) > 1e-6), "where it meets the rim");
    }

    #[test]
    fn a_tip_that_strays_between_the_places_of_a_walk_does_not_follow() {
        // Two chords that meet at a corner of 53°, three misses beyond it.
        let tip = DVec2::new(0.6 + 3.0 * TOLERANCE.miss, 0.0);
        let chord = |from: DVec2, to: DVec2| Conic { p1: from, p2: from, p3: to, rho: 0.0 };
        let out = |slope: f64| exit(tip, DVec2::new(1.0, slope), DVec2::ONE).unwrap_or(tip);
        let back = |slope: f64| exit(tip, DVec2::new(-1.0, slope), DVec2::ONE).unwrap_or(tip);
        let conics = [chord(back(-0.5), out(0.5)), chord(out(-0.5), back(0.5))];
        let within = |far: f64| border(&conics, DVec2::ONE, &TOLERANCE, 1.0).all(|p| p.x <= 0.6 + far);
        assert!(within(3.01 * TOLERANCE.miss));
        assert!(!within(2.99 * TOLERANCE.miss));
    }

    /// How far what is kept of a kite whose acute corner is at the middle lies from that corner, where
    /// that is farther out than the corner, and by how many curves it is cut.
    fn tip_of_kite(degrees: f64) -> (f64, usize) {
        let (sin, cos) = libm::sincos(0.5 * degrees.to_radians());
        let kite = [DVec2::ZERO, DVec2::new(cos, -sin), DVec2::new(cos + sin, 0.0), DVec2::new(cos, sin)];
        let radii = DVec2::splat(2.0);
        let clips = fit(&kite, true, radii, &TOLERANCE).unwrap_or_default();
        let cuts = |p: DVec2| clips.iter().any(|clip| clip.cuts(p, radii));
        assert!(follows(&kite, true, radii, cuts, &TOLERANCE), "{degrees}°");
        let step = 0.01 * TOLERANCE.outset;
        let places = (0..1000).map(|n| f64::from(n) * step).take_while(|x| !cuts(DVec2::new(-x, 0.0)));
        (places.last().unwrap_or(f64::NAN), clips.len())
    }

    #[test]
    fn the_tip_of_no_corner_lies_beyond_what_edges_may() {
        for degrees in [20.0, 30.0, 36.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 72.0, 80.0, 90.0] {
            let (tip, clips) = tip_of_kite(degrees);
            assert!(tip > 0.0 && tip <= TOLERANCE.edge, "{degrees}°: {tip}");
            assert_eq!(clips, if degrees < 35.0 { 5 } else { 4 }, "{degrees}°");
        }
    }

    #[test]
    fn the_border_reaches_into_notches() {
        let radii = DVec2::splat(2.0);
        for degrees in [36.0, 40.0, 45.0, 50.0, 55.0, 60.0, 70.0, 90.0, 120.0] {
            // Around the notch, which is open to the right.
            let (sin, cos) = libm::sincos(0.5 * f64::to_radians(degrees));
            let notch = [3.0 * DVec2::new(cos, -sin), DVec2::ZERO, 3.0 * DVec2::new(cos, sin)];
            let clips = fit(&notch, false, radii, &TOLERANCE).unwrap_or_default();
            let cuts = |p: DVec2| clips.iter().any(|clip| clip.cuts(p, radii));
            assert!(clips.len() == 1 && follows(&notch, false, radii, cuts, &TOLERANCE), "{degrees}°");
            let kept = (0..1000).map(|n| 0.01 * TOLERANCE.outset * f64::from(n));
            let kept = kept.take_while(|x| !cuts(DVec2::new(*x, 0.0))).last().unwrap_or(f64::NAN);
            assert!(kept > 0.0 && kept <= TOLERANCE.edge, "{degrees}°: {kept}");
        }
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
