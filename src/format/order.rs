//! The order of the splats in the file: along a Morton curve through their cells.

use super::record::Record;

/// Bits of a cell's coordinate.
const CELL_BITS: u32 = 28;

/// Interleaves the bits of a cell: bit `n` of `x, y, z` becomes bit `3n, 3n+1, 3n+2`.
#[must_use]
pub fn morton(cell: [u32; 3]) -> u128 {
    (0..CELL_BITS).fold(0, |code, n| {
        let bit = |axis: usize| u128::from(cell[axis] >> n & 1) << (3 * n + axis as u32);
        code | bit(0) | bit(1) | bit(2)
    })
}

/// The cell of a Morton code below `2^84`.
#[must_use]
pub fn cell(code: u128) -> [u32; 3] {
    [0, 1, 2].map(|axis| (0..CELL_BITS).fold(0, |cell, n| cell | ((code >> (3 * n + axis) & 1) as u32) << n))
}

/// One more than the largest Morton code.
pub const MORTON_END: u128 = 1 << (3 * CELL_BITS);

/// Sorts records by Morton code, then by all their numbers.
///
/// Equal records are equal in all they say but their partners, so a set of splats has one order.
/// Also gives the place that each record had before.
#[must_use]
pub fn sorted(records: Vec<Record>) -> (Vec<Record>, Vec<u32>) {
    let keyed = records.into_iter().zip(0..).map(|(record, n)| (morton(record.cell), record, n));
    let mut keyed: Vec<_> = keyed.collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, record, n)| (record, n)).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_cells_are_one_to_one() {
        for n in 0..1000_u32 {
            let at = [n * 268_435, (n * 7919) % (1 << 28), (1 << 28) - 1 - n];
            assert_eq!(cell(morton(at)), at);
            assert!(morton(at) < MORTON_END);
        }
        assert_eq!(morton([1, 0, 0]), 1);
        assert_eq!(morton([0, 1, 0]), 2);
        assert_eq!(morton([0, 0, 2]), 32);
    }
}
