//! Positions as decoded: their bounding box, and the way to model units.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::scalar::{Column, Rows};
use crate::model::frame::Frame;

/// Points a task takes on at a time.
const BLOCK: usize = 1 << 14;

/// Positions in 64 bits: in memory, or still in the bytes of the file.
///
/// Bulk data is widened twice, for the box and for the frame, instead of being kept widened:
/// touching 24 new bytes a point costs more than decoding them again.
#[derive(Debug)]
pub(super) enum Positions<'a> {
    Stored(Vec<DVec3>),
    Packed(Rows<'a>, [Column; 3]),
}

impl Default for Positions<'_> {
    fn default() -> Self {
        Self::Stored(Vec::new())
    }
}

impl Positions<'_> {
    pub fn len(&self) -> usize {
        match self {
            Self::Stored(points) => points.len(),
            Self::Packed(rows, _) => rows.count,
        }
    }

    pub fn extent(&self) -> Extent {
        match self {
            Self::Stored(points) => {
                let blocks = points.par_chunks(BLOCK);
                let blocks = blocks.map(|block| block.iter().fold(Extent::NONE, |all, &p| all.with(p)));
                blocks.reduce(|| Extent::NONE, Extent::join)
            }
            Self::Packed(rows, columns) => {
                rows.fold(columns, Extent::NONE, |all, p| all.with(DVec3::from_array(p)), Extent::join)
            }
        }
    }

    /// [`Frame::to_model`] of every point, rounded to 32 bits.
    pub fn to_model(&self, frame: Frame) -> Vec<Vec3> {
        // The same power of two as in `Frame::to_model`, taken out of the loop.
        let scale = libm::ldexp(1.0, -frame.exponent);
        let convert = |point: DVec3| ((point - frame.origin) * scale).as_vec3();
        match self {
            Self::Stored(points) => {
                let mut out: Vec<Vec3> = bytemuck::zeroed_vec(points.len());
                out.par_chunks_mut(BLOCK).zip(points.par_chunks(BLOCK)).for_each(|(out, points)| {
                    for (out, &point) in out.iter_mut().zip(points) {
                        *out = convert(point);
                    }
                });
                out
            }
            Self::Packed(rows, columns) => rows.gather(columns, |p| convert(DVec3::from_array(p))),
        }
    }

    pub fn into_stored(self) -> Vec<DVec3> {
        match self {
            Self::Stored(points) => points,
            Self::Packed(rows, columns) => rows.gather(&columns, DVec3::from_array),
        }
    }
}

/// Bounding box of the points whose coordinates are finite, and how many those are.
///
/// Least, greatest and count do not depend on the order of the points, nor on how the work is
/// split.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub min: DVec3,
    pub max: DVec3,
    pub finite: usize,
}

impl Extent {
    const NONE: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY, finite: 0 };

    fn with(self, point: DVec3) -> Self {
        if point.is_finite() {
            Self { min: self.min.min(point), max: self.max.max(point), finite: self.finite + 1 }
        } else {
            self
        }
    }

    fn join(self, other: Self) -> Self {
        let (min, max) = (self.min.min(other.min), self.max.max(other.max));
        Self { min, max, finite: self.finite + other.finite }
    }
}
