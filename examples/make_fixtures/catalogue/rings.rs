//! Two linked rings as glTF: one coloured mesh, used by two nodes below a scaled one.

use std::f64::consts::TAU;

use super::glb::{Node, Scene};
use super::torus::grid;

const MAJOR: f64 = 0.6;
const MINOR: f64 = 0.15;

/// A quarter turn around the x axis, as a quaternion `x y z w`.
const QUARTER_TURN: [f64; 4] = [0.5 * std::f64::consts::SQRT_2, 0.0, 0.0, 0.5 * std::f64::consts::SQRT_2];

/// The file.
///
/// In the world the rings have radii 0.3 and 0.075: one lies around `(-0.15, 0, 0)` in the xy
/// plane, the other around `(0.15, 0, 0)` in the xz plane. The colour goes once around the ring.
pub fn glb() -> Vec<u8> {
    let mesh = grid(MAJOR, MINOR, 48, 16);
    let colors: Vec<[u8; 4]> = mesh
        .positions
        .iter()
        .map(|p| {
            let hue = libm::atan2(p.y, p.x);
            let channel = |shift: f64| libm::round(127.5 * (1.0 + libm::cos(hue - shift * TAU / 3.0))) as u8;
            [channel(0.0), channel(1.0), channel(2.0), 255]
        })
        .collect();
    let nodes = [
        Node { name: "lying", translation: [-0.3, 0.0, 0.0], rotation: [0.0, 0.0, 0.0, 1.0] },
        Node { name: "standing", translation: [0.3, 0.0, 0.0], rotation: QUARTER_TURN },
    ];
    Scene { mesh: &mesh, colors: &colors, nodes: &nodes, scale: 0.5 }.to_bytes()
}
