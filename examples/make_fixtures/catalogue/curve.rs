//! Pieces of outlines: straight lines and arcs as points, and loops made of them.

use glam::DVec3;
use qsplat::{Error, Result};

use super::surface::snap;

/// Points along a curve, ends included; a closed curve repeats its first point.
pub type Curve = Vec<DVec3>;

/// How finely curves are divided.
#[derive(Clone, Copy)]
pub struct Fineness {
    /// Greatest length of a segment.
    pub step: f64,
    /// Greatest distance between an arc and its chords.
    pub chord_error: f64,
}

/// A straight line in `count` equal segments.
///
/// The points do not depend on which end comes first, so both faces beside it get the same.
pub fn divided(a: DVec3, b: DVec3, count: usize) -> Curve {
    let (a, b) = (snap(a), snap(b));
    if a.to_array() > b.to_array() {
        let mut curve = divided(b, a, count);
        curve.reverse();
        return curve;
    }
    (0..=count).map(|n| snap(a.lerp(b, n as f64 / count as f64))).collect()
}

/// Segments of a length that keep within the step.
pub fn count(length: f64, step: f64) -> usize {
    // A hair less, so that rounding does not add a segment to a length of whole steps.
    libm::ceil(length / step - 1e-9).max(1.0) as usize
}

/// A straight line with segments no longer than the step.
pub fn line(a: DVec3, b: DVec3, fine: Fineness) -> Curve {
    divided(a, b, count(a.distance(b), fine.step))
}

/// A circle in the plane of two unit axes.
#[derive(Clone, Copy)]
pub struct Circle {
    /// Its centre.
    pub center: DVec3,
    /// Angle 0.
    pub u: DVec3,
    /// Angle 90 degrees.
    pub v: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Circle {
    /// The arc between two angles in degrees; `from > to` runs backwards.
    pub fn arc(&self, from: f64, to: f64, fine: Fineness) -> Curve {
        let length = (to - from).abs().to_radians() * self.radius;
        // The sagitta of a chord of length h is h²/8r, but for terms of higher order.
        let chord = libm::sqrt(8.0 * fine.chord_error * self.radius);
        let count = count(length, chord.min(fine.step));
        (0..=count)
            .map(|n| {
                let angle = from + (to - from) * (n as f64 / count as f64);
                let (sin, cos) = libm::sincos(angle.to_radians());
                snap(self.center + self.radius * (cos * self.u + sin * self.v))
            })
            .collect()
    }

    /// The whole circle as a closed curve.
    pub fn whole(&self, fine: Fineness) -> Curve {
        self.arc(0.0, 360.0, fine)
    }
}

/// Chains curves end to end in the order given, turning each as needed.
///
/// # Errors
/// [`Error::Internal`] when a curve does not start where the chain ends.
pub fn chain(curves: &[&Curve]) -> Result<Curve> {
    let [first, rest @ ..] = curves else { return Ok(Curve::new()) };
    let mut chain = (*first).clone();
    if let Some(second) = rest.first() {
        let meets = |end: Option<&DVec3>| end == second.first() || end == second.last();
        if !meets(chain.last()) {
            chain.reverse();
        }
    }
    for curve in rest {
        let end = chain.last().copied();
        if end == curve.first().copied() {
            chain.extend(curve.iter().skip(1));
        } else if end == curve.last().copied() {
            chain.extend(curve.iter().rev().skip(1));
        } else {
            return Err(Error::Internal(format!("outline breaks at {end:?}")));
        }
    }
    Ok(chain)
}

/// Chains curves to a closed loop.
///
/// # Errors
/// As [`chain`], and when the last curve does not end where the first starts.
pub fn closed(curves: &[&Curve]) -> Result<Curve> {
    let chain = chain(curves)?;
    if chain.first() == chain.last() {
        Ok(chain)
    } else {
        Err(Error::Internal(format!("outline stays open at {:?}", chain.last())))
    }
}
