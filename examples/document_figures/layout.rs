//! Bytes as the document counts them: plain 32-bit numbers (T 5.3, pages 78 to 80).

use qsplat::model::asset::Asset;

/// Bytes of a splat: 16 numbers.
const SPLAT: usize = 64;
/// Bytes that a straight cut adds: 2 numbers.
const STRAIGHT: usize = 8;
/// Bytes that a curved cut adds: 5 numbers.
const CURVED: usize = 20;

/// What is to be stored.
pub struct Layout {
    /// Splats.
    pub splats: usize,
    /// Their cuts.
    pub cuts: usize,
    /// How many of the cuts are curved.
    pub curved: usize,
}

impl Layout {
    /// What an asset holds.
    pub fn of(asset: &Asset) -> Self {
        let counts = asset.counts();
        let curved = counts.curved_clips;
        Self { splats: counts.splats, cuts: counts.straight_clips + curved, curved }
    }

    /// Bytes with every cut straight, and with the curved ones curved.
    pub fn bytes(&self) -> (usize, usize) {
        let straight = SPLAT * self.splats + STRAIGHT * self.cuts;
        (straight, straight + (CURVED - STRAIGHT) * self.curved)
    }
}
