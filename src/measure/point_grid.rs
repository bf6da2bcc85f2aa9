//! Points sorted into cells, to find those within a box.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Points a cell that a surface passes holds, about: few enough that boxes are met tightly,
/// many enough that searching for a row of cells costs little beside its points.
const POINTS_A_CELL: f64 = 8.0;

/// A uniform grid over points in `[-1, 1]³`.
pub(super) struct PointGrid {
    cell: f64,
    /// `(code of the cell, point)`, sorted; the cells of a row along z lie together.
    places: Vec<(u64, u32)>,
}

impl PointGrid {
    pub(super) fn new(points: &[Vec3]) -> Self {
        // A surface of area about 4 spread evenly over the cells it passes.
        let cell = (4.0 * POINTS_A_CELL / points.len().max(1) as f64).sqrt();
        let mut places: Vec<_> = points
            .par_iter()
            .enumerate()
            .map(|(n, p)| (code(cell_of(p.as_dvec3(), cell)), n as u32))
            .collect();
        places.par_sort_unstable();
        Self { cell, places }
    }

    /// The points of all cells that a box meets.
    pub(super) fn near(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = u32> + '_ {
        let (low, high) = (cell_of(low, self.cell), cell_of(high, self.cell));
        (low[0]..=high[0]).flat_map(move |x| {
            (low[1]..=high[1]).flat_map(move |y| {
                let from = self.places.partition_point(|(cell, _)| *cell < code([x, y, low[2]]));
                let row =
                    self.places[from..].iter().take_while(move |(cell, _)| *cell <= code([x, y, high[2]]));
                row.map(|&(_, point)| point)
            })
        })
    }
}

/// One number for a cell, that orders cells by x, then y, then z: coordinates are far below
/// 2²⁰ in size, since even 2³² points make no more cells a side than that.
fn code(cell: [i32; 3]) -> u64 {
    let shifted = cell.map(|x| (i64::from(x) + (1 << 20)) as u64);
    shifted[0] << 42 | shifted[1] << 21 | shifted[2]
}

fn cell_of(point: DVec3, cell: f64) -> [i32; 3] {
    // Boxes may reach outside the model; they are cut to what can hold points.
    (point.clamp(DVec3::splat(-1.5), DVec3::splat(1.5)) / cell).floor().as_ivec3().to_array()
}
