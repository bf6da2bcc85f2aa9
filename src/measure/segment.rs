//! A piece of a splat's border, lifted on the quadric, and its place nearest to a point.

use glam::{DVec2, DVec3};

use super::border::{Kind, Piece, height};
use super::roots;
use crate::model::clip_curve::Conic;
use crate::model::polyline::nearest_on;
use crate::model::splat::Splat;

/// A piece of the border in splat coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) conic: Conic,
    pub(super) kind: Kind,
    /// The ends, on the quadric.
    pub(super) ends: [DVec3; 2],
    /// No point of the lifted piece is farther than this from the straight line between them.
    pub(super) reach: f64,
}

/// A conic's point at a parameter in `[0, 1]`, and its derivative. `rho` is below 1.
pub(super) fn conic(conic: &Conic, t: f64) -> (DVec2, DVec2) {
    let Conic { p1, p2, p3, rho } = *conic;
    if rho == 0.0 {
        return (p1.lerp(p3, t), p3 - p1);
    }
    let s = 1.0 - t;
    let (outer, inner) = (1.0 - rho, rho);
    let (b1, b2, b3) = (outer * s * s, 2.0 * inner * s * t, outer * t * t);
    let (d1, d2, d3) = (-2.0 * outer * s, 2.0 * inner * (s - t), 2.0 * outer * t);
    let weight = b1 + b2 + b3;
    let at = (b1 * p1 + b2 * p2 + b3 * p3) / weight;
    let along = (d1 * p1 + d2 * p2 + d3 * p3 - at * (d1 + d2 + d3)) / weight;
    (at, along)
}

impl Segment {
    /// Lifts a piece.
    pub(super) fn new(splat: &Splat, piece: &Piece) -> Self {
        let Conic { p1, p3, .. } = piece.conic;
        let lift = |uv: DVec2| uv.extend(splat.height(uv));
        // The curve passes its chord within its height, where the surface climbs no steeper than
        // over the ellipse; over the chord the surface bends by a quarter of its second difference.
        let slope = (2.0 * splat.curvature * splat.radii).abs().max_element();
        let steep = libm::sqrt(1.0 + slope * slope);
        let reach = steep * height(&piece.conic) + 0.25 * splat.height(p3 - p1).abs();
        Self { conic: piece.conic, kind: piece.kind, ends: [lift(p1), lift(p3)], reach }
    }

    /// The lifted point at a parameter, and its derivative.
    pub(super) fn lifted(&self, curvature: DVec2, t: f64) -> (DVec3, DVec3) {
        let (at, along) = conic(&self.conic, t);
        let rise = curvature * at;
        (at.extend(rise.dot(at)), along.extend(2.0 * rise.dot(along)))
    }

    /// No place of the segment is nearer to the point than this.
    pub(super) fn least(&self, p: DVec3) -> f64 {
        let [a, b] = self.ends;
        nearest_on(a, b, p).distance(p) - self.reach
    }

    /// The place nearest to the point, and its distance.
    pub(super) fn nearest(&self, curvature: DVec2, p: DVec3) -> (DVec2, f64) {
        let slope = |t: f64| {
            let (at, along) = self.lifted(curvature, t);
            (at - p).dot(along)
        };
        let mut best = (self.conic.p1, f64::INFINITY);
        let mut look = |t: f64| {
            let at = self.lifted(curvature, t).0;
            let distance = at.distance(p);
            if distance < best.1 {
                best = (at.truncate(), distance);
            }
        };
        look(0.0);
        look(1.0);
        let mut knots = KNOTS.map(|t| (t, slope(t))).to_vec();
        for pair in KNOTS.windows(2) {
            // Two places of zero slope between knots of equal signs: the slope has an extremum there.
            let turn = |t: f64| slope(t + STEP) - slope(t - STEP);
            let [from, to] = [slope(pair[0]), slope(pair[1])];
            if (from > 0.0) == (to > 0.0) {
                let (turn_from, turn_to) = (turn(pair[0]), turn(pair[1]));
                if turn_from * to < 0.0 && turn_to * to > 0.0 {
                    let t = roots::between(turn, (pair[0], turn_from), (pair[1], turn_to));
                    knots.push((t, slope(t)));
                }
            }
        }
        knots.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for pair in knots.windows(2).filter(|pair| pair[0].1 < 0.0 && pair[1].1 > 0.0) {
            look(roots::between(slope, pair[0], pair[1]));
        }
        best
    }
}

/// Parameters between which the slope of the distance is taken to have one extremum at most.
const KNOTS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Parameter step of the differences that find such an extremum: the middle between the rounding
/// of the slope and the slope's own bend.
const STEP: f64 = 1e-5;
