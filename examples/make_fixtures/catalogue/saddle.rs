//! The monkey saddle `z = x³ - 3 x y²` over a disc: flat to second order at its centre, so
//! that no quadric fits it there.

use std::f64::consts::TAU;

use glam::DVec3;

use super::curve::Curve;
use super::surface::{Model, Surface, snap};

const RADIUS: f64 = 0.5;

/// Rings around the centre; ring `n` has `6 n` points.
const RINGS: usize = 30;

/// Point `n` of a ring.
fn point(ring: usize, n: usize) -> DVec3 {
    let points = 6 * ring.max(1);
    let (sin, cos) = libm::sincos(TAU * ((n % points) as f64 / points as f64));
    let r = RADIUS * (ring as f64 / RINGS as f64);
    let (x, y) = (r * cos, r * sin);
    DVec3::new(x, y, x * x * x - 3.0 * x * y * y)
}

/// The open mesh and its border.
pub fn model() -> Model {
    let mut surface = Surface::default();
    for ring in 1..=RINGS {
        // Sector by sector: `ring` edges outside face `ring - 1` edges inside.
        for sector in 0..6 {
            for n in 0..ring {
                let outer = sector * ring + n;
                let inner = sector * (ring - 1) + n;
                let [a, b, c, d] = [
                    point(ring, outer),
                    point(ring, outer + 1),
                    point(ring - 1, inner),
                    point(ring - 1, inner + 1),
                ]
                .map(|p| surface.vertex(p));
                surface.triangle([a, b, c], false);
                if n + 1 < ring {
                    surface.triangle([c, b, d], false);
                }
            }
        }
    }
    let border: Curve = (0..=6 * RINGS).map(|n| snap(point(RINGS, n))).collect();
    Model { surface, lines: vec![border] }
}
