//! How well a smooth surface explains points around a place.

use glam::DVec3;
use nalgebra::{Matrix6, Vector6};

/// Mean square distance of points from the quadric of least squares over a plane with this unit
/// normal, each no more than the cutoff; `None` where the points do not determine a quadric.
pub(super) fn scatter(points: &[DVec3], normal: DVec3, radius: f64, cutoff: f64) -> Option<f64> {
    let (right, up) = normal.any_orthonormal_pair();
    let terms = |p: &DVec3| {
        let (u, v) = (p.dot(right) / radius, p.dot(up) / radius);
        Vector6::new(1.0, u, v, u * u, u * v, v * v)
    };
    let (mut square, mut right_side) = (Matrix6::<f64>::zeros(), Vector6::<f64>::zeros());
    for p in points {
        let t = terms(p);
        square.ger(1.0, &t, &t, 1.0);
        right_side += p.dot(normal) * t;
    }
    let quadric = square.cholesky()?.solve(&right_side);
    let off = |p: &DVec3| (p.dot(normal) - quadric.dot(&terms(p))).abs().min(cutoff);
    Some(points.iter().map(|p| off(p) * off(p)).sum::<f64>() / points.len() as f64)
}
