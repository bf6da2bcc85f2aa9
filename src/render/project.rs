//! The screen bound of a splat; twin of `project.wgsl`.
//!
//! Over its elliptic domain a splat lies between the heights `low` and `high`, so the prism
//! over the ellipse between them holds it, and the prism is the convex hull of its two end
//! ellipses. The extent of an ellipse's picture has a closed form under both projections. A
//! prism that reaches through the near plane is bounded by the box around it, cut there.

use glam::{DVec2, DVec3};

use super::constants::BOUND_PAD;
use super::eye::Eye;

/// The prism that holds a splat, in view coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Prism {
    /// The splat's centre.
    pub center: DVec3,
    /// `r_u i` and `r_v j`.
    pub half_axes: [DVec3; 2],
    /// `k`, the direction of heights.
    pub normal: DVec3,
    /// Least height over the domain, at most 0.
    pub low: f64,
    /// Greatest height over the domain, at least 0.
    pub high: f64,
}

/// A rectangle of the picture in samples, from its upper left corner; not cut to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Upper left corner.
    pub min: DVec2,
    /// Lower right corner.
    pub max: DVec2,
}

/// The bound of a prism's picture, or `None` when nothing of it is in front of the near plane.
#[must_use]
pub fn bound(prism: &Prism, eye: &Eye) -> Option<Bound> {
    let ends = [prism.center + prism.low * prism.normal, prism.center + prism.high * prism.normal];
    let spread = hypot(prism.half_axes[0].z, prism.half_axes[1].z);
    let nearest = ends[0].z.min(ends[1].z) - spread;
    let plane = if nearest > eye.near {
        let extents = ends.map(|end| ellipse_extent(end, &prism.half_axes, spread, eye.perspective));
        if prism.low < prism.high { join(extents[0], extents[1]) } else { extents[0] }
    } else {
        cut_box_extent(prism, eye)?
    };
    Some(to_samples(plane, eye))
}

/// Least and greatest sideways place of an ellipse's picture in the picture's plane.
///
/// Measured from the picture `p` of the centre, so that nothing cancels for a small ellipse.
/// Under perspective the offset `d` of a tangent line solves
/// `d² (z² - u_z² - v_z²) + 2 d (u' u_z + v' v_z) - (u'² + v'²) = 0` with `u' = u_x - p u_z`;
/// the same for `v` and for the other axis.
fn ellipse_extent(center: DVec3, axes: &[DVec3; 2], spread: f64, perspective: bool) -> [DVec2; 2] {
    let [u, v] = axes;
    if !perspective {
        let half = DVec2::new(hypot(u.x, v.x), hypot(u.y, v.y));
        return [center.truncate() - half, center.truncate() + half];
    }
    let p = center.truncate() / center.z;
    let (du, dv) = (u.truncate() - p * u.z, v.truncate() - p * v.z);
    let square = (center.z - spread) * (center.z + spread);
    let linear = du * u.z + dv * v.z;
    let constant = du * du + dv * dv;
    let root = linear * linear + square * constant;
    let root = DVec2::new(root.x.sqrt(), root.y.sqrt());
    [p + (-linear - root) / square, p + (root - linear) / square]
}

/// The twelve edges of a box whose corner `n` has bit 0 for `u`, bit 1 for `v`, bit 2 for `k`.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The extent of the prism's box in front of the near plane.
fn cut_box_extent(prism: &Prism, eye: &Eye) -> Option<[DVec2; 2]> {
    let corner = |n: usize| {
        let side = |bit: usize| if n >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let height = if n >> 2 == 0 { prism.low } else { prism.high };
        prism.center + side(0) * prism.half_axes[0] + side(1) * prism.half_axes[1] + height * prism.normal
    };
    edges_extent(EDGES.into_iter().map(|edge| edge.map(corner)), eye)
}

/// The bound of a convex polygon, or `None` when nothing of it is in front of the near plane.
#[must_use]
pub fn polygon_bound<const N: usize>(corners: [DVec3; N], eye: &Eye) -> Option<Bound> {
    let sides = (0..N).map(|n| [corners[n], corners[(n + 1) % N]]);
    edges_extent(sides, eye).map(|plane| to_samples(plane, eye))
}

/// The corners of a triangle's picture in samples, some of them repeated, or `None` when nothing of it is in front of
/// the near plane.
#[must_use]
pub fn triangle(corners: [DVec3; 3], eye: &Eye) -> Option<[DVec2; 4]> {
    let (mut shown, mut count) = ([DVec2::ZERO; 4], 0);
    let mut take = |point: DVec3| {
        // What the near plane cuts off of three corners leaves four at most.
        shown[count..].fill(in_samples(place(point, eye), eye));
        count += 1;
    };
    for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b])) {
        if a.z >= eye.near {
            take(a);
        }
        if let Some(crossing) = near_crossing(a, b, eye.near) {
            take(crossing);
        }
    }
    (count > 0).then_some(shown)
}

/// Where the near plane cuts an edge.
fn near_crossing(a: DVec3, b: DVec3, near: f64) -> Option<DVec3> {
    let (da, db) = (a.z - near, b.z - near);
    ((da < 0.0) != (db < 0.0)).then(|| (a + (b - a) * (da / (da - db))).truncate().extend(near))
}

/// Where a point shows in the picture's plane.
fn place(point: DVec3, eye: &Eye) -> DVec2 {
    if eye.perspective { point.truncate() / point.z } else { point.truncate() }
}

/// The extent of a convex body's edges in front of the near plane: of their ends there, and
/// of their crossings with the plane.
fn edges_extent(edges: impl Iterator<Item = [DVec3; 2]>, eye: &Eye) -> Option<[DVec2; 2]> {
    let mut extent: Option<[DVec2; 2]> = None;
    let mut take = |point: DVec3| {
        let place = place(point, eye);
        extent = Some(extent.map_or([place; 2], |old| join(old, [place; 2])));
    };
    for [a, b] in edges {
        [a, b].into_iter().filter(|end| end.z >= eye.near).for_each(&mut take);
        near_crossing(a, b, eye.near).into_iter().for_each(&mut take);
    }
    extent
}

/// The least box around two.
fn join(a: [DVec2; 2], b: [DVec2; 2]) -> [DVec2; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The bound in samples of an extent in the picture's plane.
fn to_samples(plane: [DVec2; 2], eye: &Eye) -> Bound {
    let [a, b] = plane.map(|place| in_samples(place, eye));
    Bound { min: a.min(b) - BOUND_PAD, max: a.max(b) + BOUND_PAD }
}

/// From the picture's plane, up, to samples, down.
fn in_samples(place: DVec2, eye: &Eye) -> DVec2 {
    eye.middle() + place * DVec2::new(1.0, -1.0) * eye.samples_per_unit()
}

/// Length of `(x, y)`, whose squares neither overflow nor vanish in model units.
fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::model::frame::Frame;
    use crate::render::camera::{Camera, Projection};
    use glam::{DMat3, DQuat};
    use proptest::prelude::*;

    fn eye(perspective: bool, near: f64) -> Eye {
        let projection = if perspective {
            Projection::Perspective { fov_degrees: 70.0 }
        } else {
            Projection::Orthographic { height: 2.0 }
        };
        let camera = Camera {
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            projection,
            near: Some(near),
        };
        Eye::new(&camera, &Frame::default(), [640, 480]).unwrap()
    }

    /// Points of the quadric over rings of the domain.
    fn points(center: DVec3, axes: DMat3, radii: DVec2, curvature: DVec2) -> Vec<DVec3> {
        let rings =
            (0..=8).flat_map(|ring| (0..64).map(move |step| (f64::from(ring) / 8.0, f64::from(step) * 0.1)));
        rings
            .map(|(r, angle)| {
                let (sin, cos) = libm::sincos(angle);
                let uv = r * radii * DVec2::new(cos, sin);
                center + axes * uv.extend((curvature * uv).dot(uv))
            })
            .collect()
    }

    proptest! {
        #[test]
        fn every_point_in_front_is_inside(
            perspective: bool, center in proptest::array::uniform3(-1.0..1.0), depth in -0.5..4.0,
            turn in proptest::array::uniform4(-1.0..1.0), radii in proptest::array::uniform2(1e-3..1.0),
            curvature in proptest::array::uniform2(-2.0..2.0), flat: bool, small in 0_i32..12,
        ) {
            let turn = DQuat::from_array(turn);
            prop_assume!(turn.length() > 0.1);
            let axes = DMat3::from_quat(turn.normalize());
            let radii = DVec2::from(radii) * 0.5_f64.powi(small);
            let curvature = if flat { DVec2::ZERO } else { DVec2::from(curvature) };
            let center = DVec3::new(center[0], center[1], depth);
            let sagitta = curvature * radii * radii;
            let prism = Prism {
                center,
                half_axes: [radii.x * axes.x_axis, radii.y * axes.y_axis],
                normal: axes.z_axis,
                low: sagitta.min_element().min(0.0),
                high: sagitta.max_element().max(0.0),
            };
            let eye = eye(perspective, 0.05);
            let bound = bound(&prism, &eye);
            let points = points(center, axes, radii, curvature);
            let shown: Vec<DVec2> =
                points.iter().filter(|p| p.z >= eye.near).map(|p| in_samples(place(*p, &eye), &eye)).collect();
            for place in &shown {
                let bound = bound.unwrap();
                let inside = place.cmpge(bound.min - 1e-6).all() && place.cmple(bound.max + 1e-6).all();
                prop_assert!(inside, "{} outside {:?}", place, bound);
            }
            // A flat splat that is all in front touches its bound on all four sides.
            if flat && points.iter().all(|p| p.z > eye.near) {
                let bound = bound.unwrap();
                let (min, max) = shown.iter().fold((shown[0], shown[0]), |(a, b), p| (a.min(*p), b.max(*p)));
                let slack = 0.03 * (bound.max - bound.min) + 2.0 * BOUND_PAD;
                prop_assert!((min - bound.min).cmple(slack).all() && (bound.max - max).cmple(slack).all());
            }
        }
    }

    proptest! {
        #[test]
        fn the_picture_of_a_triangle_fills_its_bound(
            perspective: bool, corners in proptest::array::uniform9(-1.0..1.0),
        ) {
            let corners: [DVec3; 3] = std::array::from_fn(|n| DVec3::from_slice(&corners[3 * n..]));
            let eye = eye(perspective, 0.05);
            let (shown, bound) = (triangle(corners, &eye), polygon_bound(corners, &eye));
            prop_assert_eq!(shown.is_some(), corners.iter().any(|corner| corner.z >= eye.near));
            prop_assert_eq!(shown.is_some(), bound.is_some());
            if let (Some(shown), Some(bound)) = (shown, bound) {
                let least = shown.into_iter().reduce(DVec2::min).unwrap() - BOUND_PAD;
                let most = shown.into_iter().reduce(DVec2::max).unwrap() + BOUND_PAD;
                prop_assert_eq!((least, most), (bound.min, bound.max));
            }
        }
    }

    #[test]
    fn behind_the_near_plane_nothing_shows() {
        let prism = Prism {
            center: DVec3::new(0.0, 0.0, -1.0),
            half_axes: [DVec3::X, DVec3::Y],
            normal: DVec3::Z,
            low: 0.0,
            high: 0.5,
        };
        assert_eq!(bound(&prism, &eye(true, 0.05)), None);
        assert!(polygon_bound([DVec3::ZERO, DVec3::X, DVec3::Y], &eye(true, 0.05)).is_none());
    }
}
