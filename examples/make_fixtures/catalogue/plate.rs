//! A plate with a round hole and an S-shaped one, whose outline has four inflections.

use glam::DVec3;
use qsplat::Result;

use super::curve::{Circle, Curve, Fineness, closed, line};
use super::planar::{Facing, planar};
use super::ruled::ruled;
use super::surface::{Model, Surface};

/// Half the plate's extent; it is centred on the origin.
const HALF: DVec3 = DVec3::new(0.5, 0.35, 0.05);

/// Centre and radius of the round hole.
const ROUND: (f64, f64, f64) = (-0.25, 0.0, 0.15);

/// The S: its centre line is two arcs of this radius that meet at `S_CENTER`, ...
const S_CENTER: (f64, f64) = (0.25, 0.0);
const S_RADIUS: f64 = 0.1;
/// ... each through this many degrees, ...
const S_SWEEP: f64 = 240.0;
/// ... and the hole is what lies within this of it.
const S_HALF_WIDTH: f64 = 0.035;

/// A chord error of 1.5e-4 of the diagonal, 1.22.
const FINE: Fineness = Fineness { step: 0.035, chord_error: 1.8e-4 };

fn circle(x: f64, y: f64, z: f64, radius: f64) -> Circle {
    Circle { center: DVec3::new(x, y, z), u: DVec3::X, v: DVec3::Y, radius }
}

/// The outline of the S at a height; all its joints are smooth.
fn s_outline(z: f64) -> Result<Curve> {
    let mut pieces = Vec::new();
    // The lower half is the upper one turned by half a turn around the centre.
    for (side, turn) in [(1.0, 0.0), (-1.0, 180.0)] {
        let (x, y) = (S_CENTER.0, S_CENTER.1 + side * S_RADIUS);
        let (from, to) = (turn - 90.0, turn - 90.0 - S_SWEEP);
        let (sin, cos) = libm::sincos(to.to_radians());
        let tip = circle(x + S_RADIUS * cos, y + S_RADIUS * sin, z, S_HALF_WIDTH);
        pieces.push(circle(x, y, z, S_RADIUS - S_HALF_WIDTH).arc(from, to, FINE));
        pieces.push(tip.arc(to - 180.0, to, FINE));
        pieces.push(circle(x, y, z, S_RADIUS + S_HALF_WIDTH).arc(to, from, FINE));
    }
    closed(&pieces.iter().collect::<Vec<_>>())
}

/// The four corners at a height, counter-clockwise.
fn corners(z: f64) -> [DVec3; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x * HALF.x, y * HALF.y, z))
}

fn rectangle(z: f64) -> Result<Curve> {
    let c = corners(z);
    let sides = [0, 1, 2, 3].map(|n| line(c[n], c[(n + 1) % 4], FINE));
    closed(&sides.iter().collect::<Vec<_>>())
}

/// The mesh; its lines are the six outlines (the rectangles with their corners in them) and the
/// four upright edges.
///
/// # Errors
/// As [`planar`] and [`closed`].
pub fn model() -> Result<Model> {
    let outlines = |z| -> Result<[Curve; 3]> {
        Ok([rectangle(z)?, circle(ROUND.0, ROUND.1, z, ROUND.2).whole(FINE), s_outline(z)?])
    };
    let (low, high) = (outlines(-HALF.z)?, outlines(HALF.z)?);
    let mut surface = Surface::default();
    for (loops, negative) in [(&low, true), (&high, false)] {
        let loops: Vec<&Curve> = loops.iter().collect();
        planar(&mut surface, &loops, Facing { axis: 2, negative }, FINE.step)?;
    }
    for (a, b) in low.iter().zip(&high) {
        // A wall faces right of its outline's walk when that runs counter-clockwise around
        // material; the round hole and the rectangle both run counter-clockwise.
        let hole = !std::ptr::eq(a, &low[0]);
        ruled(&mut surface, a, b, FINE.step, hole != clockwise(a));
    }
    let upright = corners(-HALF.z).into_iter().zip(corners(HALF.z));
    let mut lines: Vec<Curve> = low.into_iter().chain(high).collect();
    lines.extend(upright.map(|(a, b)| line(a, b, FINE)));
    Ok(Model { surface, lines })
}

/// Whether a closed curve runs clockwise seen from above.
fn clockwise(curve: &Curve) -> bool {
    curve.windows(2).map(|pair| pair[0].x * pair[1].y - pair[1].x * pair[0].y).sum::<f64>() < 0.0
}
