//! The formula of a head-like closed surface without an edge: a sphere pushed along its rays.

use glam::DVec3;

/// Mean radius.
const RADIUS: f64 = 0.4;

/// Height over width.
const STRETCH: f64 = 1.25;

/// Bumps and dents: direction, height as a share of the radius, width (the bell's sigma, as a
/// distance on the unit sphere). The face looks along -y.
const BELLS: [([f64; 3], f64, f64); 9] = [
    ([0.36, -0.86, 0.22], -0.16, 0.17), // eye sockets
    ([-0.36, -0.86, 0.22], -0.16, 0.17),
    ([0.0, -0.99, 0.02], 0.20, 0.13),  // nose
    ([0.0, -0.9, -0.38], -0.06, 0.12), // mouth
    ([0.0, -0.75, -0.66], 0.12, 0.2),  // chin
    ([1.0, 0.0, 0.05], 0.10, 0.12),    // ears
    ([-1.0, 0.0, 0.05], 0.10, 0.12),
    ([0.0, 0.95, 0.3], 0.10, 0.5),   // back of the head
    ([0.0, 0.6, -0.8], -0.12, 0.35), // nape
];

/// Radius along a unit direction: smooth harmonics, then the bells.
fn radius(n: DVec3) -> f64 {
    let [x, y, z] = n.to_array();
    let harmonics = 0.05 * (3.0 * z * z - 1.0) / 2.0 - 0.04 * (x * x - y * y)
        + 0.03 * (x * x * x - 3.0 * x * z * z)
        + 0.02 * libm::sin(7.0 * z) * (1.0 - z * z);
    let bells = BELLS.iter().fold(0.0, |sum, (direction, height, width)| {
        let away = n.distance_squared(DVec3::from_array(*direction).normalize());
        sum + height * libm::exp(-away / (2.0 * width * width))
    });
    RADIUS * (1.0 + harmonics + bells)
}

/// The surface's point along a unit direction.
pub fn point(n: DVec3) -> DVec3 {
    radius(n) * n * DVec3::new(1.0, 1.0, STRETCH)
}
