//! Two half planes that meet in a line, fitted to the points around a place.

use glam::DVec3;

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
        Some(Self { foot, along, inward, normals, width, held: [0; 2], scatter: f64::INFINITY })
    }

    /// The half plane that a point is of, and its distance from that plane.
    fn place(&self, p: DVec3) -> (usize, f64) {
        let way = p - self.foot;
        let side = usize::from(way.dot(self.inward[1] - self.inward[0]) > 0.0);
        (side, way.dot(self.normals[side]).abs())
    }

    /// How far the points beside the line lie within it, where the half planes face each other, on the mean: in
    /// its standard deviation as the points scatter. `radius` is that of the neighbourhood.
    pub(super) fn rounded(&self, points: &[DVec3], radius: f64, cutoff: f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for &p in points {
            let (side, distance) = self.place(p);
            let (way, normal) = (p - self.foot, self.normals[side]);
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
            let mut moments = [Moments::default(); 2];
            for &p in points {
                let (side, distance) = hinge.place(p);
                let away = (p - hinge.foot).dot(hinge.inward[side]);
                if distance <= share * cutoff && away >= clear * noise {
                    moments[side] = moments[side].with(p);
                }
            }
            hinge = Self::of([moments[0].plane()?, moments[1].plane()?])?;
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
