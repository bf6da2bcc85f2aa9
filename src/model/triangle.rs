//! The nearest place of a triangle.

use glam::DVec3;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;

/// The way from a point to the nearest place of a triangle, which may be as thin as a line.
#[must_use]
pub fn to_triangle(corners: [DVec3; 3], point: DVec3) -> DVec3 {
    // Relative to the point, so that what is near keeps its digits.
    let [a, b, c] = corners.map(|corner| {
        let way = corner - point;
        Vector::new(way.x, way.y, way.z)
    });
    let way = Triangle::new(a, b, c).project_local_point(Vector::ZERO, true).point;
    DVec3::new(way.x, way.y, way.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::polyline::nearest_on;

    /// The nearest of the three sides and of the foot, if that lies inside.
    fn planted(corners: [DVec3; 3], point: DVec3) -> f64 {
        let [a, b, c] = corners;
        let side = |a, b| nearest_on(a, b, point).distance(point);
        let normal = (b - a).cross(c - a);
        let inside = |a: DVec3, b: DVec3| (b - a).cross(point - a).dot(normal) >= 0.0;
        let sides = side(a, b).min(side(b, c)).min(side(c, a));
        if normal != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
            return ((point - a).dot(normal) / normal.length()).abs().min(sides);
        }
        sides
    }

    #[test]
    fn distances_are_exact_for_slivers_too() {
        let value = |n: u32| {
            let (_, part) = libm::modf(f64::from(n) * 0.754_877_666_246_692_8 + f64::from(n / 7) * 0.31);
            2.0 * part.abs() as f32 as f64 - 1.0
        };
        let mut worst = 0.0_f64;
        for n in 0..20_000_u32 {
            let at = |k: u32| DVec3::new(value(12 * n + k), value(12 * n + k + 1), value(12 * n + k + 2));
            let (a, b) = (at(0), at(3));
            let thin = [1.0, 1e-3, 1e-6, 0.0][n as usize % 4];
            let c = a.lerp(b, value(12 * n + 5) * 1.5) + thin * at(6);
            let corners = [a, b, c].map(|p| p.as_vec3().as_dvec3());
            let point = at(9) * [1.0, 0.01, 30.0][n as usize % 3];
            let (exact, found) = (planted(corners, point), to_triangle(corners, point).length());
            worst = worst.max((found - exact).abs() / (1.0 + exact));
        }
        assert!(worst < 1e-7, "{worst:e}");
    }
}
