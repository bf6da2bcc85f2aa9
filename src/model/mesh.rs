//! A triangle mesh as it was read.

use glam::Vec3;

use super::cloud::Cloud;

/// Triangles over the points of a [`Cloud`].
///
/// Vertices are as in the file: seams may repeat a position. Polygons are fanned into
/// triangles; faces that use a dropped vertex, or one vertex twice, are left out and counted.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The vertices and their attributes.
    pub vertices: Cloud,
    /// Triangles, counter-clockwise seen from outside; every index is below the vertex count.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles left out on reading because they are degenerate or used a dropped vertex.
    pub dropped: usize,
}

impl Mesh {
    /// The three corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.vertices.positions[v as usize])
    }
}
