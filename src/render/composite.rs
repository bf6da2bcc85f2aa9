//! How the splats of a pixel come together; twin of `composite.wgsl`.
//!
//! Botsch et al. 2005: what the nearest hit sees decides depth and identity; normals and
//! colours are the weighted mean over the splats of the same surface there.

use glam::{DVec3, Vec3};

use super::constants::{COSINE_FLOOR, RIM_WEIGHT, SINE_FLOOR, YIELD_BEHIND};

/// Weight of a hit by its squared distance from the centre in units of the ellipse: 1 at the
/// centre, falling smoothly to [`RIM_WEIGHT`] at the rim.
#[must_use]
pub fn weight(ellipse: f64) -> f64 {
    let inside = (1.0 - ellipse).max(0.0);
    RIM_WEIGHT + (1.0 - RIM_WEIGHT) * inside * inside
}

/// How much deeper than the visible hit another may lie along the ray and still be of the
/// same surface: the band along the normal, seen at the ray's slant.
///
/// `direction` is the ray for each unit of view depth, `normal` the visible unit normal.
#[must_use]
pub fn depth_band(band: f64, normal: DVec3, direction: DVec3) -> f64 {
    let along = normal.dot(direction).abs();
    band / along.max(COSINE_FLOOR * direction.length())
}

/// How much deeper what lies across a line may be seen instead of a place so far, in `reach`, from its curve:
/// on the curve `width` along the surface, as deep as the ray goes on that way, from one reach on nothing.
///
/// What is seen from behind gives way by all that anything may.
#[must_use]
pub fn depth_yielded(distance: f64, width: f64, normal: DVec3, direction: DVec3) -> f64 {
    let least = SINE_FLOOR * direction.length();
    if normal.dot(direction) > 0.0 {
        return f64::from(distance < YIELD_BEHIND) * width / least;
    }
    let aside = direction.reject_from_normalized(normal).length();
    (1.0 - distance).max(0.0) * width / aside.max(least)
}

/// A normal turned towards the eye.
#[must_use]
pub fn face(normal: DVec3, direction: DVec3) -> DVec3 {
    if normal.dot(direction) > 0.0 { -normal } else { normal }
}

/// The weighted sums of one pixel, and whose part is the greatest.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    normal: DVec3,
    color: Vec3,
    weight: f64,
    least_ellipse: f64,
    /// The item seen nearest its centre: it stands for the pixel. Which of several splats of
    /// one surface is hit first is decided by their errors, and by rounding in a plane.
    pub item: usize,
}

impl Blend {
    /// Nothing yet but the item that was hit first.
    #[must_use]
    pub fn new(item: usize) -> Self {
        Self { normal: DVec3::ZERO, color: Vec3::ZERO, weight: 0.0, least_ellipse: f64::INFINITY, item }
    }

    /// Adds a hit, whose `ellipse` is as in [`weight`].
    pub fn add(&mut self, item: usize, ellipse: f64, normal: DVec3, color: Vec3) {
        let weight = weight(ellipse);
        if ellipse < self.least_ellipse {
            (self.least_ellipse, self.item) = (ellipse, item);
        }
        self.normal += weight * normal;
        self.color += weight as f32 * color;
        self.weight += weight;
    }

    /// Mean unit normal and mean colour. Normals that agree within 30 degrees of one of them
    /// cannot cancel.
    #[must_use]
    pub fn mean(&self) -> (DVec3, Vec3) {
        (self.normal.normalize_or_zero(), self.color / self.weight.max(f64::MIN_POSITIVE) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steep_ray_sees_deeper_across_a_line_and_none_sees_the_other_side_from_behind() {
        let yielded = |distance: f64, lean: f64, up: f64| {
            depth_yielded(distance, 1.0, up * DVec3::NEG_Z, DVec3::new(lean, 0.0, 1.0))
        };
        assert!((yielded(0.0, 1.0, 1.0) - 1.0).abs() < 1e-12, "at 45 degrees as deep as wide");
        assert!((yielded(0.0, 0.8, 1.0) - 1.25).abs() < 1e-12, "a quarter deeper at 0.8 of the slope");
        assert!((yielded(0.5, 1.0, 1.0) - 0.5).abs() < 1e-12, "half as deep half a reach from the curve");
        assert_eq!((yielded(1.1, 0.5, 1.0), yielded(2.1, 0.5, -1.0)), (0.0, 0.0), "nothing farther off");
        let most = yielded(0.0, 0.0, 1.0);
        assert!((most - 1.0 / SINE_FLOOR).abs() < 1e-12, "but not without end");
        assert!(yielded(1.1, 0.0, -1.0) >= most, "from behind it is the most");
    }
}
