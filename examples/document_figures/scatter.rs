//! Points scattered over a mesh.

use glam::{DVec3, Vec3};
use qsplat::analyse::canonical::mix;
use qsplat::model::mesh::Mesh;
use rayon::prelude::*;

/// Points on a surface with the normals of their triangles, in model units.
pub struct Scattered {
    /// Positions.
    pub points: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Area of the surface.
    pub area: f64,
}

/// Seed of the places.
const SEED: u64 = 0x9e37_79b9;

/// So many points, independent of one another and even over the area, the same on every run.
pub fn scatter(mesh: &Mesh, points: usize) -> Scattered {
    let mut area = 0.0;
    let ends: Vec<f64> = (0..mesh.triangles.len())
        .map(|triangle| {
            area += 0.5 * across(mesh.corners(triangle)).length();
            area
        })
        .collect();
    let random =
        |n: usize, which: u64| (mix(SEED ^ (3 * n as u64 + which)) >> 11) as f64 / (1_u64 << 53) as f64;
    let (points, normals) = (0..points)
        .into_par_iter()
        .map(|n| {
            let at = random(n, 0) * area;
            let triangle = ends.partition_point(|&end| end <= at).min(ends.len() - 1);
            let corners = mesh.corners(triangle);
            let [a, b, c] = corners.map(|corner| corner.as_dvec3());
            // Osada et al. 2002, section 3: even over a triangle.
            let (root, along) = (random(n, 1).sqrt(), random(n, 2));
            let place = (1.0 - root) * a + root * (1.0 - along) * b + root * along * c;
            (place.as_vec3(), across(corners).normalize_or(DVec3::Z).as_vec3())
        })
        .unzip();
    Scattered { points, normals, area }
}

/// Normal to a triangle, as long as twice its area.
fn across(corners: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    (b - a).cross(c - a)
}
