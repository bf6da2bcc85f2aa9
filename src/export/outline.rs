//! The border of a splat's domain as chains of chords.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;

/// Fewest chords of an ellipse: fewer would not look like one at any tolerance.
const LEAST_CHORDS: usize = 12;

/// Most chords of an ellipse, whatever the tolerance: 2^16 of them stray by less than
/// `1.2e-9` of the radius, which is finer than any asset's grids.
const MOST_CHORDS: f64 = 65_536.0;

/// Halvings of a clip curve, at most. Each quarters the deviation, so 16 of them leave
/// `2^-32` of the curve's height.
const DEPTH: u32 = 16;

/// How far chords and triangles may stray from what they stand for, in model units.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Sideways: from the border or clip curve, in the `(u, v)` plane.
    pub chord: f64,
    /// Upwards: greatest `|a du² + b dv²|` of an edge `(du, dv)`.
    ///
    /// Over an edge the quadric leaves the straight line by a quarter of this, and over a
    /// triangle whose three edges keep it by a third: `w` less its linear interpolation is
    /// `-Σ λi λj h(edge ij)` in barycentric coordinates, and `Σ λi λj <= 1/3`.
    pub bend: f64,
}

impl Tolerance {
    /// From the greatest distance that a triangle may have from the surface.
    #[must_use]
    pub fn of_distance(distance: f64) -> Self {
        Self { chord: distance, bend: 3.0 * distance }
    }
}

/// Greatest part of the bend that an edge of the border uses. Less than 1, so that an edge
/// inside that is split never meets a border edge that is just as long.
const BORDER_PART: f64 = 0.5;

/// Border vertices nearer to the end of a clip curve than this share of a chord are left out.
/// The chord that grows by it stays within the tolerance, as [`BORDER_CHORD_PART`] is below
/// `1 / (1 + 2 END_SHARE)²`.
const END_SHARE: f64 = 0.05;

/// Part of the tolerance that the border's chords use; see [`END_SHARE`].
const BORDER_CHORD_PART: f64 = 0.8;

/// The second difference of the quadric along an edge, `|a du² + b dv²|`.
#[must_use]
pub fn bend(splat: &Splat, edge: DVec2) -> f64 {
    splat.height(edge).abs()
}

/// The ellipse's border, counter-clockwise, each point once, with the ends of the clip curves
/// among them so that border and curve share a vertex.
#[must_use]
pub fn ellipse(splat: &Splat, conics: &[Conic], tolerance: Tolerance) -> Vec<DVec2> {
    let chords = chord_count(splat, tolerance);
    let step = TAU / chords as f64;
    let mut ends: Vec<(f64, DVec2)> =
        conics.iter().flat_map(|c| [c.p1, c.p3]).map(|p| (eccentric_angle(p, splat.radii), p)).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A vertex right beside the end of a curve would only make a needle of a triangle.
    let free = |angle: f64| ends.iter().all(|(end, _)| (angle - end).abs() > END_SHARE * step);
    let between = (0..chords).map(|n| n as f64 * step).filter(|&angle| free(angle));
    let mut border: Vec<(f64, DVec2)> = between.map(|angle| (angle, on_border(angle, splat.radii))).collect();
    border.extend(&ends);
    border.sort_by(|a, b| a.0.total_cmp(&b.0));
    border.into_iter().map(|(_, point)| point).collect()
}

fn on_border(angle: f64, radii: DVec2) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    radii * DVec2::new(cos, sin)
}

fn eccentric_angle(point: DVec2, radii: DVec2) -> f64 {
    let unit = point / radii;
    let angle = libm::atan2(unit.y, unit.x);
    if angle < 0.0 { angle + TAU } else { angle }
}

/// Chords of the ellipse, equally spaced in its eccentric angle.
fn chord_count(splat: &Splat, tolerance: Tolerance) -> usize {
    // A chord over the angle d leaves a circle of radius r by r (1 - cos(d/2)) <= r d²/8, and
    // its bend is at most the greater sagitta times d².
    let flat = libm::sqrt(8.0 * BORDER_CHORD_PART * tolerance.chord / splat.radii.max_element());
    let sagitta = (splat.curvature * splat.radii * splat.radii).abs().max_element();
    let bent = libm::sqrt(BORDER_PART * tolerance.bend / sagitta);
    let chords = (TAU / flat.min(bent)).ceil();
    if chords < MOST_CHORDS { (chords as usize).max(LEAST_CHORDS) } else { MOST_CHORDS as usize }
}

/// A clip curve from `P1` to `P3`, both ends included.
#[must_use]
pub fn clip_curve(splat: &Splat, conic: &Conic, tolerance: Tolerance) -> Vec<DVec2> {
    let mut points = vec![conic.p1];
    let walker = Walker { splat, tolerance };
    if conic.rho < 1.0 {
        walker.walk(conic, DEPTH, &mut points);
    } else {
        // At rho = 1 the curve is its control polygon.
        for (p1, p3) in [(conic.p1, conic.p2), (conic.p2, conic.p3)] {
            walker.walk(&Conic { p1, p2: p1, p3, rho: 0.0 }, DEPTH, &mut points);
        }
    }
    points
}

struct Walker<'a> {
    splat: &'a Splat,
    tolerance: Tolerance,
}

impl Walker<'_> {
    /// Adds the points after `p1`.
    fn walk(&self, conic: &Conic, depth: u32, points: &mut Vec<DVec2>) {
        if depth == 0 || self.near_enough(conic) {
            points.push(conic.p3);
            return;
        }
        let (first, second) = halves(conic);
        self.walk(&first, depth - 1, points);
        self.walk(&second, depth - 1, points);
    }

    /// The curve lies in the triangle `P1, P2, P3` and goes no farther from the chord than
    /// its shoulder, `rho` of the way from the chord's middle to `P2`.
    fn near_enough(&self, conic: &Conic) -> bool {
        let middle = conic.p1.midpoint(conic.p3);
        let deviation = conic.rho * conic.p2.distance(middle);
        let bent = bend(self.splat, conic.p3 - conic.p1);
        let close = deviation <= self.tolerance.chord && bent <= BORDER_PART * self.tolerance.bend;
        close || self.outside(conic)
    }

    /// Whether the curve surely stays outside the ellipse's box, where it cuts nothing.
    fn outside(&self, conic: &Conic) -> bool {
        let corners = [conic.p1, if conic.rho > 0.0 { conic.p2 } else { conic.p1 }, conic.p3];
        let max = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        let min = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        min.cmpgt(self.splat.radii).any() || max.cmplt(-self.splat.radii).any()
    }
}

/// The two halves of a conic, cut at its shoulder (Farin, *NURBS*, section 4.4).
///
/// Both have the weight `sqrt((1+w)/2)`, which in `rho = w/(1+w)` is
/// `1 / (1 + sqrt(2 (1-rho)))`.
fn halves(conic: &Conic) -> (Conic, Conic) {
    let Conic { p1, p2, p3, rho } = *conic;
    let shoulder = p1.midpoint(p3).lerp(p2, rho);
    if rho == 0.0 {
        let half = |p1, p3| Conic { p1, p2: p1, p3, rho: 0.0 };
        return (half(p1, shoulder), half(shoulder, p3));
    }
    let half_rho = 1.0 / (1.0 + libm::sqrt(2.0 * (1.0 - rho)));
    let first = Conic { p1, p2: p1.lerp(p2, rho), p3: shoulder, rho: half_rho };
    let second = Conic { p1: shoulder, p2: p3.lerp(p2, rho), p3, rho: half_rho };
    (first, second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};

    fn disc(radii: DVec2, curvature: DVec2) -> Splat {
        Splat {
            center: DVec3::ZERO,
            axes: DMat3::IDENTITY,
            radii,
            curvature,
            clips: vec![],
            partners: Vec::new(),
            color: [255; 3],
        }
    }

    /// Distance from a point to a chain of chords.
    fn distance(point: DVec2, chain: &[DVec2]) -> f64 {
        let to_chord = |pair: &[DVec2]| {
            let along = pair[1] - pair[0];
            let t = (point - pair[0]).dot(along) / along.length_squared();
            point.distance(pair[0] + along * t.clamp(0.0, 1.0))
        };
        chain.windows(2).map(to_chord).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn halving_keeps_the_curve() {
        for rho in [0.05, 0.3, 0.5, 0.8, 0.99] {
            let whole = Conic { p1: DVec2::ZERO, p2: DVec2::new(0.7, 1.3), p3: DVec2::new(2.0, -0.2), rho };
            let (first, second) = halves(&whole);
            // The implicit form of the whole vanishes on both halves.
            for point in first.points(16).chain(second.points(16)) {
                let turn = crate::model::clip_curve::turn;
                let [l1, l2, l3] = [
                    turn(point, whole.p2, whole.p3),
                    turn(whole.p1, point, whole.p3),
                    turn(whole.p1, whole.p2, point),
                ];
                let value = (1.0 - rho) * (1.0 - rho) * l2 * l2 - 4.0 * rho * rho * l1 * l3;
                assert!(value.abs() < 1e-12, "rho {rho}: {value}");
            }
        }
    }

    #[test]
    fn chords_stay_within_the_tolerance_of_the_curve() {
        let splat = disc(DVec2::new(2.0, 1.0), DVec2::ZERO);
        for chord in [1e-2, 1e-4] {
            let tolerance = Tolerance { chord, bend: 1.0 };
            for rho in [0.0, 0.2, 0.5, 0.9, 0.999, 1.0] {
                let conic = Conic { p1: DVec2::X * -2.0, p2: DVec2::new(0.4, 0.6), p3: DVec2::X * 2.0, rho };
                let chain = clip_curve(&splat, &conic, tolerance);
                let worst = conic.points(999).map(|p| distance(p, &chain)).fold(0.0, f64::max);
                assert!(worst <= chord * (1.0 + 1e-9), "rho {rho}: {worst} of {chord}");
                // At most four times the chords that a parabola of that height needs.
                assert!(chain.len() < 16 + (4.0 / chord.sqrt()) as usize, "{} chords", chain.len());
            }
            let mut border = ellipse(&splat, &[], tolerance);
            border.push(border[0]);
            let on = (0..999).map(|n| on_border(f64::from(n) * 0.007, splat.radii));
            let worst = on.map(|p| distance(p, &border)).fold(0.0, f64::max);
            assert!(worst <= chord && worst > 0.01 * chord, "{worst} of {chord}");
        }
    }
}
