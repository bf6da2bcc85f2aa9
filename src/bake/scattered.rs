//! Planted clouds that scatter by a known amount.

use glam::DVec3;

use crate::analyse::canonical::mix;
use crate::model::cloud::Cloud;

/// Within `[-1, 1]`.
pub(super) fn random(n: u64) -> f64 {
    (mix(n) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// About normal, of variance 1: the sum of twelve numbers (Irwin and Hall).
fn normal(n: u64) -> f64 {
    (0..12).map(|k| 0.5 * random(16 * n + k)).sum()
}

/// Points on a sphere of radius 0.8, strewn evenly, that scatter by `scatter` in every direction.
pub(super) fn sphere(count: u64, scatter: f64) -> Cloud {
    let point = |n: u64| {
        let z = 1.0 - (2.0 * n as f64 + 1.0) / count as f64;
        let (sin, cos) = libm::sincos(2.399_963 * n as f64);
        let across = libm::sqrt(1.0 - z * z);
        let off = DVec3::new(normal(3 * n), normal(3 * n + 1), normal(3 * n + 2));
        (0.8 * DVec3::new(across * cos, across * sin, z) + scatter * off).as_vec3()
    };
    Cloud { positions: (0..count).map(point).collect(), ..Cloud::default() }
}
