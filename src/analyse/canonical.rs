//! An order of points that does not depend on the order of the input.

use glam::Vec3;
use rayon::prelude::*;

/// Spreads the low [`MORTON_LEVELS`] bits of a number so that two zero bits follow each.
fn spread(mut x: u64) -> u64 {
    x &= 0x1f_ffff;
    x = (x | (x << 32)) & 0x001f_0000_0000_ffff;
    x = (x | (x << 16)) & 0x001f_0000_ff00_00ff;
    x = (x | (x << 8)) & 0x100f_00f0_0f00_f00f;
    x = (x | (x << 4)) & 0x10c3_0c30_c30c_30c3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}

/// Bits of a Morton code that each coordinate has.
pub const MORTON_LEVELS: u32 = 21;

/// The width of the cells that Morton codes number, model units.
pub const MORTON_UNIT: f64 = 2.0 / (1_u32 << MORTON_LEVELS) as f64;

/// The Morton code of a position in `[-1, 1]³`.
#[must_use]
pub fn morton(p: Vec3) -> u64 {
    let cell = |x: f32| ((f64::from(x) + 1.0) / MORTON_UNIT) as u64;
    spread(cell(p.x).min(0x1f_ffff))
        | spread(cell(p.y).min(0x1f_ffff)) << 1
        | spread(cell(p.z).min(0x1f_ffff)) << 2
}

/// The order of positions along the Morton curve, ties broken by the exact coordinates.
///
/// Two positions compare equal only if they are the same bits (or `0` and `-0`).
#[must_use]
pub fn key(p: Vec3) -> (u64, [u32; 3]) {
    // Adding zero turns -0 into 0.
    (morton(p), (p + Vec3::ZERO).to_array().map(f32::to_bits))
}

/// The indices of positions sorted by [`key`]; equal ones in no order that means anything.
#[must_use]
pub fn order(positions: &[Vec3]) -> Vec<u32> {
    order_along(positions, |p| p)
}

/// The indices of positions in the order of where they are put along the Morton curve, ties broken
/// by [`key`].
#[must_use]
pub fn order_along(positions: &[Vec3], put: impl Fn(Vec3) -> Vec3 + Sync) -> Vec<u32> {
    // The code alone is compared first: codes are equal for few.
    let mut coded: Vec<(u64, u32)> =
        positions.par_iter().enumerate().map(|(n, &p)| (morton(put(p)), n as u32)).collect();
    coded.par_sort_unstable_by_key(|coded| coded.0);
    for same in coded.chunk_by_mut(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        same.sort_unstable_by_key(|&(_, n)| key(positions[n as usize]));
    }
    coded.into_iter().map(|(_, n)| n).collect()
}

/// A well-mixed number from an index (SplitMix64, Steele et al. 2014).
#[must_use]
pub fn mix(index: u64) -> u64 {
    let mut z = index.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_octants_one_by_one() {
        let corner = |x: f32, y: f32, z: f32| morton(Vec3::new(x, y, z));
        assert_eq!(corner(-1.0, -1.0, -1.0), 0);
        assert!(corner(0.9, -0.9, -0.9) < corner(-0.9, 0.9, -0.9));
        assert!(corner(0.9, 0.9, -0.9) < corner(-0.9, -0.9, 0.9));
        assert_eq!(corner(1.0, 1.0, 1.0), (1 << 63) - 1);
    }

    #[test]
    fn both_zeros_are_one_place() {
        assert_eq!(key(Vec3::new(0.0, -0.0, 0.0)), key(Vec3::ZERO));
    }
}
