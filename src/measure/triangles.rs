//! A mesh's triangles as a surface.

use glam::{DVec3, Vec3};

use super::box_tree::BoxTree;
use crate::model::mesh::Mesh;
use crate::model::triangle::to_triangle;

/// The triangles of a mesh, and a way to the nearest.
pub(super) struct Triangles<'a> {
    mesh: &'a Mesh,
    tree: BoxTree,
}

impl<'a> Triangles<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        let bounds = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
            Some((a.min(b).min(c), a.max(b).max(c)))
        };
        Self { mesh, tree: BoxTree::new((0..mesh.triangles.len()).map(bounds)) }
    }

    /// Distance from a point to the nearest triangle; `last` as for [`BoxTree::next_nearest`].
    pub(super) fn distance(&self, point: DVec3, last: &mut Option<(DVec3, f64)>) -> Option<f64> {
        let measure = |item, _: f64| {
            Some((to_triangle(self.mesh.corners(item as usize).map(Vec3::as_dvec3), point).length(), ()))
        };
        self.tree.next_nearest(point, last, measure).map(|found| found.distance)
    }

    /// The place of the mesh nearest to a point.
    pub(super) fn closest(&self, point: DVec3) -> Option<DVec3> {
        let measure = |item, _: f64| {
            let way = to_triangle(self.mesh.corners(item as usize).map(Vec3::as_dvec3), point);
            Some((way.length(), way))
        };
        self.tree.nearest(point, f64::INFINITY, measure).map(|found| point + found.place)
    }
}
