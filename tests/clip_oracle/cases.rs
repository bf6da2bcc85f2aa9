//! Conics and points that are hard to decide, drawn from a seed.

use glam::DVec2;
use qsplat::model::clip_curve::{ClipCurve, Conic};

/// How far from the chord's middle a file lets `P2` lie, in larger radii (format-spec.md).
const CONTROL_RANGE: f64 = 1024.0;

/// SplitMix64 (Steele et al. 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xa076_1d64_78bd_642f))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In `[-1, 1)`.
    fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}

/// A shape: 0, 1, beside them by the rounding of the floats under test, or anything between.
fn rho(kind: u64, epsilon: f64, random: &mut Random) -> f64 {
    match kind {
        0 => 0.0,
        1 => 1.0,
        2 => 1e-12 * random.unit(),
        3 => 1.0 - epsilon,
        4 => 0.5,
        5 => epsilon,
        _ => random.unit(),
    }
}

/// A clip curve and the radii of its ellipse: round, needle, narrow arcs, arcs beyond 180 degrees,
/// control points far away and nearly on the chord. `epsilon` is the rounding of the floats that
/// the curve is to be hard for.
pub fn clip(index: u64, epsilon: f64, random: &mut Random) -> (ClipCurve, DVec2) {
    let size = libm::exp2(20.0 * random.signed());
    let ratio = if index.is_multiple_of(3) { 1e-3 } else { 0.2 + random.unit() };
    let radii = DVec2::new(size, size * ratio);
    let turn = std::f64::consts::TAU;
    let alpha1 = turn * random.unit();
    let sweep = match index / 3 % 4 {
        0 => 1e-6 * random.unit(),
        1 => turn * (0.5 + 0.49 * random.unit()),
        2 => turn * (1.0 - 1e-6 * random.unit()),
        _ => turn * random.unit(),
    };
    let mut clip = ClipCurve { alpha1, alpha3: (alpha1 + sweep) % turn, p2: DVec2::ZERO, rho: 0.0 };
    let (p1, p3) = clip.ends(radii);
    let along = p1.lerp(p3, 1.5 * random.unit() - 0.25);
    clip.p2 = match index / 12 % 6 {
        0 => along + 4.0 * epsilon * radii * DVec2::new(random.signed(), random.signed()),
        1 => along + 1e-8 * radii * DVec2::new(random.signed(), random.signed()),
        2 => 16.0 * radii * DVec2::new(random.signed(), random.signed()),
        3 => p1,
        4 => CONTROL_RANGE * radii.x * DVec2::new(random.signed(), random.signed()),
        _ => radii * DVec2::new(random.signed(), random.signed()),
    };
    clip.rho = rho(index / 72 % 8, epsilon, random);
    (clip, radii)
}

/// A point: on the curve but for rounding, beside it by steps of every size, on the chord, at a
/// control point, or anywhere.
pub fn point(index: u64, conic: &Conic, random: &mut Random) -> DVec2 {
    let size = conic.p1.distance(conic.p3).max(1e-3 * conic.p1.length());
    let aside = DVec2::new(random.signed(), random.signed()) * size;
    let t = random.unit();
    match index % 6 {
        0 => conic.point(t),
        1 => conic.point(t) + aside * libm::exp2(-60.0 * random.unit()),
        2 => conic.p1.lerp(conic.p3, t) + aside * libm::exp2(-60.0 * random.unit()),
        3 => {
            [conic.p1, conic.p2, conic.p3][(index / 6 % 3) as usize]
                + aside * libm::exp2(-70.0 * random.unit())
        }
        4 => conic.p1.lerp(conic.p2, t),
        _ => 2.0 * aside,
    }
}
