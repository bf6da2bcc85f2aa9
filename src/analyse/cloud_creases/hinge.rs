//! Two half planes that meet in a line, fitted to the points around a place; both may bend along the line.

use glam::DVec3;
use nalgebra::{Matrix4, Vector4};

use super::plane::{Moments, Plane};

/// Directions along the mean plane by which points are divided at first, over half a turn.
const TURNS: u32 = 6;

/// The best so many of all first divisions are followed up.
const FOLLOWED: usize = 2;

/// How far points may lie from their half plane to take part in the next fit, in shares of the
/// cutoff: at first the planes are rough. And how far at least from the line, in standard deviations of the
/// noise: those of one side that stray past the middle between both count for the other, so that the rest
/// would draw the line out of the edge, by half a spacing where noise is half of one.
const ROUNDS: [(f64, f64); 4] = [(4.0, 0.0), (2.0, 0.0), (1.0, 2.0), (1.0, 2.0)];

/// Planes that meet at a smaller sine than this (15°) give no line that could be placed.
const FLAT: f64 = 0.26;

/// Points beside the line lie within this share of the neighbourhood's radius of it.
const BESIDE: f64 = 0.2;

/// Two half planes, in the unit and about the origin of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hinge {
    /// The place of the line that is nearest to the origin.
    pub(super) foot: DVec3,
    /// Unit vector along the line, of either sign.
    pub(super) along: DVec3,
    /// Unit vectors from the line into the half planes, perpendicular to it.
    pub(super) inward: [DVec3; 2],
    /// Unit normals of the half planes, of either sign.
    normals: [DVec3; 2],
    /// By how much the sheets leave their half planes by the square of the way along the line; across the line.
    bend: DVec3,
    /// How wide the points of each spread, as [`Plane::width`].
    pub(super) width: [f64; 2],
    /// Points within the cutoff, on each half plane.
    pub(super) held: [usize; 2],
    /// Mean square distance of the points, each no more than the cutoff.
    pub(super) scatter: f64,
}

impl Hinge {
    /// The hinge of least squares near points that scatter by `noise`, with a cutoff beyond which a point's
    /// distance says no more; `normal` is that of the plane through all.
    ///
    /// The points are divided in two in several ways, of which the best are followed: as in
    /// Lloyd's iteration each point goes to its half plane, and the planes are fitted again.
    pub(super) fn fit(points: &[DVec3], normal: DVec3, cutoff: f64, noise: f64) -> Option<Self> {
        let start = |direction: DVec3| {
            let mut moments = [Moments::default(); 2];
            for &p in points {
                let side = usize::from(p.dot(direction) > 0.0);
                moments[side] = moments[side].with(p);
            }
            let hinge = Self::of([moments[0].plane()?, moments[1].plane()?])?;
            Some(hinge.judged(points, cutoff))
        };
        let mut starts: Vec<Self> = directions(normal).into_iter().filter_map(start).collect();
        starts.sort_by(|a, b| a.scatter.total_cmp(&b.scatter));
        let settled =
            starts.into_iter().take(FOLLOWED).filter_map(|start| start.settled(points, cutoff, noise));
        settled.min_by(|a, b| a.scatter.total_cmp(&b.scatter))
    }

    /// The hinge of two planes, each on the side of its points.
    fn of([a, b]: [Plane; 2]) -> Option<Self> {
        let cross = a.normal.cross(b.normal);
        let sine = cross.length();
        let bent = sine > FLAT;
        if !bent {
            return None;
        }
        let along = cross / sine;
        let heights = [a.middle.dot(a.normal), b.middle.dot(b.normal)];
        let foot = (heights[0] * b.normal.cross(along) + heights[1] * along.cross(a.normal)) / sine;
        let inward = [a, b].map(|plane| {
            let inward = along.cross(plane.normal);
            if inward.dot(plane.middle - foot) < 0.0 { -inward } else { inward }
        });
        let (normals, width) = ([a.normal, b.normal], [a.width, b.width]);
        let (held, scatter, bend) = ([0; 2], f64::INFINITY, DVec3::ZERO);
        Some(Self { foot, along, inward, normals, bend, width, held, scatter })
    }

    /// The half plane that a point is of.
    pub(super) fn side(&self, p: DVec3) -> usize {
        self.place(p).0
    }

    /// The half plane that a point is of, and its distance from that plane.
    fn place(&self, p: DVec3) -> (usize, f64) {
        let way = self.straight(p) - self.foot;
        let side = usize::from(way.dot(self.inward[1] - self.inward[0]) > 0.0);
        (side, way.dot(self.normals[side]).abs())
    }

    /// The unit normal of one half plane, of either sign.
    pub(super) fn normal(&self) -> DVec3 {
        self.normals[0]
    }

    /// Whether its sheets bend.
    pub(super) fn is_bent(&self) -> bool {
        self.bend != DVec3::ZERO
    }

    /// From the place of the line beside another to that.
    pub(super) fn off(&self, p: DVec3) -> DVec3 {
        (self.straight(p) - self.foot).reject_from_normalized(self.along)
    }

    /// The place of the line beside another.
    pub(super) fn beside(&self, p: DVec3) -> DVec3 {
        p - self.off(p)
    }

    /// A place as it would lie if the sheets did not bend.
    fn straight(&self, p: DVec3) -> DVec3 {
        let along = p.dot(self.along);
        p - along * along * self.bend
    }

    /// The points of each half plane that lie near it, and some way from the line.
    fn divided(&self, points: &[DVec3], near: f64, clear: f64) -> [Vec<DVec3>; 2] {
        let mut sides = [Vec::new(), Vec::new()];
        for &p in points {
            let (side, distance) = self.place(p);
            let away = (self.straight(p) - self.foot).dot(self.inward[side]);
            if distance <= near && away >= clear {
                sides[side].push(p);
            }
        }
        sides
    }

    /// The hinge whose sheets bend along the line as its points do, as both sides of a hole's rim do: what the
    /// line passes at the origin is its tangent there. `None` where the points do not tell.
    pub(super) fn bent(&self, points: &[DVec3], cutoff: f64, noise: f64) -> Option<Self> {
        let mut hinge = *self;
        for (share, clear) in ROUNDS {
            let sides = hinge.divided(points, share * cutoff, clear * noise);
            let bend = hinge.bend_of([hinge.curvature(0, &sides[0])?, hinge.curvature(1, &sides[1])?]);
            let bent = Self { bend, ..hinge };
            let plane = |side: &[DVec3]| Moments::of(side.iter().map(|&p| bent.straight(p))).plane();
            hinge = Self { bend, ..Self::of([plane(&sides[0])?, plane(&sides[1])?])? };
        }
        Some(hinge.judged(points, cutoff))
    }

    /// By how much points of one side leave its half plane by the square of their way along the line; the rest of
    /// their heights is a plane's (least squares).
    fn curvature(&self, side: usize, points: &[DVec3]) -> Option<f64> {
        let (mut square, mut sides) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
        for &p in points {
            let way = p - self.foot;
            let (s, t) = (way.dot(self.inward[side]), p.dot(self.along));
            let term = Vector4::new(1.0, s, t, t * t);
            square.ger(1.0, &term, &term, 1.0);
            sides += way.dot(self.normals[side]) * term;
        }
        Some(square.cholesky()?.solve(&sides)[3])
    }

    /// What bends both sheets by so much along their normals, which [`FLAT`] keeps apart.
    fn bend_of(&self, curvatures: [f64; 2]) -> DVec3 {
        let [a, b] = self.normals;
        let (to_a, to_b) = (b.cross(self.along), self.along.cross(a));
        curvatures[0] / a.dot(to_a) * to_a + curvatures[1] / b.dot(to_b) * to_b
    }

    /// How far the points beside the line lie within it, where the half planes face each other, on the mean: in
    /// its standard deviation as the points scatter. `radius` is that of the neighbourhood.
    pub(super) fn rounded(&self, points: &[DVec3], radius: f64, cutoff: f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for &p in points {
            let (side, distance) = self.place(p);
            let (way, normal) = (self.straight(p) - self.foot, self.normals[side]);
            if distance <= cutoff && way.dot(self.inward[side]) < BESIDE * radius {
                sum += way.dot(normal) * normal.dot(self.inward[1 - side]).signum();
                count += 1.0;
            }
        }
        if count > 0.0 { sum / (count * self.scatter).sqrt() } else { 0.0 }
    }

    fn judged(mut self, points: &[DVec3], cutoff: f64) -> Self {
        let mut sum = 0.0;
        self.held = [0; 2];
        for &p in points {
            let (side, distance) = self.place(p);
            self.held[side] += usize::from(distance <= cutoff);
            sum += distance.min(cutoff) * distance.min(cutoff);
        }
        self.scatter = sum / points.len() as f64;
        self
    }

    fn settled(self, points: &[DVec3], cutoff: f64, noise: f64) -> Option<Self> {
        let mut hinge = self;
        for (share, clear) in ROUNDS {
            let sides = hinge.divided(points, share * cutoff, clear * noise);
            let plane = |side: &[DVec3]| Moments::of(side.iter().copied()).plane();
            hinge = Self::of([plane(&sides[0])?, plane(&sides[1])?])?;
        }
        Some(hinge.judged(points, cutoff))
    }

    /// Cosine of the angle by which the surface turns at the line: 1 where it goes straight on.
    pub(super) fn turn(&self) -> f64 {
        -self.inward[0].dot(self.inward[1])
    }
}

/// Directions that divide points around a place: along their mean plane, and askew to it for the
/// edges of knives, whose mean plane may be any.
fn directions(normal: DVec3) -> Vec<DVec3> {
    let (right, up) = normal.any_orthonormal_pair();
    let along = (0..TURNS).map(|n| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(n) / f64::from(TURNS));
        cos * right + sin * up
    });
    let askew = [normal, normal + right, normal - right, normal + up, normal - up];
    along.chain(askew).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::random;

    /// Points around the rim of a hole of this radius in the plane `z = 0`, in which its wall goes down; the origin
    /// is a place of the rim, which runs along y there.
    fn rim(radius: f64) -> Vec<DVec3> {
        let place = |n: u64| {
            let (angle, way) = (2.2 / radius * random(2 * n), 1.5 * (1.0 + random(2 * n + 1)));
            let (sin, cos) = libm::sincos(angle);
            let (out, down) = if n.is_multiple_of(2) { (radius + way, 0.0) } else { (radius, way) };
            DVec3::new(out * cos - radius, out * sin, -down)
        };
        (0..60).map(place).collect()
    }

    #[test]
    fn a_rim_bends_both_sides() {
        for radius in [4.0, 6.0, 12.0] {
            let points = rim(radius);
            let flat = Hinge::fit(&points, DVec3::new(1.0, 0.0, 1.0).normalize(), 0.5, 0.0).unwrap();
            let bent = flat.bent(&points, 0.5, 0.0).unwrap();
            let off = bent.foot.reject_from_normalized(bent.along).length();
            assert!(off < 0.25 / radius, "the line passes {off} beside the rim of {radius}");
            assert!(bent.along.y.abs() > 0.99 && bent.turn().abs() < 0.1, "{bent:?}");
            assert!(bent.scatter < 0.05 * flat.scatter, "{} for {}", bent.scatter, flat.scatter);
            assert!((bent.bend.x * radius + 0.5).abs() < 0.1, "{} at {radius}", bent.bend);
        }
    }

    #[test]
    fn straight_sides_stay_straight() {
        let place = |n: u64| {
            let (along, way) = (3.0 * random(2 * n), 1.5 * (1.0 + random(2 * n + 1)));
            DVec3::new(0.0, along, 0.0) + if n.is_multiple_of(2) { way * DVec3::X } else { -way * DVec3::Z }
        };
        let points: Vec<DVec3> = (0..60).map(place).collect();
        let flat = Hinge::fit(&points, DVec3::new(1.0, 0.0, 1.0).normalize(), 0.5, 0.0).unwrap();
        let bent = flat.bent(&points, 0.5, 0.0).unwrap();
        assert!(bent.bend.length() < 1e-9 && bent.foot.length() < 1e-9, "{bent:?}");
    }
}
