//! A capped cylinder along z: two circular convex edges.

use glam::DVec3;
use qsplat::Result;

use super::curve::{Circle, Fineness};
use super::planar::{Facing, planar};
use super::ruled::ruled;
use super::surface::{Model, Surface};

const RADIUS: f64 = 0.3;
const HALF_HEIGHT: f64 = 0.5;

/// A chord error of 1.2e-4 of the diagonal, 1.31.
const FINE: Fineness = Fineness { step: 0.035, chord_error: 1.6e-4 };

/// The mesh and its two circles.
///
/// # Errors
/// As [`planar`].
pub fn model() -> Result<Model> {
    let circle = |z| Circle { center: DVec3::Z * z, u: DVec3::X, v: DVec3::Y, radius: RADIUS }.whole(FINE);
    let (low, high) = (circle(-HALF_HEIGHT), circle(HALF_HEIGHT));
    let mut surface = Surface::default();
    planar(&mut surface, &[&low], Facing { axis: 2, negative: true }, FINE.step)?;
    planar(&mut surface, &[&high], Facing { axis: 2, negative: false }, FINE.step)?;
    ruled(&mut surface, &low, &high, FINE.step, false);
    Ok(Model { surface, lines: vec![low, high] })
}
