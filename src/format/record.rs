//! One splat as whole numbers, and what they stand for.

use glam::{DMat3, DVec2, DVec3};

use super::grid::{CELL_BIAS, Grids, Size, radius, rho_steps};
use super::{octahedral, turns};
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::splat::Splat;

/// A splat on the grids of [`Grids`].
///
/// Records are ordered field by field after the Morton order of their cells, so the order of
/// the fields here is part of what the encoder promises.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Record {
    /// Cell of the centre, biased by [`CELL_BIAS`].
    pub cell: [u32; 3],
    /// Place in the cell, `slide_bits` bits each.
    pub low: [u64; 3],
    /// The bits below, up to `height_bits`, along the fine axis.
    pub rise: u64,
    /// All steps but the clip's are divided by `2^fineness`.
    pub fineness: u8,
    /// How far the fine coordinate's axis is from the normal's dominant one (0, 1, 2; cyclic).
    pub turn: u8,
    /// Codes of the radii, the larger first.
    pub sizes: [Size; 2],
    /// The normal's lattice point.
    pub normal: [i64; 2],
    /// The sagittas `a r_u², b r_v²`.
    pub bend: [i64; 2],
    /// The turn of `i` about `k`, over half a turn.
    pub spin: u64,
    /// The clip curves: straight ones first, then by their numbers.
    pub clips: Vec<ClipRecord>,
    /// sRGB.
    pub color: [u8; 3],
}

/// A clip curve on the grids; `rho == 0` is a chord, whose `control` is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClipRecord {
    /// Steps of `rho`, 0 to [`rho_steps`].
    pub rho: u64,
    /// Border steps from the positive `u` axis to `P1`, in eccentric angle.
    pub start: u64,
    /// Border steps from `P1` on to `P3`, at least 1 and less than a whole turn.
    pub sweep: u64,
    /// `P2` from the middle of the chord, along and to the left of it, in clip steps.
    pub control: [i64; 2],
}

impl Grids {
    /// The axis whose coordinate is fine.
    #[must_use]
    pub fn axis(&self, record: &Record) -> usize {
        (octahedral::dominant(self.normal(record)) + usize::from(record.turn)) % 3
    }

    /// `k`.
    #[must_use]
    pub fn normal(&self, record: &Record) -> DVec3 {
        octahedral::decode(record.normal, self.normal_steps(record.sizes[0], record.fineness))
    }

    /// Radii, model units.
    #[must_use]
    pub fn radii(&self, sizes: [Size; 2]) -> DVec2 {
        DVec2::new(radius(sizes[0]) * self.budget, radius(sizes[1]) * self.budget)
    }

    /// One coordinate: `bits` binary places below the cell.
    #[must_use]
    pub fn coordinate(&self, cell: u32, low: u64, bits: u32) -> f64 {
        let whole = i64::from(cell) - CELL_BIAS;
        // At most 28 bits of cell and 24 of place: exact, so only the product rounds.
        (whole as f64 + low as f64 * libm::ldexp(1.0, -(bits as i32))) * self.cell()
    }

    /// The corner of a record's cell, model units.
    #[must_use]
    pub fn cell_corner(&self, record: &Record) -> DVec3 {
        DVec3::from_array(record.cell.map(|cell| self.coordinate(cell, 0, 0)))
    }

    /// The centre without the bits of its fine axis, model units.
    #[must_use]
    pub fn coarse_center(&self, record: &Record) -> DVec3 {
        let bits = self.slide_bits(record.sizes[1], record.fineness);
        DVec3::from_array([0, 1, 2].map(|n| self.coordinate(record.cell[n], record.low[n], bits)))
    }

    /// The splat a record stands for.
    #[must_use]
    pub fn splat(&self, record: &Record) -> Splat {
        let k = self.normal(record);
        let axis = self.axis(record);
        let slide = self.slide_bits(record.sizes[1], record.fineness);
        let height = self.height_bits(record.fineness);
        let center = [0, 1, 2].map(|n| {
            let (place, bits) = if n == axis {
                (record.low[n] << (height - slide) | record.rise, height)
            } else {
                (record.low[n], slide)
            };
            self.coordinate(record.cell[n], place, bits)
        });
        let spin_bits = self.spin_bits(record.sizes, record.bend, record.fineness);
        let (sin, cos) = turns::sin_cos(record.spin, 2 << spin_bits);
        let (i, j) = octahedral::basis(k);
        let radii = self.radii(record.sizes);
        let step = self.bend(record.fineness) * self.budget;
        Splat {
            center: DVec3::from_array(center),
            axes: DMat3::from_cols(cos * i + sin * j, cos * j - sin * i, k),
            radii,
            curvature: DVec2::new(record.bend[0] as f64 * step, record.bend[1] as f64 * step)
                / (radii * radii),
            clips: record.clips.iter().map(|clip| self.clip_curve(clip, record.sizes)).collect(),
            partners: Vec::new(),
            color: record.color,
        }
    }

    /// A border point by its step, in the splat's plane.
    #[must_use]
    pub fn border(&self, step: u64, sizes: [Size; 2]) -> DVec2 {
        let (sin, cos) = turns::sin_cos(step, self.border_steps(sizes[0]));
        self.radii(sizes) * DVec2::new(cos, sin)
    }

    /// The ends of the clip curve a record stands for, in the splat's plane.
    #[must_use]
    pub fn ends(&self, clip: &ClipRecord, sizes: [Size; 2]) -> [DVec2; 2] {
        let end = (clip.start + clip.sweep) % self.border_steps(sizes[0]);
        [self.border(clip.start, sizes), self.border(end, sizes)]
    }

    /// The clip curve a record stands for, in the splat's plane; a chord has its middle for `P2`.
    #[must_use]
    pub fn conic(&self, clip: &ClipRecord, sizes: [Size; 2]) -> Conic {
        let [p1, p3] = self.ends(clip, sizes);
        let middle = 0.5 * (p1 + p3);
        if clip.rho == 0 {
            return Conic { p1, p2: middle, p3, rho: 0.0 };
        }
        let [along, across] = chord_frame(p1, p3);
        let [x, y] = clip.control.map(|steps| steps as f64);
        let p2 = middle + (x * along + y * across) * self.clip();
        Conic { p1, p2, p3, rho: clip.rho as f64 / rho_steps(clip.control) as f64 }
    }

    /// The same as a splat holds it.
    #[must_use]
    pub fn clip_curve(&self, clip: &ClipRecord, sizes: [Size; 2]) -> ClipCurve {
        let Conic { p1, p2, p3, rho } = self.conic(clip, sizes);
        let (alpha1, alpha3) = (central_angle(p1), central_angle(p3));
        if clip.rho == 0 { ClipCurve::chord(alpha1, alpha3) } else { ClipCurve { alpha1, alpha3, p2, rho } }
    }
}

/// Unit vectors along a chord and to the left of it. Not finite where its ends are one.
#[must_use]
pub fn chord_frame(p1: DVec2, p3: DVec2) -> [DVec2; 2] {
    let chord = p3 - p1;
    let length = (chord.x * chord.x + chord.y * chord.y).sqrt();
    let along = DVec2::new(chord.x / length, chord.y / length);
    [along, DVec2::new(-along.y, along.x)]
}

/// The angle of a point seen from the centre, in `[0, 2π)`.
#[must_use]
pub fn central_angle(point: DVec2) -> f64 {
    let angle = libm::atan2(point.y, point.x);
    let positive = if angle < 0.0 { angle + std::f64::consts::TAU } else { angle };
    if positive < std::f64::consts::TAU { positive } else { 0.0 }
}
