//! Planted clouds that scatter by a known amount.

use glam::DVec3;

use crate::analyse::planted::normal;
use crate::model::cloud::Cloud;

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
