//! Smooth normals of a mesh that brings none, kept apart where it creases.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::model::mesh::Mesh;
use crate::model::places;

/// A vertex with more corners than this keeps its faces' own normals: the work grows with
/// the square, and the tip of such a fan has no normal worth the wait.
const MAX_CORNERS: usize = 4096;

/// Unit normals of each triangle's corners, in model coordinates.
///
/// The mean, weighted by the angle at the corner (Thürmer and Wüthrich 1998), over the faces
/// around the same position whose normal turns by at most `crease_degrees`. Zero for a
/// triangle without area.
#[must_use]
pub fn corner_normals(mesh: &Mesh, crease_degrees: f64) -> Vec<[Vec3; 3]> {
    let least = libm::cos(crease_degrees.to_radians());
    let faces: Vec<DVec3> = (0..mesh.triangles.len()).into_par_iter().map(|n| face_normal(mesh, n)).collect();
    let fans = Fans::of(mesh);
    let corner = |triangle: usize, vertex: u32| {
        let fan = fans.around(vertex);
        let own = faces[triangle];
        if fan.len() > MAX_CORNERS {
            return own.as_vec3();
        }
        let near = fan.iter().filter(|corner| faces[corner.triangle as usize].dot(own) >= least);
        let sum: DVec3 = near.map(|corner| corner.angle * faces[corner.triangle as usize]).sum();
        sum.try_normalize().unwrap_or(own).as_vec3()
    };
    mesh.triangles.par_iter().enumerate().map(|(n, vertices)| vertices.map(|v| corner(n, v))).collect()
}

/// Unit normal of a triangle, or zero without area.
fn face_normal(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle).map(|p| p.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero()
}

/// A triangle's corner at some position.
#[derive(Clone, Copy, Debug)]
struct Corner {
    triangle: u32,
    angle: f64,
}

/// The corners at each position; vertices that repeat a position share them.
struct Fans {
    /// Position number of each vertex.
    position: Vec<u32>,
    /// Where each position's corners begin, and the end.
    starts: Vec<u32>,
    corners: Vec<Corner>,
}

impl Fans {
    fn of(mesh: &Mesh) -> Self {
        let (position, count) = places::numbered(&mesh.vertices.positions);
        let mut starts = vec![0; count + 1];
        for vertex in mesh.triangles.as_flattened() {
            starts[position[*vertex as usize] as usize + 1] += 1;
        }
        for n in 0..count {
            starts[n + 1] += starts[n];
        }
        let mut next = starts.clone();
        let mut corners = vec![Corner { triangle: 0, angle: 0.0 }; 3 * mesh.triangles.len()];
        for (triangle, vertices) in mesh.triangles.iter().enumerate() {
            let points = mesh.corners(triangle).map(|p| p.as_dvec3());
            for side in 0..3 {
                let slot = &mut next[position[vertices[side] as usize] as usize];
                let angle = angle(points[side], points[(side + 1) % 3], points[(side + 2) % 3]);
                corners[*slot as usize] = Corner { triangle: triangle as u32, angle };
                *slot += 1;
            }
        }
        Self { position, starts, corners }
    }

    fn around(&self, vertex: u32) -> &[Corner] {
        let position = self.position[vertex as usize] as usize;
        &self.corners[self.starts[position] as usize..self.starts[position + 1] as usize]
    }
}

/// Angle at `a` between the ways to `b` and `c`, radians.
fn angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (b, c) = (b - a, c - a);
    libm::atan2(b.cross(c).length(), b.dot(c))
}
