//! The splat: an elliptical piece of a quadric, cut by conics.
//!
//! Ivo 2020, section 4.1. In splat coordinates `u = (X-C)·i, v = (X-C)·j, w = (X-C)·k` the
//! surface is `w = a u² + b v²` over `(u/r_u)² + (v/r_v)² <= 1`, less what the clip curves
//! cut away. There is no `uv` term, because `i, j` are the principal directions, and no
//! linear term, because `k` is the normal at `C`.

use glam::{DMat3, DVec2, DVec3};

use super::clip_curve::{ClipCurve, Conic};
use super::partner::{self, Group};

/// One splat, in model units.
#[derive(Clone, Debug, PartialEq)]
pub struct Splat {
    /// `C`, on the surface.
    pub center: DVec3,
    /// Columns `i, j, k`: orthonormal, right-handed, `k` the outward normal at `C`.
    pub axes: DMat3,
    /// `(r_u, r_v)`, both positive. `r_u` may be the smaller one.
    pub radii: DVec2,
    /// `(a, b)`, half the principal curvatures, per model unit. Zero for a flat splat.
    pub curvature: DVec2,
    /// What is cut away is the union of what each cuts; usually none or one.
    pub clips: Vec<ClipCurve>,
    /// Splats across an edge that cut it too, in groups; usually none.
    pub partners: Vec<Group>,
    /// Mean colour of what it covers, sRGB; white when the asset has no colours.
    pub color: [u8; 3],
}

/// Covers the rounding of the few operations between a splat's numbers and its rim.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// What a splat is a piece of: the fewer curvatures, the less its record costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// A piece of a plane: both curvatures are zero.
    Flat,
    /// A piece of a parabolic cylinder: exactly one curvature is zero.
    Cylinder,
    /// A piece of a quadric that bends both ways: no curvature is zero.
    Quadric,
}

impl Splat {
    /// Its kind, by how many of its curvatures are zero.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self.curvature.to_array().map(|curvature| curvature == 0.0) {
            [true, true] => Kind::Flat,
            [false, false] => Kind::Quadric,
            _ => Kind::Cylinder,
        }
    }

    /// A point of space in splat coordinates `(u, v, w)`.
    #[must_use]
    pub fn to_local(&self, point: DVec3) -> DVec3 {
        self.axes.transpose() * (point - self.center)
    }

    /// Splat coordinates as a point of space.
    #[must_use]
    pub fn to_model(&self, local: DVec3) -> DVec3 {
        self.center + self.axes * local
    }

    /// Height of the quadric over the tangent plane, `w(u,v)`.
    #[must_use]
    pub fn height(&self, uv: DVec2) -> f64 {
        (self.curvature * uv * uv).element_sum()
    }

    /// The point of the quadric over `(u, v)`, in space.
    #[must_use]
    pub fn surface_point(&self, uv: DVec2) -> DVec3 {
        self.to_model(uv.extend(self.height(uv)))
    }

    /// The unit normal of the quadric over `(u, v)`, in space.
    #[must_use]
    pub fn normal(&self, uv: DVec2) -> DVec3 {
        let slope = -2.0 * self.curvature * uv;
        (self.axes * slope.extend(1.0)).normalize()
    }

    /// Squared distance from the centre in units of the ellipse: at most 1 inside.
    #[must_use]
    pub fn ellipse(&self, uv: DVec2) -> f64 {
        (uv / self.radii).length_squared()
    }

    /// Whether `(u, v)` lies in the ellipse and neither clip curve nor partner cuts it away.
    #[must_use]
    pub fn covers(&self, uv: DVec2) -> bool {
        self.ellipse(uv) <= 1.0
            && !self.clips.iter().any(|clip| clip.cuts(uv, self.radii))
            && !self.partners_cut(uv)
    }

    /// Whether the partners cut the place of the quadric over `(u, v)` away.
    #[must_use]
    pub fn partners_cut(&self, uv: DVec2) -> bool {
        !self.partners.is_empty() && partner::cuts(&self.partners, self.surface_point(uv))
    }

    /// Its clip curves, worked out for many tests.
    #[must_use]
    pub fn conics(&self) -> Vec<Conic> {
        self.clips.iter().map(|clip| clip.conic(self.radii)).collect()
    }

    /// Whether anything cuts it.
    #[must_use]
    pub fn is_clipped(&self) -> bool {
        !self.clips.is_empty() || !self.partners.is_empty()
    }

    /// Radius of the least sphere around `C` that is sure to hold the whole splat.
    #[must_use]
    pub fn bounding_radius(&self) -> f64 {
        let sagitta = self.curvature.abs() * self.radii * self.radii;
        // Over the unit disc, |w| is at most the greater of the two sagittas.
        libm::hypot(self.radii.max_element(), sagitta.max_element()) * (1.0 + ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bowl() -> Splat {
        Splat {
            center: DVec3::new(0.1, 0.2, 0.3),
            axes: DMat3::from_rotation_y(0.4),
            radii: DVec2::new(0.5, 0.25),
            curvature: DVec2::new(-1.0, 0.5),
            clips: Vec::new(),
            partners: Vec::new(),
            color: [255; 3],
        }
    }

    #[test]
    fn the_normal_is_the_gradient_of_the_surface() {
        let splat = bowl();
        let uv = DVec2::new(0.2, -0.1);
        let step = 1e-6;
        let du = splat.surface_point(uv + DVec2::X * step) - splat.surface_point(uv - DVec2::X * step);
        let dv = splat.surface_point(uv + DVec2::Y * step) - splat.surface_point(uv - DVec2::Y * step);
        let across = du.cross(dv).normalize();
        assert!(across.distance(splat.normal(uv)) < 1e-8);
    }

    #[test]
    fn the_kind_is_how_many_curvatures_are_zero() {
        let kind = |a: f64, b: f64| Splat { curvature: DVec2::new(a, b), ..bowl() }.kind();
        assert_eq!([kind(0.0, 0.0), kind(0.0, -0.0)], [Kind::Flat; 2]);
        assert_eq!([kind(1e-300, 0.0), kind(0.0, -2.0)], [Kind::Cylinder; 2]);
        assert_eq!([kind(1.0, 1.0), kind(-1e-300, 2.0)], [Kind::Quadric; 2]);
    }

    #[test]
    fn the_bounding_sphere_holds_the_rim() {
        let splat = bowl();
        for step in 0..64 {
            let (sin, cos) = libm::sincos(f64::from(step) * 0.1);
            let rim = splat.surface_point(splat.radii * DVec2::new(cos, sin));
            assert!(rim.distance(splat.center) <= splat.bounding_radius());
        }
    }
}
