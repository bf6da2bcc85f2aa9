//! A triangle mesh as it was read.

use glam::Vec3;

use super::cloud::Cloud;

/// Triangles over the points of a [`Cloud`].
///
/// Vertices are as in the file: seams may repeat a position. Polygons are fanned into
/// triangles; faces that use a dropped vertex, or one place twice, are left out and counted. Faces that
/// join two by two at an edge face alike: those that did not were turned and counted.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The vertices and their attributes.
    pub vertices: Cloud,
    /// Triangles, counter-clockwise seen from outside; every index is below the vertex count.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles left out on reading because they are degenerate or used a dropped vertex.
    pub dropped: usize,
    /// Triangles turned on reading because they faced the other way than most of the surface they belong to.
    pub turned: usize,
}

impl Mesh {
    /// The three corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.vertices.positions[v as usize])
    }
}
