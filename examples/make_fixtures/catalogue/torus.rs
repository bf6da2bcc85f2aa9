//! A torus around the z axis: a mesh, and a cloud with normals.

use std::f64::consts::TAU;

use glam::DVec3;

use super::ruled::quad;
use super::surface::{Surface, snap};

/// Radius of the tube's centre line.
const MAJOR: f64 = 0.35;
/// Radius of the tube.
const MINOR: f64 = 0.15;

/// Points of the cloud.
const POINTS: usize = 8_000;

/// One over the golden ratio: its multiples fill the unit interval most evenly.
const GOLDEN_FRACTION: f64 = 0.618_033_988_749_894_9;

/// Newton steps for the tube's angle. The slope is at least `1 - r/R`, so a few are plenty; the
/// number is fixed to keep the result free of a tolerance.
const NEWTON_STEPS: usize = 12;

/// The point at the angles around the axis and around the tube, and its normal.
fn point(major: f64, minor: f64, around: f64, tube: f64) -> (DVec3, DVec3) {
    let ((sin_a, cos_a), (sin_t, cos_t)) = (libm::sincos(around), libm::sincos(tube));
    let outward = DVec3::new(cos_a, sin_a, 0.0);
    let normal = cos_t * outward + sin_t * DVec3::Z;
    (major * outward + minor * normal, normal)
}

/// A grid of quads, closed both ways.
pub fn grid(major: f64, minor: f64, around: usize, tube: usize) -> Surface {
    let mut surface = Surface::default();
    let mut vertex = |a: usize, t: usize| {
        let angle = |n: usize, of: usize| TAU * ((n % of) as f64 / of as f64);
        surface.vertex(point(major, minor, angle(a, around), angle(t, tube)).0)
    };
    let mut quads = Vec::with_capacity(around * tube);
    for a in 0..around {
        for t in 0..tube {
            quads.push(([vertex(a, t), vertex(a + 1, t), vertex(a + 1, t + 1), vertex(a, t + 1)], a + t));
        }
    }
    for (corners, parity) in quads {
        quad(&mut surface, corners, parity, false);
    }
    surface
}

/// The mesh.
pub fn mesh() -> Surface {
    grid(MAJOR, MINOR, 76, 36)
}

/// Points evenly over the area, and their normals.
///
/// The area up to the tube's angle `t` grows as `t + (r/R) sin t`, which Newton inverts.
pub fn cloud() -> (Vec<DVec3>, Vec<DVec3>) {
    let ratio = MINOR / MAJOR;
    (0..POINTS)
        .map(|n| {
            let share = TAU * ((n as f64 + 0.5) / POINTS as f64);
            let mut tube = share;
            for _ in 0..NEWTON_STEPS {
                let (sin, cos) = libm::sincos(tube);
                tube -= (tube + ratio * sin - share) / (1.0 + ratio * cos);
            }
            let turns = n as f64 * GOLDEN_FRACTION;
            let (place, normal) = point(MAJOR, MINOR, TAU * (turns - libm::floor(turns)), tube);
            (snap(place), normal)
        })
        .unzip()
}
