//! Bulk decoding of rows of binary numbers.
//!
//! Rows are gone through in blocks that stay in the first-level cache; within a block, one
//! column after the other is widened to `f64` by a loop that knows its type. So the type is
//! looked up once a block and column instead of once a number.

use bytemuck::Zeroable;
use rayon::prelude::*;

/// Rows of a block: the columns of one block fit the first-level cache.
const BLOCK: usize = 1024;

/// Byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

/// The order of this machine.
pub(super) const NATIVE: Endian = if cfg!(target_endian = "little") { Endian::Little } else { Endian::Big };

/// Type of a stored number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Bytes of one number.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether numbers of this type may have a fraction.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The number at the front of `bytes`; `None` where too few are left.
    pub fn read(self, endian: Endian, bytes: &[u8]) -> Option<f64> {
        let mut out = [[0.0]];
        bytes.get(..self.size())?;
        self.widen(endian, Strided { bytes, stride: self.size(), offset: 0 }, &mut out, 0);
        Some(out[0][0])
    }

    /// Widens one column of a block into `out[..][axis]`. Exact for every type.
    fn widen<const N: usize>(self, endian: Endian, column: Strided, out: &mut [[f64; N]], axis: usize) {
        match (self, endian) {
            (Self::I8, _) => column.fill(out, axis, |b| f64::from(i8::from_le_bytes(b))),
            (Self::U8, _) => column.fill(out, axis, |b: [u8; 1]| f64::from(b[0])),
            (Self::I16, Endian::Little) => column.fill(out, axis, |b| f64::from(i16::from_le_bytes(b))),
            (Self::I16, Endian::Big) => column.fill(out, axis, |b| f64::from(i16::from_be_bytes(b))),
            (Self::U16, Endian::Little) => column.fill(out, axis, |b| f64::from(u16::from_le_bytes(b))),
            (Self::U16, Endian::Big) => column.fill(out, axis, |b| f64::from(u16::from_be_bytes(b))),
            (Self::I32, Endian::Little) => column.fill(out, axis, |b| f64::from(i32::from_le_bytes(b))),
            (Self::I32, Endian::Big) => column.fill(out, axis, |b| f64::from(i32::from_be_bytes(b))),
            (Self::U32, Endian::Little) => column.fill(out, axis, |b| f64::from(u32::from_le_bytes(b))),
            (Self::U32, Endian::Big) => column.fill(out, axis, |b| f64::from(u32::from_be_bytes(b))),
            (Self::F32, Endian::Little) => column.fill(out, axis, |b| f64::from(f32::from_le_bytes(b))),
            (Self::F32, Endian::Big) => column.fill(out, axis, |b| f64::from(f32::from_be_bytes(b))),
            (Self::F64, Endian::Little) => column.fill(out, axis, f64::from_le_bytes),
            (Self::F64, Endian::Big) => column.fill(out, axis, f64::from_be_bytes),
        }
    }
}

/// One column of a block of rows.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    offset: usize,
}

impl Strided<'_> {
    fn fill<const N: usize, const S: usize>(
        &self,
        out: &mut [[f64; N]],
        axis: usize,
        read: impl Fn([u8; S]) -> f64,
    ) {
        for (row, out) in self.bytes.chunks(self.stride).zip(out) {
            if let Some(bytes) = row.get(self.offset..).and_then(|field| field.first_chunk()) {
                out[axis] = read(*bytes);
            }
        }
    }
}

/// A number's type and its place in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    pub scalar: Scalar,
    pub offset: usize,
}

/// Equally long rows of bytes. The last one may lack what follows its last column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<'a> {
    pub bytes: &'a [u8],
    /// Bytes from one row to the next, above 0.
    pub stride: usize,
    pub count: usize,
    pub endian: Endian,
}

impl Rows<'_> {
    /// Hands the `N` columns of each row to `take`, one row after the other.
    pub fn each<const N: usize>(&self, columns: &[Column; N], mut take: impl FnMut([f64; N])) {
        for row in self.bytes.chunks(self.stride).take(self.count) {
            take(columns.map(|column| {
                let field = row.get(column.offset..).unwrap_or_default();
                column.scalar.read(self.endian, field).unwrap_or(f64::NAN)
            }));
        }
    }

    /// `make` of the `N` columns of each row, in the order of the rows.
    pub fn gather<const N: usize, O: Zeroable + Send>(
        &self,
        columns: &[Column; N],
        make: impl Fn([f64; N]) -> O + Sync,
    ) -> Vec<O> {
        // Zeroed by the system, page by page as it is first touched: written once, not twice.
        let mut out: Vec<O> = bytemuck::zeroed_vec(self.count);
        let blocks = self.bytes.par_chunks(BLOCK * self.stride);
        out.par_chunks_mut(BLOCK).zip(blocks).for_each(|(out, bytes)| {
            let mut wide = [[0.0; N]; BLOCK];
            let wide = self.widen(bytes, columns, &mut wide);
            for (out, &values) in out.iter_mut().zip(wide.iter()) {
                *out = make(values);
            }
        });
        out
    }

    /// Folds the `N` columns of all rows from `zero` on; `join` must not mind the order.
    pub fn fold<const N: usize, A: Copy + Send + Sync>(
        &self,
        columns: &[Column; N],
        zero: A,
        add: impl Fn(A, [f64; N]) -> A + Sync,
        join: impl Fn(A, A) -> A + Sync + Send,
    ) -> A {
        let blocks = self.bytes.par_chunks(BLOCK * self.stride);
        let folded = blocks.map(|bytes| {
            let mut wide = [[0.0; N]; BLOCK];
            self.widen(bytes, columns, &mut wide).iter().fold(zero, |all, &values| add(all, values))
        });
        folded.reduce(|| zero, join)
    }

    /// Widens a block's columns; the rows that it has.
    fn widen<'w, const N: usize>(
        &self,
        bytes: &[u8],
        columns: &[Column; N],
        wide: &'w mut [[f64; N]; BLOCK],
    ) -> &'w [[f64; N]] {
        let wide = &mut wide[..bytes.len().div_ceil(self.stride).min(BLOCK)];
        for (axis, column) in columns.iter().enumerate() {
            let block = Strided { bytes, stride: self.stride, offset: column.offset };
            column.scalar.widen(self.endian, block, wide, axis);
        }
        wide
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn columns_of_every_type_and_order_come_back() {
        let mut little = Vec::new();
        let mut big = Vec::new();
        for n in 0..3000_i32 {
            little.extend_from_slice(&(f64::from(n) * 0.1).to_le_bytes());
            little.extend_from_slice(&(-n).to_le_bytes());
            little.extend_from_slice(&(n as u16).to_le_bytes());
            big.extend_from_slice(&(f64::from(n) * 0.1).to_be_bytes());
            big.extend_from_slice(&(-n).to_be_bytes());
            big.extend_from_slice(&(n as u16).to_be_bytes());
        }
        let columns = [
            Column { scalar: Scalar::U16, offset: 12 },
            Column { scalar: Scalar::F64, offset: 0 },
            Column { scalar: Scalar::I32, offset: 8 },
        ];
        for (bytes, endian) in [(&little, Endian::Little), (&big, Endian::Big)] {
            let rows = Rows { bytes, stride: 14, count: 3000, endian };
            let found = rows.gather(&columns, |values| values);
            for (n, row) in found.iter().enumerate() {
                let n = n as f64;
                assert_eq!(row.map(f64::to_bits), [n, n * 0.1, -n].map(|v| (v + 0.0).to_bits()));
            }
        }
    }

    #[test]
    fn small_types_read_singly() {
        assert_eq!(Scalar::I8.read(Endian::Big, &[0xff]), Some(-1.0));
        assert_eq!(Scalar::I16.read(Endian::Big, &[0xff, 0xfe]), Some(-2.0));
        assert_eq!(Scalar::F32.read(Endian::Little, &1.5_f32.to_le_bytes()), Some(1.5));
        assert_eq!(Scalar::U32.read(Endian::Little, &[1, 2, 3]), None);
    }
}
