//! Where a model lies: a 64-bit origin and a power-of-two scale.

use glam::DVec3;

/// Maps between the input's coordinates and the *model units* everything else works in.
///
/// `input = origin + 2^exponent * model`. The origin lies near the centre of the bounding box, and
/// the exponent is the least that puts every point within `[-1, 1]`. Both steps are exact
/// enough for any size and place: scaling by a power of two only changes exponents, and the
/// origin is subtracted in 64 bits before anything is rounded to 32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// What lies at 0, in input units: of a box, the place nearest to its centre that is a whole number
    /// of [`Frame::step`]s along each axis, or the centre where that is too far off to count in steps.
    pub origin: DVec3,
    /// Power of two: one model unit is `2^exponent` input units.
    pub exponent: i32,
}

/// Exponents outside `-LIMIT..=LIMIT` are refused: `2^exponent` must be a normal `f64`.
pub const EXPONENT_LIMIT: i32 = 1000;

/// Steps of the origin in a model unit: few, so that a file tells it in few bytes. One is less than the
/// default error bound, half of one at most a quarter of a pixel where a model fills 512.
const ORIGIN_STEPS: f64 = 1024.0;

/// Whole numbers from here on are no longer apart by one in 64 bits.
const MOST_STEPS: f64 = (1_u64 << 53) as f64;

impl Frame {
    /// The frame of a box given by its least and greatest corner.
    ///
    /// A box without extent (one point) gets exponent 0.
    #[must_use]
    pub fn of_box(min: DVec3, max: DVec3) -> Self {
        // Halved first: the sum of two finite coordinates may overflow.
        let center = 0.5 * min + 0.5 * max;
        let half = (0.5 * max - 0.5 * min).max_element();
        // frexp gives half = m * 2^e with m in [0.5, 1), so half / 2^e <= 1.
        let least = if half > 0.0 { libm::frexp(half).1 } else { 0 };
        let tight = Self::near(center, least);
        let reach = tight.to_model(min).abs().max(tight.to_model(max).abs()).max_element();
        // What fills the cube to the brim may leave it when the origin is rounded.
        if reach <= 1.0 { tight } else { Self::near(center, least + 1) }
    }

    /// The frame of this exponent, or the nearest within the limit, whose origin is nearest to a place.
    fn near(place: DVec3, exponent: i32) -> Self {
        let exponent = exponent.clamp(-EXPONENT_LIMIT, EXPONENT_LIMIT);
        let frame = Self { origin: place, exponent };
        let steps = place / frame.step();
        if steps.abs().max_element() < MOST_STEPS {
            // Adding 0 makes -0 one.
            Self { origin: steps.round() * frame.step() + 0.0, exponent }
        } else {
            frame
        }
    }

    /// Input units in one step of the origin.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.scale() / ORIGIN_STEPS
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
    fn the_origin_is_a_whole_number_of_steps_near_the_centre() {
        for size in [1e-12, 0.3, 1.0, 7.7e11] {
            let at = DVec3::new(70.1, -3.3, 0.0) * size;
            let frame = Frame::of_box(at, at + DVec3::new(size, 0.7 * size, 0.0));
            let steps = frame.origin / frame.step();
            assert_eq!(steps, steps.round());
            let off = frame.to_model(at + DVec3::new(0.5, 0.35, 0.0) * size);
            assert!(off.abs().max_element() <= 0.5 / ORIGIN_STEPS + 1e-12, "{size}: {off}");
        }
        // Too far off to count: the centre as it is.
        let far = DVec3::new(1e300, 0.0, 0.0);
        let frame = Frame::of_box(far - DVec3::Y, far + DVec3::Y);
        assert_eq!((frame.origin, frame.exponent), (far, 1));
    }

    #[test]
    fn a_box_to_the_brim_stays_within_the_unit_cube() {
        // Of nearly two units and off the steps by nearly half of one.
        let (min, max) =
            (DVec3::splat(0.499 / ORIGIN_STEPS - 0.9999), DVec3::splat(0.499 / ORIGIN_STEPS + 0.9999));
        let frame = Frame::of_box(min, max);
        assert_eq!((frame.origin, frame.exponent), (DVec3::ZERO, 1));
        assert_eq!(Frame::of_box(min + 0.001, max).exponent, 0);
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
