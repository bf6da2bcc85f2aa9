//! Exact distance to a mesh, out to a reach.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3};
use qsplat::model::mesh::Mesh;

/// Cells along the longest side of the box.
const CELLS: f64 = 48.0;

/// A mesh's triangles in input units, by the cells of a grid that they reach into.
pub struct Facets {
    triangles: Vec<[DVec3; 3]>,
    cells: BTreeMap<[i32; 3], Vec<u32>>,
    cell: f64,
}

impl Facets {
    pub fn new(mesh: &Mesh) -> Self {
        let frame = mesh.vertices.frame;
        let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles.len())
            .map(|n| mesh.corners(n).map(|p| frame.to_input(p.as_dvec3())))
            .collect();
        let cell = 2.0 * frame.scale() / CELLS;
        let mut cells: BTreeMap<[i32; 3], Vec<u32>> = BTreeMap::new();
        for (n, [a, b, c]) in triangles.iter().enumerate() {
            // One cell more on all sides holds whatever lies within a cell of a place.
            let low = (a.min(*b).min(*c) / cell).floor().as_ivec3() - IVec3::ONE;
            let high = (a.max(*b).max(*c) / cell).floor().as_ivec3() + IVec3::ONE;
            for x in low.x..=high.x {
                for y in low.y..=high.y {
                    for z in low.z..=high.z {
                        cells.entry([x, y, z]).or_default().push(n as u32);
                    }
                }
            }
        }
        Self { triangles, cells, cell }
    }

    /// Distance to the mesh; infinite beyond `reach` where that is more than a cell.
    pub fn distance(&self, p: DVec3, reach: f64) -> f64 {
        let at = (p / self.cell).floor().as_ivec3().to_array();
        let near = self.cells.get(&at).map_or([].as_slice(), Vec::as_slice);
        let least =
            near.iter().map(|&n| to_triangle(&self.triangles[n as usize], p)).fold(f64::INFINITY, f64::min);
        if least <= self.cell {
            return least;
        }
        // Nothing within a cell: a fault for small reaches, a search over all for large ones.
        if reach <= self.cell {
            return f64::INFINITY;
        }
        self.triangles.iter().map(|triangle| to_triangle(triangle, p)).fold(f64::INFINITY, f64::min)
    }
}

/// Distance from a triangle: to its plane if the foot lies inside, else to a side.
fn to_triangle(&[a, b, c]: &[DVec3; 3], p: DVec3) -> f64 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if normal.length() > 0.0 && sides.iter().all(|&(from, to)| normal.dot((to - from).cross(p - from)) >= 0.0)
    {
        return ((p - a).dot(normal) / normal.length()).abs();
    }
    let to_side = |(from, to): (DVec3, DVec3)| {
        let (along, length) = (to - from, from.distance_squared(to));
        let t = if length > 0.0 { ((p - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        p.distance(from + t * along)
    };
    sides.into_iter().map(to_side).fold(f64::INFINITY, f64::min)
}
