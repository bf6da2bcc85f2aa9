//! The normals that a mesh is shaded with.

use glam::{DVec3, Vec3};

use super::input::{Normals, given_normal};
use super::smooth;
use crate::model::mesh::Mesh;
use crate::tolerance::DEFAULT_EDGE_ANGLE;

/// A mesh's shading normals, in model coordinates.
pub struct MeshNormals<'a> {
    mesh: &'a Mesh,
    /// Of each triangle's corners; empty where the file's or the faces' serve.
    corners: Vec<[Vec3; 3]>,
    normals: Normals,
}

impl<'a> MeshNormals<'a> {
    /// Works them out.
    #[must_use]
    pub fn new(mesh: &'a Mesh, normals: Normals) -> Self {
        let corners = match normals {
            Normals::Given if !mesh.vertices.normals.is_empty() => Vec::new(),
            Normals::Given => smooth::corner_normals(mesh, DEFAULT_EDGE_ANGLE),
            Normals::Crease(degrees) => smooth::corner_normals(mesh, degrees),
            Normals::Flat => Vec::new(),
        };
        Self { mesh, corners, normals }
    }

    /// The smooth unit normals of a triangle's corners; `None` where its own serves.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> Option<[DVec3; 3]> {
        if let Some(corners) = self.corners.get(triangle) {
            return Some(corners.map(Vec3::as_dvec3));
        }
        if self.normals == Normals::Flat {
            return None;
        }
        let [a, b, c] = self.mesh.triangles[triangle].map(|v| given_normal(&self.mesh.vertices, v as usize));
        Some([a?, b?, c?])
    }

    /// The unit normal at a place given by its shares of a triangle's corners, blended as a
    /// picture blends it; zero only where the triangle has no area.
    #[must_use]
    pub fn at(&self, triangle: usize, weights: DVec3) -> DVec3 {
        let blend = |n: [DVec3; 3]| (weights.x * n[0] + weights.y * n[1] + weights.z * n[2]).try_normalize();
        self.corners(triangle).and_then(blend).unwrap_or_else(|| {
            let [a, b, c] = self.mesh.corners(triangle).map(Vec3::as_dvec3);
            (b - a).cross(c - a).normalize_or_zero()
        })
    }
}
