//! Where a model lies: a 64-bit origin and a power-of-two scale.

use glam::DVec3;

/// Maps between the input's coordinates and the *model units* everything else works in.
///
/// `input = origin + 2^exponent * model`. The origin is the centre of the bounding box, and
/// the exponent is the least that puts every point within `[-1, 1]`. Both steps are exact
/// enough for any size and place: scaling by a power of two only changes exponents, and the
/// origin is subtracted in 64 bits before anything is rounded to 32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Centre of the input's bounding box, in input units.
    pub origin: DVec3,
    /// Power of two: one model unit is `2^exponent` input units.
    pub exponent: i32,
}

/// Exponents outside `-LIMIT..=LIMIT` are refused: `2^exponent` must be a normal `f64`.
pub const EXPONENT_LIMIT: i32 = 1000;

impl Frame {
    /// The frame of a box given by its least and greatest corner.
    ///
    /// A box without extent (one point) gets exponent 0.
    #[must_use]
    pub fn of_box(min: DVec3, max: DVec3) -> Self {
        // Halved first: the sum of two finite coordinates may overflow.
        let origin = 0.5 * min + 0.5 * max;
        let half = (0.5 * max - 0.5 * min).max_element();
        let exponent = if half > 0.0 {
            // frexp gives half = m * 2^e with m in [0.5, 1), so half / 2^e <= 1.
            libm::frexp(half).1.clamp(-EXPONENT_LIMIT, EXPONENT_LIMIT)
        } else {
            0
        };
        Self { origin, exponent }
    }

    /// Input units in one model unit, exactly `2^exponent`.
    #[must_use]
    pub fn scale(&self) -> f64 {
        libm::ldexp(1.0, self.exponent)
    }

    /// A point in input coordinates, in model units.
    #[must_use]
    pub fn to_model(&self, input: DVec3) -> DVec3 {
        (input - self.origin) * libm::ldexp(1.0, -self.exponent)
    }

    /// A point in model units, in input coordinates.
    #[must_use]
    pub fn to_input(&self, model: DVec3) -> DVec3 {
        self.origin + model * self.scale()
    }
}

impl Default for Frame {
    fn default() -> Self {
        Self { origin: DVec3::ZERO, exponent: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_fills_the_unit_cube_without_leaving_it() {
        for size in [1e-12, 0.3, 1.0, 2.0, 7.7e11] {
            let at = DVec3::new(5.0, -3.0, 0.5) * size;
            let frame = Frame::of_box(at, at + DVec3::new(size, 0.5 * size, 0.0));
            let half = frame.to_model(at + DVec3::X * size).x;
            assert!(half > 0.499 && half <= 1.0, "{size}: {half}");
        }
    }

    #[test]
    fn there_and_back_is_exact_for_powers_of_two() {
        let frame = Frame::of_box(DVec3::splat(-8.0), DVec3::splat(8.0));
        let p = DVec3::new(1.25, -7.5, 3.0);
        assert_eq!(frame.to_input(frame.to_model(p)), p);
    }

    #[test]
    fn huge_boxes_do_not_overflow() {
        let frame = Frame::of_box(DVec3::splat(-f64::MAX), DVec3::splat(f64::MAX));
        assert!(frame.origin.is_finite() && frame.scale().is_finite());
    }
}
