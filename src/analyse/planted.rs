//! Numbers for planted clouds: the same in every run, as if drawn.

use super::canonical::mix;

/// The numbers of [`normal`] are made of others than those of [`random`] of small arguments.
const APART: u64 = 1 << 40;

/// Within `[-1, 1]`, evenly.
pub(crate) fn random(n: u64) -> f64 {
    (mix(n) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// About normal, of variance 1: the sum of twelve numbers (Irwin and Hall).
pub(crate) fn normal(n: u64) -> f64 {
    (0..12).map(|k| 0.5 * random(APART + 16 * n + k)).sum()
}
