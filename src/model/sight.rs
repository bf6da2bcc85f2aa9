//! Lines of sight to a surface.

use glam::DVec3;

use super::intersect::{LocalRay, plane_root, quadric_roots};
use super::splat::{Kind, Splat};

/// A ray that meets a surface, and that splats in the surface's stead have to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Where the ray meets the surface first, or where it is stopped if it passes beside that, model units.
    pub at: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// How far beyond that place the ray may go before it counts as not stopped, model units.
    pub beyond: f64,
}

/// Rays that splats in a surface's stead treat otherwise than the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// Those that meet the surface and that no splat stops.
    pub open: Vec<Sight>,
    /// Those that pass beside the surface and that a splat stops, however far beyond.
    pub beside: Vec<Sight>,
}

impl Sight {
    /// Whether a splat stops the ray soon enough.
    #[must_use]
    pub fn is_stopped(&self, splat: &Splat) -> bool {
        let (reach, to_center) = (splat.bounding_radius(), splat.center - self.at);
        let ahead = to_center.dot(self.direction);
        let nearest = self.at + ahead * self.direction;
        if nearest.distance_squared(splat.center) > reach * reach || ahead - reach > self.beyond {
            return false;
        }
        let ray =
            LocalRay { origin: splat.to_local(nearest), direction: splat.axes.transpose() * self.direction };
        let roots = match splat.kind() {
            Kind::Flat => [plane_root(&ray, reach); 2],
            Kind::Cylinder | Kind::Quadric => quadric_roots(splat.curvature, &ray, reach),
        };
        let met = |s: f64| s.is_finite() && ahead + s <= self.beyond && splat.covers(ray.at(s).truncate());
        roots.into_iter().any(met)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec2};

    /// A bowl that opens along `+z`, its bottom at the origin.
    fn bowl() -> Splat {
        Splat {
            center: DVec3::ZERO,
            axes: DMat3::IDENTITY,
            radii: DVec2::new(1.0, 0.5),
            curvature: DVec2::new(1.0, 2.0),
            clips: Vec::new(),
            partners: Vec::new(),
            color: [u8::MAX; 3],
        }
    }

    fn from_above(x: f64, y: f64, beyond: f64) -> Sight {
        Sight { at: DVec3::new(x, y, 2.0), direction: DVec3::NEG_Z, beyond }
    }

    #[test]
    fn a_ray_is_stopped_within_the_rim_and_not_too_late() {
        assert!(
            from_above(0.9, 0.0, 2.0).is_stopped(&bowl()) && !from_above(1.1, 0.0, 9.0).is_stopped(&bowl())
        );
        assert!(!from_above(0.0, 0.6, 9.0).is_stopped(&bowl()), "beyond the shorter radius");
        assert!(
            from_above(0.5, 0.0, 1.8).is_stopped(&bowl()) && !from_above(0.5, 0.0, 1.7).is_stopped(&bowl())
        );
    }

    #[test]
    fn the_far_wall_stops_what_passes_over_the_rim() {
        let level = Sight { at: DVec3::new(-3.0, 0.0, 0.25), direction: DVec3::X, beyond: 9.0 };
        assert!(level.is_stopped(&bowl()));
        assert!(!Sight { at: level.at.with_z(1.1), ..level }.is_stopped(&bowl()), "it passes above");
        assert!(!Sight { beyond: 2.4, ..level }.is_stopped(&bowl()), "the near wall lies at 2.5");
        let flat = Splat { curvature: DVec2::ZERO, ..bowl() };
        assert!(!level.is_stopped(&flat), "along a plane");
    }
}
