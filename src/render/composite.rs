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

/// How much deeper what lies across a line may be seen instead of a place on its curve: `width` along the
/// surface, from the curve inwards, as deep as the ray goes on that way.
#[must_use]
pub fn depth_yielded(width: f64, normal: DVec3, direction: DVec3) -> f64 {
    let aside = direction.reject_from_normalized(normal).length();
    width / aside.max(SINE_FLOOR * direction.length())
}

/// By which share of all that it may, a place so far from the nearest clip curve gives way: 1 on the curve,
/// 0 from `reach` on. `behind` tells whether it is seen from behind.
#[must_use]
pub fn yield_share(distance: f64, reach: f64, behind: bool) -> f64 {
    if behind { f64::from(distance < YIELD_BEHIND * reach) } else { (1.0 - distance / reach).max(0.0) }
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
