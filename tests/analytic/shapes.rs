//! Distances to the true surfaces, from the formulas of fixtures/README.md.

use glam::{DVec2, DVec3};

/// A distance to a surface, input units.
pub type Distance = Box<dyn Fn(DVec3) -> f64 + Sync>;

/// The distance to a fixture's true surface; `None` where no closed form is at hand.
pub fn distance(name: &str) -> Option<Distance> {
    Some(match name {
        "sphere" => Box::new(|p| (p.length() - 0.5).abs()),
        "torus" => Box::new(|p| (DVec2::new(p.truncate().length() - 0.35, p.z).length() - 0.15).abs()),
        "capped-cylinder" => Box::new(|p| extruded(p.truncate().length() - 0.3, p.z.abs() - 0.5)),
        "plate" => Box::new(|p| extruded(plate_outline(p.truncate()), p.z.abs() - 0.05)),
        "monkey-saddle" => Box::new(monkey_saddle),
        _ => return None,
    })
}

/// Distance to the surface of a prism: signed distances to its outline and beyond its caps,
/// negative inside.
fn extruded(outline: f64, cap: f64) -> f64 {
    let outside = DVec2::new(outline.max(0.0), cap.max(0.0)).length();
    if outside > 0.0 { outside } else { outline.max(cap).abs() }
}

/// Signed distance to the plate's outline. Rectangle and holes do not meet, so the nearest of
/// the three outlines is the nearest of all.
fn plate_outline(p: DVec2) -> f64 {
    let beyond = p.abs() - DVec2::new(0.5, 0.35);
    let rectangle = beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0);
    let round = 0.15 - p.distance(DVec2::new(-0.25, 0.0));
    let middle = DVec2::new(0.25, 0.0);
    let s = 0.035 - upper_arc(p - middle).min(upper_arc(middle - p));
    rectangle.max(round).max(s)
}

/// Distance to the arc of radius 0.1 around `(0, 0.1)` that leaves the origin clockwise, seen
/// from the arc's centre, and ends after 240 degrees.
fn upper_arc(p: DVec2) -> f64 {
    let q = p - DVec2::new(0.0, 0.1);
    // Clockwise from straight down.
    let angle = (-q.x).atan2(-q.y).rem_euclid(std::f64::consts::TAU);
    if angle <= 240_f64.to_radians() {
        return (q.length() - 0.1).abs();
    }
    let end = 240_f64.to_radians();
    let tip = 0.1 * DVec2::new(-end.sin(), -end.cos());
    q.distance(tip).min(p.length())
}

/// Distance to `z = x³ - 3xy²` over the disc of radius 0.5, from above: any point of the surface
/// will do, and Gauss-Newton steps lead to the nearest, or along the border.
fn monkey_saddle(p: DVec3) -> f64 {
    let height = |q: DVec2| q.x.powi(3) - 3.0 * q.x * q.y * q.y;
    let mut q = p.truncate().clamp_length_max(0.5);
    let mut least = f64::INFINITY;
    for _ in 0..6 {
        let off = p - q.extend(height(q));
        least = least.min(off.length());
        let slope = DVec2::new(3.0 * (q.x * q.x - q.y * q.y), -6.0 * q.x * q.y);
        // Normal equations of the tangent plane: (1 + s sᵀ) step = off_xy + s off_z.
        let right = off.truncate() + slope * off.z;
        let step = right - slope * (slope.dot(right) / (1.0 + slope.length_squared()));
        q = (q + step).clamp_length_max(0.5);
    }
    least
}

#[test]
fn points_on_the_surfaces_have_no_distance() {
    let plate = distance("plate").unwrap();
    let saddle = distance("monkey-saddle").unwrap();
    for (x, y) in [(0.5, 0.1), (-0.1, 0.0), (0.25, 0.235), (0.25, -0.235), (0.25 - 0.135, 0.1)] {
        assert!(plate(DVec3::new(x, y, 0.0)) < 1e-12, "{x} {y}");
    }
    assert!((plate(DVec3::new(0.53, 0.39, 0.05)) - 0.05).abs() < 1e-12);
    assert!((saddle(DVec3::new(0.6, 0.0, 0.125)) - 0.1).abs() < 1e-3);
    assert!(saddle(DVec3::new(0.2, 0.1, 0.002)) < 1e-12);
}
