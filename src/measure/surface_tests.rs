//! Planted errors come back.
#![allow(clippy::unwrap_used)]

use glam::{DMat3, DVec2};

use super::super::planted::{asset, ball, discs, flat, mesh, sphere, square};
use super::*;
use crate::render::input::Model;

fn compared(asset: &Asset, against: Model<'_>) -> Result<SurfaceErrors> {
    surface(asset, &InputSurface::new(against)?)
}

#[test]
fn a_lifted_sphere_is_off_by_its_lift() {
    let (radius, lift) = (0.8, 0.004);
    let ball = ball(radius, 400);
    let asset = asset(sphere(radius + lift, 4000, 0.05));
    let found = compared(&asset, Model::Mesh(&ball)).unwrap();
    // The mesh lies within 3e-5 of the sphere, the paraboloids within r^4/8R^3 = 2e-6.
    for distances in [found.forward, found.backward] {
        assert!((distances.rms - lift).abs() < 4e-5 && (distances.max - lift).abs() < 6e-5, "{found:?}");
        assert!((distances.p99 - lift).abs() < 6e-5, "{found:?}");
    }
    assert!(found.normal.p99_deg < 0.5, "{found:?}");
    // Caps of radius r have the area pi r^2 (1 + r^2/2R^2 ...) here.
    let caps = 4000.0 * 0.05_f64.powi(2) / (4.0 * radius * radius);
    let overlap = found.overlap.unwrap();
    assert!((overlap / caps - 1.0).abs() < 3e-3, "{overlap} for {caps}");
    let points = sphere(radius, 40_000, 0.01).iter().map(|splat| splat.center).collect();
    let cloud = mesh(points, vec![]).vertices;
    let found = compared(&asset, Model::Surface(&cloud, &discs(&cloud))).unwrap();
    assert!((found.forward.rms - lift).abs() < 2e-5 && (found.backward.rms - lift).abs() < 4e-5, "{found:?}");
    assert!(found.overlap.is_none() && found.normal.p99_deg < 0.5);
}

#[test]
fn what_stands_out_past_a_border_is_seen_backward_only() {
    // A disc that just passes the corners of a square passes its sides by sqrt(2) - 1.
    let disc = flat(DVec3::ZERO, DVec2::splat(2.0_f64.sqrt() + 1e-6), vec![]);
    let found = compared(&asset(vec![disc]), Model::Mesh(&square(8))).unwrap();
    assert!(found.forward.max < 1e-9 && found.normal.rms_deg < 1e-6, "{found:?}");
    assert!((found.backward.max - (2.0_f64.sqrt() - 1.0)).abs() < 1e-4, "{found:?}");
    // The mean square over the disc, from the integral over the four segments.
    let n = 2000;
    let cell = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * 2.0 * 2.0_f64.sqrt() - 2.0_f64.sqrt();
    let inside =
        (0..n * n).map(|k| DVec2::new(cell(k % n), cell(k / n))).filter(|p| p.length_squared() <= 2.0);
    let (count, sum) = inside.fold((0.0_f64, 0.0_f64), |(count, sum), p| {
        (count + 1.0, sum + (p.abs() - 1.0).max(DVec2::ZERO).length_squared())
    });
    assert!((found.backward.rms / (sum / count).sqrt() - 1.0).abs() < 5e-3, "{found:?}");
    assert!((found.overlap.unwrap() - std::f64::consts::PI / 2.0).abs() < 1e-5);
}

#[test]
fn a_missing_part_is_seen_forward_only() {
    let half = vec![crate::model::clip_curve::ClipCurve::chord(std::f64::consts::PI, 0.0)];
    let found =
        compared(&asset(vec![flat(DVec3::ZERO, DVec2::splat(1.5), half)]), Model::Mesh(&square(8))).unwrap();
    assert!(found.backward.max > 0.4 && (found.forward.max - 1.0).abs() < 1e-9, "{found:?}");
    // Over half of the square the distance is |y|.
    assert!((found.forward.rms - (1.0_f64 / 6.0).sqrt()).abs() < 1e-3, "{found:?}");
}

#[test]
fn a_tilted_splat_is_off_by_its_angle() {
    let mut splat = flat(DVec3::ZERO, DVec2::splat(3.0), vec![]);
    splat.axes = DMat3::from_rotation_x(7.0_f64.to_radians());
    let found = compared(&asset(vec![splat.clone()]), Model::Mesh(&square(4))).unwrap();
    assert!((found.normal.rms_deg - 7.0).abs() < 1e-6 && (found.normal.p99_deg - 7.0).abs() < 1e-6);
    // The farthest points of the square lie at sin 7 degrees over the plane.
    assert!((found.forward.max - 7.0_f64.to_radians().sin()).abs() < 1e-9);
    splat.axes = DMat3::from_rotation_x(187.0_f64.to_radians());
    let turned = compared(&asset(vec![splat.clone()]), Model::Mesh(&square(4))).unwrap();
    assert!((turned.normal.rms_deg - 173.0).abs() < 1e-6, "inside out: {turned:?}");
    let cloud = square(40).vertices;
    let unsigned = compared(&asset(vec![splat]), Model::Surface(&cloud, &discs(&cloud))).unwrap();
    assert!((unsigned.normal.rms_deg - 7.0).abs() < 1e-3, "{unsigned:?}");
}

#[test]
fn beside_an_edge_each_side_has_its_own_normal() {
    // Two squares at a right angle, and splats that pass the edge a little, uncut.
    let positions = [(-1.0, -1.0), (0.0, -1.0), (0.0, 1.0), (-1.0, 1.0)];
    let mut corners: Vec<DVec3> = positions.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
    corners.extend([DVec3::new(0.0, -1.0, -1.0), DVec3::new(0.0, 1.0, -1.0)]);
    let roof = mesh(corners, vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]);
    let top = flat(DVec3::new(-1.0, 0.0, -4e-4), DVec2::splat(2.5), vec![]);
    let mut side = flat(DVec3::new(-4e-4, 0.0, -1.0), DVec2::splat(2.5), vec![]);
    side.axes = DMat3::from_rotation_y(std::f64::consts::FRAC_PI_2);
    let found = compared(&asset(vec![top, side]), Model::Mesh(&roof)).unwrap();
    assert!(found.normal.rms_deg < 1e-6, "{found:?}");
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let square = square(2);
    let mut other = asset(vec![flat(DVec3::ZERO, DVec2::ONE, vec![])]);
    assert!(compared(&asset(vec![]), Model::Mesh(&square)).is_err());
    assert!(compared(&other, Model::Mesh(&mesh(vec![DVec3::ZERO], vec![]))).is_err());
    other.frame.exponent = 3;
    assert!(compared(&other, Model::Mesh(&square)).is_err());
}
