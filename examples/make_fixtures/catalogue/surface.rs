//! A triangle mesh that welds its vertices while it grows.

use std::collections::BTreeMap;

use glam::DVec3;

use super::curve::Curve;

/// Steps in one unit of the grid all coordinates lie on.
///
/// `2^22`: a coordinate within `[-1, 1]` is then exact in 32-bit floats, and points that two
/// neighbouring faces compute along different ways (some `1e-16` apart) become one.
const GRID: f64 = 4_194_304.0;

/// A point moved to the nearest grid point.
pub fn snap(point: DVec3) -> DVec3 {
    // Adding 0 turns -0 into 0, whose bits differ.
    DVec3::from_array(point.to_array().map(|x| libm::round(x * GRID) / GRID + 0.0))
}

/// Vertices and triangles; equal positions are one vertex.
#[derive(Default)]
pub struct Surface {
    /// Positions on the grid.
    pub positions: Vec<DVec3>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    known: BTreeMap<[u64; 3], u32>,
}

/// A mesh with its feature lines.
pub struct Model {
    /// The mesh.
    pub surface: Surface,
    /// Sharp edges and borders.
    pub lines: Vec<Curve>,
}

impl Surface {
    /// The vertex at a position, new or known.
    pub fn vertex(&mut self, position: DVec3) -> u32 {
        let position = snap(position);
        let key = position.to_array().map(f64::to_bits);
        let next = self.positions.len() as u32;
        *self.known.entry(key).or_insert_with(|| {
            self.positions.push(position);
            next
        })
    }

    /// A triangle; `flip` turns it over.
    pub fn triangle(&mut self, [a, b, c]: [u32; 3], flip: bool) {
        self.triangles.push(if flip { [a, c, b] } else { [a, b, c] });
    }
}
