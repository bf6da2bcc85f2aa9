//! The clip curve: a rational quadratic Bézier curve of five numbers.
//!
//! Ivo 2020, sections 3.2 and 3.3. `P1` and `P3` lie on the ellipse's border at central
//! angles `alpha1, alpha3`; `P2 = (x, y)` is free; the shape is `rho = w/(1+w)` in `[0, 1]`:
//! 0 is the chord, 1/2 a parabola, 1 the control polygon (a corner).
//!
//! Cut away is the area between the border arc from `P1` to `P3`, counter-clockwise, and the
//! curve: what lies to the right of the curve walked from `P1` to `P3`.

use glam::DVec2;

/// Five numbers that cut a splat, in its `(u, v)` plane and in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipCurve {
    /// Central angle of `P1` on the ellipse, radians in `[0, 2π)`.
    pub alpha1: f64,
    /// Central angle of `P3`, radians in `[0, 2π)`.
    pub alpha3: f64,
    /// The free control point `P2`.
    pub p2: DVec2,
    /// Shape in `[0, 1]`; at 0 the curve is the chord and `p2` does not matter.
    pub rho: f64,
}

/// The border point of an ellipse at a central angle.
///
/// `r(alpha) (cos alpha, sin alpha)` with
/// `r = r_u r_v / sqrt((r_v cos)² + (r_u sin)²)`.
#[must_use]
pub fn border_point(alpha: f64, radii: DVec2) -> DVec2 {
    let (sin, cos) = libm::sincos(alpha);
    let r = radii.x * radii.y / libm::hypot(radii.y * cos, radii.x * sin);
    r * DVec2::new(cos, sin)
}

/// Twice the signed area of the triangle `a, b, c`: positive when it turns left.
#[must_use]
pub fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

impl ClipCurve {
    /// A straight cut along the chord from `alpha1` to `alpha3`.
    #[must_use]
    pub fn chord(alpha1: f64, alpha3: f64) -> Self {
        Self { alpha1, alpha3, p2: DVec2::ZERO, rho: 0.0 }
    }

    /// Whether the curve is the chord, which needs two numbers instead of five.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        self.rho == 0.0
    }

    /// `P1` and `P3` on the border of an ellipse with these radii.
    #[must_use]
    pub fn ends(&self, radii: DVec2) -> (DVec2, DVec2) {
        (border_point(self.alpha1, radii), border_point(self.alpha3, radii))
    }

    /// The control points and the shape, ready for many tests.
    #[must_use]
    pub fn conic(&self, radii: DVec2) -> Conic {
        let (p1, p3) = self.ends(radii);
        Conic { p1, p2: self.p2, p3, rho: self.rho }
    }

    /// Whether this curve cuts the point away.
    #[must_use]
    pub fn cuts(&self, uv: DVec2, radii: DVec2) -> bool {
        self.conic(radii).cuts(uv)
    }
}

/// A clip curve with its ends worked out: `P1, P2, P3` and `rho`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    /// First point, on the ellipse's border.
    pub p1: DVec2,
    /// Control point.
    pub p2: DVec2,
    /// Last point, on the ellipse's border.
    pub p3: DVec2,
    /// Shape in `[0, 1]`.
    pub rho: f64,
}

impl Conic {
    /// Whether the point lies to the right of the curve.
    ///
    /// Free of division, root and threshold. With the signed areas
    /// `l1 = [Q,P2,P3], l2 = [P1,Q,P3], l3 = [P1,P2,Q]` taken positive inside the triangle,
    /// the bulge between chord and curve is where all three are positive and
    /// `(1-rho)² l2² < 4 rho² l1 l3`. The *inner* region is the chord's far side from `P2`
    /// together with the bulge; turning left at `P2` cuts the outer region, turning right
    /// the inner one (Ivo 2020, Fig. 25). Where `[P1,P2,P3]` vanishes the chord decides.
    ///
    /// No bulge reaches beyond its shoulder, where `l2` is the share `rho` of `[P1,P2,P3]`. That
    /// follows from the rest, but not as it is rounded: where `P1` and `P3` nearly coincide, `l1`
    /// and `l3` are lost in rounding all along the legs, and `l2` is not.
    #[must_use]
    pub fn cuts(&self, q: DVec2) -> bool {
        let chord = turn(self.p1, self.p3, q);
        let area = turn(self.p1, self.p2, self.p3);
        if self.rho == 0.0 || area == 0.0 {
            return chord < 0.0;
        }
        let sign = area.signum();
        let l1 = sign * turn(q, self.p2, self.p3);
        let l2 = -sign * chord;
        let l3 = sign * turn(self.p1, self.p2, q);
        let (chordal, curved) = ((1.0 - self.rho) * l2, self.rho);
        let bulge = l2 > 0.0
            && l2 < self.rho * area.abs()
            && l1 > 0.0
            && l3 > 0.0
            && chordal * chordal < 4.0 * curved * curved * l1 * l3;
        let inner = l2 <= 0.0 || bulge;
        if area > 0.0 { !inner } else { inner }
    }

    /// How far a place, on either side, lies from the curve, to first order. The plane may be shrunk by
    /// `scale` along its axes; the distance is that before. Beyond its ends the curve goes on along its
    /// tangents, as the line does that it follows.
    ///
    /// With the areas of [`Self::cuts`] the curve is where `f = (1-rho)² l2² - 4 rho² l1 l3` vanishes, and
    /// `|f| / |grad f|` is how far off that is (Taubin 1991). The rest of an ellipse lies next to a flat arc:
    /// on its side, the factor `2 rho sqrt(l1 l3) - (1-rho) l2` takes the place of `f`, as it vanishes on the
    /// arc alone, but for beside the ends, where it grows as the root of the distance does and tells up to twice
    /// as much: the lesser of the two holds. Other parts of the conic lie outside the triangle, which no place
    /// outside is nearer to than to the lines along its sides.
    #[must_use]
    pub fn distance(&self, q: DVec2, scale: DVec2) -> f64 {
        let slope = |a: DVec2, b: DVec2| DVec2::new(a.y - b.y, b.x - a.x) / scale;
        let off = |f: f64, slope: DVec2| if f == 0.0 { 0.0 } else { f / slope.length() };
        let [s1, s2, s3] =
            [(self.p2, self.p3), (self.p3, self.p1), (self.p1, self.p2)].map(|(a, b)| slope(a, b));
        let area = turn(self.p1, self.p2, self.p3);
        let chord = turn(self.p3, self.p1, q);
        if self.rho == 0.0 || area == 0.0 {
            return off(chord.abs(), s2);
        }
        let sign = area.signum();
        let [l1, l2, l3] = [turn(self.p2, self.p3, q), chord, turn(self.p1, self.p2, q)].map(|l| sign * l);
        let outside = off(-l1, s1).max(off(-l2, s2)).max(off(-l3, s3));
        let (chordal, product) = ((1.0 - self.rho) * l2, 4.0 * self.rho * self.rho * l1 * l3);
        let curved = product.max(0.0).sqrt();
        let level = (1.0 - self.rho) * s2;
        let bent = 2.0 * self.rho * self.rho * (l1 * s3 + l3 * s1);
        let whole = |chordal: f64| off((chordal * chordal - product).abs(), 2.0 * (chordal * level - bent));
        let near = if self.rho <= 0.5 && curved > 0.0 && chordal < curved {
            whole(chordal.max(0.0)).min(off(curved - chordal, bent / curved - level))
        } else {
            whole(chordal)
        };
        let along = |a: DVec2, b: DVec2| ((q - b) * scale).dot((b - a) * scale) > 0.0;
        let gone_on = [(along(self.p2, self.p3), l1, s1), (along(self.p2, self.p1), l3, s3)]
            .into_iter()
            .filter(|&(beyond, ..)| beyond)
            .map(|(_, l, slope)| off(l.abs(), slope));
        gone_on.fold(near.max(outside), f64::min)
    }

    /// The point at parameter `t` in `[0, 1]`.
    ///
    /// With `w = rho/(1-rho)` both sides of the fraction are multiplied by `1-rho`, so that
    /// `rho = 1` needs no special case except at its two ends.
    #[must_use]
    pub fn point(&self, t: f64) -> DVec2 {
        let s = 1.0 - t;
        let (b1, b2, b3) = ((1.0 - self.rho) * s * s, 2.0 * self.rho * s * t, (1.0 - self.rho) * t * t);
        let weight = b1 + b2 + b3;
        if weight > 0.0 {
            (b1 * self.p1 + b2 * self.p2 + b3 * self.p3) / weight
        } else if t < 0.5 {
            self.p1
        } else {
            self.p3
        }
    }

    /// `count + 1` points from `P1` to `P3`. At `rho = 1`, where the curve is the control
    /// polygon, they walk its two legs.
    pub fn points(&self, count: usize) -> impl Iterator<Item = DVec2> + '_ {
        (0..=count).map(move |n| {
            let t = n as f64 / count as f64;
            if self.rho < 1.0 {
                self.point(t)
            } else if t < 0.5 {
                self.p1.lerp(self.p2, 2.0 * t)
            } else {
                self.p2.lerp(self.p3, 2.0 * t - 1.0)
            }
        })
    }

    /// Points from `P1` to `P3`, none farther than `step` from the one before: equal steps of the
    /// parameter leave out most of the arms of a shape next to 1.
    #[must_use]
    pub fn walk(&self, step: f64) -> Vec<DVec2> {
        let mut points = vec![self.p1];
        if self.rho > 0.0 && self.rho < 1.0 {
            for n in 0..WALK_PARTS {
                let at = |n: u32| f64::from(n) / f64::from(WALK_PARTS);
                self.walk_part([at(n), at(n + 1)], step, WALK_DEPTH, &mut points);
            }
        } else {
            let corner = (self.rho > 0.0).then_some(self.p2);
            for end in corner.into_iter().chain([self.p3]) {
                let start = points[points.len() - 1];
                let count = (start.distance(end) / step).ceil().clamp(1.0, WALK_MOST);
                points.extend((1..=count as usize).map(|n| start.lerp(end, n as f64 / count)));
            }
        }
        points
    }

    /// The points of a part of the curve but the first, halved by its parameter until near enough.
    fn walk_part(&self, [from, to]: [f64; 2], step: f64, depth: u32, points: &mut Vec<DVec2>) {
        let end = self.point(to);
        if depth == 0 || points[points.len() - 1].distance(end) <= step {
            points.push(end);
            return;
        }
        let middle = 0.5 * (from + to);
        self.walk_part([from, middle], step, depth - 1, points);
        self.walk_part([middle, to], step, depth - 1, points);
    }
}

/// Parts that a curve is walked in: each turns little enough for its chord to tell its length.
const WALK_PARTS: u32 = 16;

/// Halvings of each part at most: they reach all along the arms of shapes up to 0.99999.
const WALK_DEPTH: u32 = 24;

/// Points along a straight leg at most.
const WALK_MOST: f64 = 65_536.0;

#[cfg(test)]
mod tests {
    use super::*;

    const P1: DVec2 = DVec2::new(-1.0, 0.0);
    const P3: DVec2 = DVec2::new(1.0, 0.0);

    #[test]
    fn the_curve_separates_kept_from_cut_for_every_shape_and_turn() {
        for rho in [0.0, 0.1, 0.5, 0.9, 1.0] {
            for side in [-0.8, 0.8] {
                let conic = Conic { p1: P1, p2: DVec2::new(0.2, side), p3: P3, rho };
                let middle = conic.point(0.5);
                let step = DVec2::Y * 1e-9;
                assert!(conic.cuts(middle - step), "right of the curve, rho {rho} side {side}");
                assert!(!conic.cuts(middle + step), "left of the curve, rho {rho} side {side}");
            }
        }
    }

    #[test]
    fn distances_hold_to_first_order() {
        for rho in [0.0, 0.2, 0.5, 0.9, 1.0] {
            for side in [-0.8, 0.8] {
                let conic = Conic { p1: P1, p2: DVec2::new(0.2, side), p3: P3, rho };
                let curve: Vec<DVec2> = conic.walk(1e-4);
                for n in 1..40 {
                    let t = f64::from(n) / 40.0;
                    // Along the normal, where the curve has one.
                    let [before, at, after] = [t - 1e-4, t, t + 1e-4].map(|t| conic.point(t));
                    let normal = (after - before).perp().normalize_or_zero();
                    for off in [-0.03, 0.03] {
                        let q = at + off * normal;
                        let distance = curve.iter().map(|p| p.distance(q)).fold(f64::INFINITY, f64::min);
                        let scale = DVec2::new(2.0, 0.5);
                        let small = |p: DVec2| p / scale;
                        let [p1, p2, p3] = [conic.p1, conic.p2, conic.p3].map(small);
                        let shrunk = Conic { p1, p2, p3, rho };
                        let found = shrunk.distance(small(q), scale);
                        assert!(found >= 0.8 * distance - 1e-4, "rho {rho} {q}: {found}");
                        // To first order; beside the ends, where the tangents come near, less exactly.
                        let most = if (0.11..0.89).contains(&t) { 1.25 } else { 1.75 };
                        assert!(found <= most * distance + 1e-9, "rho {rho} {q}: {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn beside_the_ends_of_arcs_distances_are_no_more_than_they_are() {
        for half in [20.0, 45.0, 67.0] {
            // The tangents at the ends meet straight above the middle, where the weight is the cosine.
            let (sin, cos) = libm::sincos(f64::to_radians(half));
            let rho = cos / (1.0 + cos);
            let arc = Conic {
                p1: DVec2::new(-sin, cos),
                p2: DVec2::new(0.0, 1.0 / cos),
                p3: DVec2::new(sin, cos),
                rho,
            };
            for (t, inside) in [(0.0, 1e-4), (1e-4, 1e-3), (0.01, 1e-3), (0.99, 1e-3), (1.0, 1e-4)] {
                let found = arc.distance((1.0 - inside) * arc.point(t), DVec2::ONE);
                assert!((0.9..1.1).contains(&(found / inside)), "{half}° {t}: {}", found / inside);
            }
        }
    }

    #[test]
    fn a_walk_takes_no_long_step_whatever_the_shape() {
        for rho in [0.0, 0.1, 0.5, 0.99, 0.9999, 1.0] {
            let conic = Conic { p1: P1, p2: DVec2::new(0.2, 0.8), p3: P3, rho };
            let walk = conic.walk(0.01);
            assert_eq!((walk[0], walk[walk.len() - 1]), (P1, P3));
            let longest = walk.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
            assert!(longest <= 0.01 + 1e-12, "rho {rho}: {longest}");
            assert!(walk.len() < 1000, "rho {rho}: {} points", walk.len());
            let strays = conic.points(7).any(|p| !walk.iter().any(|q| q.distance(p) <= 0.01));
            assert!(!strays, "rho {rho}");
        }
    }

    #[test]
    fn nothing_beyond_the_shoulder_lies_in_the_bulge() {
        // Ends so near to each other that rounding hides on which side of either leg a place lies.
        let p1 = DVec2::new(1e-3, 1.0);
        let p3 = p1 + DVec2::X * 1e-17;
        for p2 in [DVec2::new(-0.79, -0.8), DVec2::new(0.6, -0.3)] {
            let conic = Conic { p1, p2, p3, rho: 0.5 };
            let turns_left = turn(p1, p2, p3) > 0.0;
            for n in 0..1000 {
                let q = p1.lerp(p2, 0.51 + 0.49 * f64::from(n) / 1000.0);
                assert_eq!(conic.cuts(q), turns_left, "{q} of {conic:?}");
            }
        }
    }

    #[test]
    fn a_quarter_circle_is_exact() {
        // w = cos 45° makes the conic a circle (Farin, NURBS, 4.2).
        let w = std::f64::consts::FRAC_1_SQRT_2;
        let conic = Conic { p1: DVec2::X, p2: DVec2::ONE, p3: DVec2::Y, rho: w / (1.0 + w) };
        for point in conic.points(32) {
            assert!((point.length() - 1.0).abs() < 1e-15);
        }
        // It turns left, so the outer region is cut.
        assert!(conic.cuts(DVec2::splat(0.7072)) && !conic.cuts(DVec2::splat(0.707)));
    }

    #[test]
    fn ends_lie_on_the_border() {
        let radii = DVec2::new(3.0, 0.003);
        for n in 0..100 {
            let point = border_point(f64::from(n) * 0.0628, radii);
            assert!(((point / radii).length() - 1.0).abs() < 1e-12);
        }
    }
}
