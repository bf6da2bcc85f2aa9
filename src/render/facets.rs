//! A mesh before a camera: its triangles, exactly.

use glam::{DVec2, DVec3};

use super::eye::{Eye, Ray};
use super::input::{Met, color};
use super::mesh_normals::MeshNormals;
use super::project::{self, Bound};
use super::slivers::Slivers;
use super::tiles::{self, Hit, Look, Rect, Scene};
use crate::model::mesh::Mesh;

/// Bounds of up to so many samples are not worth halving.
const SMALL: u32 = 64;

/// Two bounds for one are worth their while where they hold less than this share of its samples.
const WORTH: f64 = 0.75;

/// A mesh before a camera.
pub(super) struct Facets<'a> {
    mesh: &'a Mesh,
    eye: &'a Eye,
    /// Vertices in view coordinates.
    places: Vec<DVec3>,
    normals: &'a MeshNormals<'a>,
}

impl<'a> Facets<'a> {
    /// Places a mesh before an eye.
    pub(super) fn new(mesh: &'a Mesh, eye: &'a Eye, normals: &'a MeshNormals<'a>) -> Self {
        let places = mesh.vertices.positions.iter().map(|p| eye.to_view(p.as_dvec3())).collect();
        Self { mesh, eye, places, normals }
    }

    /// What rays meet, and the pixels of what slips between them.
    pub(super) fn met(&self) -> Met {
        let surely = tiles::depths(self, self.eye);
        let met = surely.iter().map(|depth| depth.is_finite()).collect();
        let mut slivers = Slivers::beside(met, self.eye.size);
        for item in 0..self.len() {
            if let Some(polygon) = project::triangle(self.corners(item), self.eye) {
                slivers.add(&polygon);
            }
        }
        Met { surely, perhaps: slivers.touched() }
    }

    fn corners(&self, item: usize) -> [DVec3; 3] {
        self.mesh.triangles[item].map(|vertex| self.places[vertex as usize])
    }

    /// The smooth normals of a triangle's corners, in view coordinates.
    fn smooth(&self, item: usize) -> Option<[DVec3; 3]> {
        Some(self.normals.corners(item)?.map(|normal| self.eye.turn(normal)))
    }
}

impl Scene for Facets<'_> {
    fn len(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn bound(&self, item: usize) -> Option<Bound> {
        project::polygon_bound(self.corners(item), self.eye)
    }

    fn bounds(&self, item: usize, visit: &mut dyn FnMut(&Bound)) {
        visit_bounds(from_tip(self.corners(item)), self.eye, visit);
    }

    /// Woop, Benthin and Wald 2013: in the plane across the ray an edge's area is the same
    /// number, but for its sign, for both triangles beside it, so no ray slips between them.
    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit> {
        let corners = self.corners(item);
        let [a, b, c] = corners.map(|p| p.truncate() - ray.at(p.z));
        let (wa, wb, wc) = (c.perp_dot(b), a.perp_dot(c), b.perp_dot(a));
        let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
        let total = wa + wb + wc;
        if !inside || total == 0.0 {
            return None;
        }
        let at = DVec2::new(wb, wc) / total;
        let depth =
            corners[0].z + at.x * (corners[1].z - corners[0].z) + at.y * (corners[2].z - corners[0].z);
        (depth >= self.eye.near).then_some(Hit { depth, at, ellipse: 0.0, gives_way: 0.0 })
    }

    fn look(&self, item: usize, at: DVec2) -> Look {
        let weights = [1.0 - at.x - at.y, at.x, at.y];
        let [a, b, c] = self.corners(item);
        let flat = (b - a).cross(c - a).normalize_or_zero();
        let blend =
            |n: [DVec3; 3]| (weights[0] * n[0] + weights[1] * n[1] + weights[2] * n[2]).try_normalize();
        let normal = self.smooth(item).and_then(blend).unwrap_or(flat);
        let colors = self.mesh.triangles[item].map(|vertex| color(&self.mesh.vertices, vertex as usize));
        let color = (0..3).map(|n| weights[n] as f32 * colors[n]).sum();
        Look { normal, color }
    }
}

/// A triangle as a quadrilateral whose first and last corners are one: that across its shortest side as the
/// picture shows it.
fn from_tip([a, b, c]: [DVec3; 3]) -> [DVec3; 4] {
    let turns = [[a, b, c], [b, c, a], [c, a, b]];
    let across = |turn: &[DVec3; 3]| turn[1].truncate().distance_squared(turn[2].truncate());
    let [tip, b, c] =
        turns.into_iter().min_by(|one, other| across(one).total_cmp(&across(other))).unwrap_or([a, b, c]);
    [tip, b, c, tip]
}

/// Visits the bounds of parts of a quadrilateral, cut across its first side and its third: a slender one that
/// lies aslant fills little of its own, and half as much of those of its two halves.
fn visit_bounds(corners: [DVec3; 4], eye: &Eye, visit: &mut dyn FnMut(&Bound)) {
    let Some(bound) = project::polygon_bound(corners, eye) else { return };
    let samples = |bound: &Bound| Rect::of(bound, eye.size).count();
    if samples(&bound) > SMALL {
        let [a, b, c, d] = corners;
        let middles = [0.5 * (a + b), 0.5 * (c + d)];
        let halves = [[a, middles[0], middles[1], d], [middles[0], b, c, middles[1]]];
        let bounds = halves.map(|half| project::polygon_bound(half, eye));
        let fewer = bounds.iter().flatten().map(samples).sum::<u32>();
        if f64::from(fewer) < WORTH * f64::from(samples(&bound)) {
            halves.into_iter().for_each(|half| visit_bounds(half, eye, visit));
            return;
        }
    }
    visit(&bound);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::Vec3;

    use super::*;
    use crate::model::cloud::Cloud;
    use crate::model::frame::Frame;
    use crate::render::Camera;
    use crate::render::camera::Projection;
    use crate::render::input::Normals;

    /// A fan of slender triangles, as the flat end of a turned part has.
    fn fan() -> Mesh {
        const SIDES: u32 = 90;
        let rim = (0..SIDES).map(|n| libm::sincos(f64::from(n) / f64::from(SIDES) * std::f64::consts::TAU));
        let rim = rim.map(|(sin, cos)| DVec3::new(cos, sin, 0.1 * cos).as_vec3());
        let positions = std::iter::once(Vec3::ZERO).chain(rim).collect();
        let triangles = (0..SIDES).map(|n| [0, 1 + n, 1 + (n + 1) % SIDES]).collect();
        Mesh { vertices: Cloud { positions, ..Cloud::default() }, triangles, ..Mesh::default() }
    }

    #[test]
    fn bounds_of_parts_hold_fewer_samples_and_every_hit() {
        let mesh = fan();
        let normals = MeshNormals::new(&mesh, Normals::Flat);
        // The last eye is so near that triangles reach behind it: they are not as slender in its picture.
        let views = [
            ([1.0, 2.0, 3.0], Projection::Orthographic { height: 2.5 }, 0.5),
            ([1.0, 2.0, 3.0], Projection::Perspective { fov_degrees: 40.0 }, 0.5),
            ([0.1, 0.1, 0.2], Projection::Perspective { fov_degrees: 90.0 }, 0.9),
        ];
        for (eye, projection, share) in views {
            let camera = Camera { eye, target: [0.0; 3], up: [0.0, 1.0, 0.0], projection, near: Some(0.01) };
            let eye = Eye::new(&camera, &Frame::default(), [200, 200]).unwrap();
            let scene = Facets::new(&mesh, &eye, &normals);
            let rays = (0..200).flat_map(|y| (0..200).map(move |x| [x, y]));
            let nearest = |sample| {
                let hits = (0..scene.len()).filter_map(|item| scene.hit(item, &eye.ray_through(sample)));
                hits.map(|hit| hit.depth).fold(f64::INFINITY, f64::min)
            };
            let truth: Vec<f64> = rays.map(nearest).collect();
            assert!(truth.iter().filter(|depth| depth.is_finite()).count() > 5000);
            assert_eq!(tiles::depths(&scene, &eye), truth);
            let samples = |bound: &Bound| Rect::of(bound, eye.size).count();
            let (mut whole, mut parts) = (0, 0);
            for item in 0..scene.len() {
                whole += samples(&scene.bound(item).unwrap());
                scene.bounds(item, &mut |bound| parts += samples(bound));
            }
            assert!(f64::from(parts) < share * f64::from(whole), "{parts} samples of {whole}");
        }
    }
}
