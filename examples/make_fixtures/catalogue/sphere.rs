//! Spheres: a mesh, a cloud without normals, a small mesh with colours.

use glam::DVec3;

use super::geodesic::geodesic;
use super::surface::{Surface, snap};

const RADIUS: f64 = 0.5;

/// Points of the cloud.
const POINTS: usize = 20_000;

/// Turn from one point of the spiral to the next, radians: `π (3 - sqrt 5)`.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// A geodesic sphere.
pub fn mesh() -> Surface {
    geodesic(18, |direction| RADIUS * direction)
}

/// A Fibonacci spiral: bands of equal area, turned by the golden angle.
pub fn cloud() -> Vec<DVec3> {
    (0..POINTS)
        .map(|n| {
            let z = 1.0 - (2.0 * n as f64 + 1.0) / POINTS as f64;
            let (sin, cos) = libm::sincos(n as f64 * GOLDEN_ANGLE);
            let ring = libm::sqrt(1.0 - z * z);
            snap(RADIUS * DVec3::new(ring * cos, ring * sin, z))
        })
        .collect()
}

/// A geodesic sphere whose colour is its normal, `round(255 (n + 1)/2)` a channel.
pub fn colored() -> (Surface, Vec<[u8; 3]>) {
    let surface = geodesic(12, |direction| RADIUS * direction);
    let colors = surface
        .positions
        .iter()
        .map(|p| (*p / RADIUS).to_array().map(|n| libm::round(127.5 * (n + 1.0)) as u8))
        .collect();
    (surface, colors)
}
