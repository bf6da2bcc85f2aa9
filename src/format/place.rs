//! Puts a splat on the grids: slides its centre, rounds normal, sagittas and turn.

use glam::{DVec2, DVec3};

use super::grid::{CELL_BIAS, Size};
use super::octahedral;
use super::quantize::Quantizer;
use super::record::Record;
use super::walk::MAX_BEND;
use crate::model::splat::Splat;

/// Newton steps of the slide; it converges quadratically from a start within `r/30`.
const SLIDE_STEPS: usize = 8;

/// The slide has converged when a step moves less than this part of a grid step.
const SLIDE_DONE: f64 = 1e-9;

/// Which numbers are rounded to the farther of their two neighbours instead of the nearer.
///
/// Errors add up or cancel: a centre that came out too high and a sagitta that came out too
/// low make up for each other. Where rounding all to the nearest breaks the bound, another way
/// mostly keeps it, at no cost in bytes; the slide comes last, since it costs some radius.
#[derive(Clone, Copy, Debug)]
pub struct Nudge(pub u8);

impl Nudge {
    /// The first sagitta.
    const BEND_U: u8 = 1;
    /// The second sagitta.
    const BEND_V: u8 = 2;
    /// The coordinate along the fine axis.
    const RISE: u8 = 4;
    /// The next coordinate.
    const SLIDE_P: u8 = 8;
    /// The one after.
    const SLIDE_Q: u8 = 16;
    /// All combinations.
    pub const WAYS: u8 = 32;

    /// A value rounded for one of the bits above. A whole number stays what it is.
    fn round(self, value: f64, bit: u8) -> f64 {
        let nearest = value.round();
        if self.0 & bit == 0 {
            nearest
        } else if value > nearest {
            nearest + 1.0
        } else if value < nearest {
            nearest - 1.0
        } else {
            nearest
        }
    }
}

impl Quantizer {
    /// Rounds all but the clip curves, with the fine coordinate along an axis.
    ///
    /// `None` when the surface does not pass the grid point or a number is out of range.
    pub(super) fn place(
        &self,
        splat: &Splat,
        sizes: [Size; 2],
        fineness: u8,
        axis: usize,
        nudge: Nudge,
    ) -> Option<Record> {
        let grids = &self.grids;
        let mut record = Record { fineness, sizes, color: splat.color, ..Record::default() };
        let (across, point) = self.slide(splat, grids.slide_bits(sizes[1], fineness), axis, nudge)?;
        self.put(&mut record, point, axis, nudge)?;
        let slope = -2.0 * splat.curvature * across;
        let normal = (splat.axes * slope.extend(1.0)).normalize();
        record.normal = octahedral::encode(normal, grids.normal_steps(sizes[0], fineness));
        let k = grids.normal(&record);
        record.turn = ((axis + 3 - octahedral::dominant(k)) % 3) as u8;
        let radii = grids.radii(sizes);
        let bend = splat.curvature * radii * radii / (grids.bend(fineness) * grids.budget);
        let bend = [nudge.round(bend.x, Nudge::BEND_U), nudge.round(bend.y, Nudge::BEND_V)];
        if bend.iter().any(|steps| steps.abs() > MAX_BEND as f64) {
            return None;
        }
        record.bend = bend.map(|steps| steps as i64);
        record.spin = spin(splat.axes.x_axis, k, grids.spin_bits(sizes, record.bend, fineness));
        Some(record)
    }

    /// Sets cell, place and rise.
    fn put(&self, record: &mut Record, point: DVec3, axis: usize, nudge: Nudge) -> Option<()> {
        let slide_bits = self.grids.slide_bits(record.sizes[1], record.fineness);
        let height_bits = self.grids.height_bits(record.fineness);
        for n in 0..3 {
            let bits = if n == axis { height_bits } else { slide_bits };
            let scale = libm::ldexp(1.0, bits as i32);
            let steps = point[n] / self.grids.cell() * scale;
            let steps = if n == axis { nudge.round(steps, Nudge::RISE) } else { steps.round() };
            let cell = (steps / scale).floor();
            // Written so that a NaN is refused.
            let in_range = cell >= -(CELL_BIAS as f64) && cell < CELL_BIAS as f64;
            if !in_range {
                return None;
            }
            record.cell[n] = (cell as i64 + CELL_BIAS) as u32;
            let place = (steps - cell * scale) as u64;
            record.low[n] = place >> (bits - slide_bits);
            if n == axis {
                record.rise = place & ((1 << (bits - slide_bits)) - 1);
            }
        }
        Some(())
    }

    /// Where the surface passes the grid point nearest to the centre: `(u, v)` and the point.
    ///
    /// The two coordinates across `axis` are rounded to the slide's grid; Newton's method
    /// finds the surface point that has them. `None` when it does not converge.
    fn slide(&self, splat: &Splat, bits: u32, axis: usize, nudge: Nudge) -> Option<(DVec2, DVec3)> {
        let step = self.grids.cell() * libm::ldexp(1.0, -(bits as i32));
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        let way = |n: usize| if n == p { Nudge::SLIDE_P } else { Nudge::SLIDE_Q };
        let target = |n: usize| nudge.round(splat.center[n] / step, way(n)) * step;
        let rows = splat.axes.transpose();
        let mut across = DVec2::ZERO;
        for _ in 0..SLIDE_STEPS {
            let point = splat.surface_point(across);
            let miss = DVec2::new(target(p) - point[p], target(q) - point[q]);
            let slope = 2.0 * splat.curvature * across;
            let gradient = |n: usize| rows.col(n).truncate() + slope * rows.col(n).z;
            let (gp, gq) = (gradient(p), gradient(q));
            let det = gp.perp_dot(gq);
            let move_by = DVec2::new(miss.x * gq.y - miss.y * gp.y, miss.y * gp.x - miss.x * gq.x) / det;
            across += move_by;
            if move_by.length() <= SLIDE_DONE * step {
                let mut point = splat.surface_point(across);
                (point[p], point[q]) = (target(p), target(q));
                return Some((across, point));
            }
        }
        None
    }
}

/// The turn of `i` about `k` in steps of half a turn over `2^bits`.
fn spin(i: DVec3, k: DVec3, bits: u32) -> u64 {
    let (i0, j0) = octahedral::basis(k);
    let half_turns = libm::atan2(i.dot(j0), i.dot(i0)) / std::f64::consts::PI;
    let steps = (half_turns * libm::ldexp(1.0, bits as i32)).round() as i64;
    steps.rem_euclid(1 << bits) as u64
}
