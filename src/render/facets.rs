//! A mesh before a camera: its triangles, exactly.

use glam::{DVec2, DVec3};

use super::eye::{Eye, Ray};
use super::input::color;
use super::mesh_normals::MeshNormals;
use super::project::{self, Bound};
use super::tiles::{Hit, Look, Scene};
use crate::model::mesh::Mesh;

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
        project::triangle_bound(self.corners(item), self.eye)
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
