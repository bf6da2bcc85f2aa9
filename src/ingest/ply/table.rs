//! What the bodies hand over: columns of numbers, and triangles.

use bytemuck::Zeroable;
use glam::DVec3;

use super::super::faces::{self, Shape};
use super::super::positions::Positions;
use super::super::scalar::{Column, NATIVE, Rows, Scalar};
use super::super::source::Source;
use crate::error::{Error, Result};

/// Where the corners of a list go.
pub(super) struct Target<'a> {
    pub shape: Shape,
    pub vertices: u32,
    pub out: &'a mut Vec<[u32; 3]>,
}

impl Target<'_> {
    /// Adds one list; `fault` places what is wrong with it.
    pub fn add(&mut self, source: &Source, corners: &[f64], fault: impl Fn(String) -> Error) -> Result<()> {
        source.check_triangles((self.out.len() + corners.len().saturating_sub(2)) as u64)?;
        faces::triangulate(self.shape, corners, self.vertices, self.out).map_err(fault)
    }
}

/// Some scalar columns of an element.
pub(super) enum Table<'a> {
    /// In the file's bytes, in rows of one length.
    Packed { rows: Rows<'a>, columns: Vec<Column> },
    /// Widened, row after row.
    Values { values: Vec<f64>, width: usize },
}

impl<'a> Table<'a> {
    /// The first three columns as positions, left in the file's bytes where they are packed.
    pub fn positions(&self) -> Positions<'a> {
        match self {
            Self::Packed { rows, columns } => Positions::Packed(*rows, [columns[0], columns[1], columns[2]]),
            Self::Values { .. } => Positions::Stored(self.triples([0, 1, 2], DVec3::from_array)),
        }
    }

    /// `make` of three columns, for every row.
    pub fn triples<O: Zeroable + Send>(
        &self,
        slots: [usize; 3],
        make: impl Fn([f64; 3]) -> O + Sync,
    ) -> Vec<O> {
        match self {
            Self::Packed { rows, columns } => rows.gather(&slots.map(|slot| columns[slot]), make),
            Self::Values { values, width } => {
                let size = Scalar::F64.size();
                let rows = Rows {
                    bytes: bytemuck::cast_slice(values),
                    stride: width * size,
                    count: values.len() / width,
                    endian: NATIVE,
                };
                let column = |slot| Column { scalar: Scalar::F64, offset: slot * size };
                rows.gather(&slots.map(column), make)
            }
        }
    }
}
