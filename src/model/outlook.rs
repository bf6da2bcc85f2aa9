//! The sides that a model is looked at from, and how large pictures show it there.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Width and height of a picture, pixels.
pub const SIDE: u32 = 512;

/// Share of the picture's side that the model's greater extent fills: what is left shows what
/// sticks out.
pub const FILLED: f64 = 0.95;

/// How points look along one of the 26 directions of the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// The corner of `{-1, 0, 1}³` that they are seen from, far away.
    pub corner: DVec3,
    /// Unit; what points up in the picture, before it is turned at right angles to the direction.
    pub up: DVec3,
    /// Unit vectors to the right and up in the picture.
    axes: [DVec3; 2],
    /// Least and greatest place of the points along these, model units.
    spans: [[f64; 2]; 2],
}

impl Outlook {
    /// From the points to the eye, unit.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.corner.normalize()
    }

    /// The greater of the points' two extents, model units.
    #[must_use]
    pub fn extent(&self) -> f64 {
        self.spans.iter().map(|[low, high]| high - low).fold(0.0, f64::max)
    }

    /// Height of a picture that shows them all, model units.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.extent() / FILLED
    }

    /// Side of a pixel of that picture, [`SIDE`] pixels high, model units.
    #[must_use]
    pub fn pixel(&self) -> f64 {
        self.height() / f64::from(SIDE)
    }

    /// The middle of what they span, in the plane of the picture through the origin.
    #[must_use]
    pub fn middle(&self) -> DVec3 {
        let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
        middle(self.spans[0]) * self.axes[0] + middle(self.spans[1]) * self.axes[1]
    }
}

/// How points look from a cube's 6 faces, 12 edges and 8 corners, in this order.
///
/// Up is `+Y`; seen from `+Y` it is `-Z`, from `-Y` it is `+Z`.
#[must_use]
pub fn outlooks(points: &[Vec3]) -> Vec<Outlook> {
    let steps = [1.0, 0.0, -1.0];
    let mut corners: Vec<DVec3> = Vec::with_capacity(27);
    for x in steps {
        for y in steps {
            corners.extend(steps.map(|z| DVec3::new(x, y, z)));
        }
    }
    // Faces, edges, corners: by how many coordinates are not 0. The sort keeps the order within.
    corners.retain(|corner| *corner != DVec3::ZERO);
    corners.sort_by_key(|corner| corner.abs().element_sum() as u32);
    corners.into_par_iter().map(|corner| outlook(corner, points)).collect()
}

/// How points look from one corner of `{-1, 0, 1}³`.
fn outlook(corner: DVec3, points: &[Vec3]) -> Outlook {
    let direction = corner.normalize();
    let up = if corner.x == 0.0 && corner.z == 0.0 { -corner.y * DVec3::Z } else { DVec3::Y };
    let right = up.cross(direction).normalize();
    let axes = [right, direction.cross(right)];
    Outlook { corner, up, axes, spans: axes.map(|axis| span(points, axis)) }
}

/// Least and greatest place of points along an axis.
fn span(points: &[Vec3], axis: DVec3) -> [f64; 2] {
    let places = points.iter().map(|point| point.as_dvec3().dot(axis));
    let span = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
    if span[0] <= span[1] { span } else { [0.0; 2] }
}
