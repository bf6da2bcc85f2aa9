//! Moves and turns a splat's frame until the quadric over it has only its two squares left.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat3, DVec2, DVec3, Vec2Swizzles};

use super::quadric::{Height, Moments, NONE_LEFT, RIDGE};

/// Where a splat stands: a point and an orthonormal frame `(i, j, k)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// The point `C`.
    pub center: DVec3,
    /// Columns `i, j, k`.
    pub axes: DMat3,
}

impl Pose {
    /// A pose at a point with a normal and some tangent, the same for equal arguments.
    #[must_use]
    pub fn at(center: DVec3, normal: DVec3) -> Self {
        let k = normal.normalize_or(DVec3::Z);
        // The coordinate axis least along k gives the best conditioned cross product.
        let a = k.abs();
        let aside = if a.x <= a.y && a.x <= a.z {
            DVec3::X
        } else if a.y <= a.z {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let i = k.cross(aside).normalize();
        Self { center, axes: DMat3::from_cols(i, k.cross(i), k) }
    }

    /// A point of space in this frame.
    #[must_use]
    pub fn to_local(&self, point: DVec3) -> DVec3 {
        self.axes.transpose() * (point - self.center)
    }

    /// Moves the centre onto the surface and turns `k` to its normal there.
    #[must_use]
    pub fn settled(&self, height: &Height) -> Self {
        let [i, _, k] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        let normal = (self.axes * DVec3::new(-height.c, -height.d, 1.0)).normalize();
        let tangent = (i - normal * i.dot(normal)).normalize_or(self.axes.y_axis);
        Self {
            center: self.center + height.h * k,
            axes: DMat3::from_cols(tangent, normal.cross(tangent), normal),
        }
    }

    /// Turns `i, j` about `k` by an angle.
    #[must_use]
    pub fn turned(&self, theta: f64) -> Self {
        let (sin, cos) = libm::sincos(theta);
        let [i, j, k] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        Self { center: self.center, axes: DMat3::from_cols(cos * i + sin * j, cos * j - sin * i, k) }
    }
}

/// A quadric in its principal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// The frame, `k` normal to the quadric at its centre.
    pub pose: Pose,
    /// `(a, b)`.
    pub curvature: DVec2,
    /// How many of the fit's six terms the points determined.
    pub rank: u8,
}

/// Which surfaces a splat may be a piece of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shapes {
    /// Quadrics, and planes where those do.
    #[default]
    All,
    /// Planes alone, for comparison.
    Flat,
}

/// Rounds of fitting and turning. Each squares the slope that is left, so two leave nothing
/// that matters of a frame that starts within a few degrees; a third serves bad starts.
const ROUNDS: usize = 3;

/// Rounds that do for a frame that stands well.
const FEW_ROUNDS: usize = 2;

/// Which way the axes of a quadric lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The principal ways of the best quadric.
    Principal,
    /// As at the start: of the quadrics with these axes it is the best.
    Held,
}

impl Axes {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Principal, Self::Held];
}

/// How a quadric is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitting {
    /// What it may be.
    pub shapes: Shapes,
    /// About how far the points lie from the start, positive; the unit of the sums.
    pub radius: f64,
    /// The difference of `a` and `b`, per model unit, from which `i, j` leave the start's
    /// directions for the principal ones, which would be noise where the two differ by less.
    pub least: f64,
    /// The weight, a point, of keeping the second-order terms small: see [`RIDGE`].
    pub ridge: f64,
    /// Which way its axes lie.
    pub axes: Axes,
    /// Rounds of fitting and turning, at least one.
    pub rounds: usize,
}

impl Fitting {
    /// A fit of anything to points within `radius`, its axes always the principal ones.
    #[must_use]
    pub fn within(radius: f64) -> Self {
        Self { shapes: Shapes::All, radius, least: 0.0, ridge: RIDGE, axes: Axes::Principal, rounds: ROUNDS }
    }

    /// The same fit from a start that stands well: near the surface, its `k` within a few degrees of the
    /// normal there.
    #[must_use]
    pub fn again(&self) -> Self {
        Self { rounds: FEW_ROUNDS, ..*self }
    }
}

/// Fits a quadric to weighted points, from a first pose, and brings it into its principal frame.
///
/// Where only planes are wanted, the plane is fitted, and `i, j` are still the principal
/// directions of the points: along these an ellipse of a plane reaches farthest, too.
#[must_use]
pub fn principal(
    start: &Pose,
    fitting: &Fitting,
    points: impl Iterator<Item = (DVec3, f64)> + Clone,
) -> Principal {
    let &Fitting { shapes, radius, least, ridge, axes, rounds } = fitting;
    let mixed = if axes == Axes::Held { NONE_LEFT } else { ridge };
    let mut pose = *start;
    let mut height = Height::default();
    for round in 0..rounds {
        let mut moments = Moments::new(radius);
        for (point, weight) in points.clone() {
            let local = pose.to_local(point);
            moments.add(local.x, local.y, local.z, weight);
        }
        height = moments.solve(ridge, mixed);
        if shapes == Shapes::Flat {
            let Height { h, c, d, .. } = moments.solve_plane();
            height = Height { h, c, d, ..height };
        }
        if round + 1 < rounds {
            pose = pose.settled(&height);
        }
    }
    pose.center += height.h * pose.axes.z_axis;
    let difference = height.a - height.b;
    if libm::hypot(difference, height.e) > least {
        let mut theta = 0.5 * libm::atan2(height.e, difference);
        let (mean, half) = (0.5 * (height.a + height.b), 0.5 * libm::hypot(difference, height.e));
        let mut curvature = DVec2::new(mean + half, mean - half);
        // Of the two ways to name the axes, the one that turns less.
        if theta.abs() > FRAC_PI_4 {
            theta -= FRAC_PI_2.copysign(theta);
            curvature = curvature.yx();
        }
        return Principal { pose: pose.turned(theta), curvature: kept(shapes, curvature), rank: height.rank };
    }
    let curvature = kept(shapes, DVec2::new(height.a, height.b));
    Principal { pose, curvature, rank: height.rank }
}

/// How far along `k` a place in splat coordinates lies above the quadric.
#[must_use]
pub fn above(curvature: DVec2, local: DVec3) -> f64 {
    let uv = local.truncate();
    local.z - (curvature * uv * uv).element_sum()
}

/// Distance along `k` of a place in splat coordinates from the quadric.
#[must_use]
pub fn miss(curvature: DVec2, local: DVec3) -> f64 {
    above(curvature, local).abs()
}

/// How far the farthest of some points lies, along `k`, from the quadric fitted to them; `normal`
/// is about its normal. 0 for fewer than two points.
#[must_use]
pub fn misfit(points: &[DVec3], normal: DVec3) -> f64 {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let radius = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
    if radius == 0.0 {
        return 0.0;
    }
    let weighted = points.iter().map(|&point| (point, 1.0));
    let Principal { pose, curvature, .. } =
        principal(&Pose::at(middle, normal), &Fitting::within(radius), weighted);
    points.iter().map(|&point| miss(curvature, pose.to_local(point))).fold(0.0, f64::max)
}

/// The curvature that a splat of these shapes keeps.
fn kept(shapes: Shapes, curvature: DVec2) -> DVec2 {
    match shapes {
        Shapes::All => curvature,
        Shapes::Flat => DVec2::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_ellipsoid_patch_comes_back_in_its_principal_frame() {
        let plant = Pose::at(DVec3::new(0.2, -0.1, 0.4), DVec3::new(1.0, 2.0, 0.5)).turned(0.7);
        let curvature = DVec2::new(1.5, -0.4);
        let points: Vec<DVec3> = (0..200)
            .map(|n| {
                let (sin, cos) = libm::sincos(2.4 * f64::from(n));
                let uv = 0.1 * (f64::from(n) / 200.0).sqrt() * DVec2::new(cos, sin);
                plant.center + plant.axes * uv.extend((curvature * uv * uv).element_sum())
            })
            .collect();
        let start =
            Pose::at(plant.center + 0.01 * plant.axes.z_axis, plant.axes.z_axis + 0.2 * plant.axes.x_axis);
        let found = principal(&start, &Fitting::within(0.1), points.iter().map(|&point| (point, 1.0)));
        let same = if (found.curvature - curvature).length() < (found.curvature - curvature.yx()).length() {
            found.pose.axes.x_axis
        } else {
            found.pose.axes.y_axis
        };
        let sorted = DVec2::new(found.curvature.max_element(), found.curvature.min_element());
        assert!((sorted - curvature).length() < 2e-3, "{:?}", found.curvature);
        // The centre moved along a tilted k: compare with the planted surface right there.
        let at = plant.to_local(found.pose.center);
        assert!((at.z - (curvature * at.truncate() * at.truncate()).element_sum()).abs() < 1e-5);
        let normal = (plant.axes * (-2.0 * curvature * at.truncate()).extend(1.0)).normalize();
        assert!(found.pose.axes.z_axis.distance(normal) < 1e-3);
        assert!(same.dot(plant.axes.x_axis).abs() > 1.0 - 1e-4);
        assert!((found.pose.axes.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_plane_over_a_ridge_lies_along_it() {
        let plant = Pose::at(DVec3::new(0.2, -0.1, 0.4), DVec3::new(1.0, 2.0, 0.5)).turned(0.7);
        let points: Vec<DVec3> = (0..200)
            .map(|n| {
                let (sin, cos) = libm::sincos(2.4 * f64::from(n));
                let uv = 0.1 * (f64::from(n) / 200.0).sqrt() * DVec2::new(cos, sin);
                plant.center + plant.axes * uv.extend(2.0 * uv.x * uv.x)
            })
            .collect();
        let weighted = points.iter().map(|&point| (point, 1.0));
        let start = Pose::at(plant.center, plant.axes.z_axis + 0.1 * plant.axes.y_axis);
        let found = principal(&start, &Fitting { shapes: Shapes::Flat, ..Fitting::within(0.1) }, weighted);
        assert_eq!(found.curvature, DVec2::ZERO);
        assert!(found.pose.axes.z_axis.dot(plant.axes.z_axis) > 1.0 - 1e-5);
        let along = |axis: DVec3| axis.dot(plant.axes.x_axis).abs();
        let axes = [found.pose.axes.x_axis, found.pose.axes.y_axis].map(along);
        assert!(axes.into_iter().any(|a| a > 1.0 - 1e-4), "{axes:?}");
        // The mean of x² over the disc is a quarter of its square radius.
        let height = plant.to_local(found.pose.center).z;
        assert!((height - 2.0 * 0.25 * 0.01).abs() < 2e-4, "{height}");
    }

    #[test]
    fn axes_that_are_held_stay_whatever_the_surface_does() {
        let start = Pose::at(DVec3::ZERO, DVec3::Z);
        let places = (0..400_u32).map(|n| [n % 20, n / 20].map(|at| 0.1 * (f64::from(at) - 9.5)));
        let twisted =
            places.map(|[u, v]| start.axes * DVec3::new(u, v, 0.3 * u * u + 0.1 * u * v - 0.2 * v * v));
        let weighted = twisted.map(|point| (point, 1.0));
        let found =
            |axes: Axes| principal(&start, &Fitting { axes, ..Fitting::within(1.0) }, weighted.clone());
        let held = found(Axes::Held);
        assert!(held.pose.axes.x_axis.distance(start.axes.x_axis) < 1e-6, "{held:?}");
        assert!(held.curvature.distance(DVec2::new(0.3, -0.2)) < 1e-6, "{held:?}");
        let turn = found(Axes::Principal).pose.axes.x_axis.angle_between(start.axes.x_axis);
        assert!((turn - 0.5 * libm::atan2(0.1, 0.5)).abs() < 1e-6, "{turn}");
    }
}
