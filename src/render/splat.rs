//! A splat made ready for one camera.

use glam::{DMat3, DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::composite;
use super::constants::{self, MATTE};
use super::eye::{Eye, Ray};
use super::partner::{self, LocalPartner, locals};
use super::project::{self, Bound, Prism};
use super::shade;
use super::tiles::{Hit, Look, Scene};
use crate::model::asset::Asset;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::intersect::{self, LocalRay};
use crate::model::splat::Splat;

/// A splat in view coordinates, with all that does not change from ray to ray.
#[derive(Clone, Debug)]
struct Cap {
    tint: usize,
    center: DVec3,
    /// Columns `i, j, k` in view coordinates.
    axes: DMat3,
    radii: DVec2,
    inverse_radii: DVec2,
    curvature: DVec2,
    reach: f64,
    near: f64,
    /// Clip curves over the unit disc.
    clips: Vec<Conic>,
    /// Clip partners, in groups.
    partners: Vec<Vec<LocalPartner>>,
    color: Vec3,
    low: f64,
    high: f64,
}

/// All splats of an asset, ready for one camera.
#[derive(Debug)]
pub struct Caps<'a> {
    eye: &'a Eye,
    caps: Vec<Cap>,
    /// How near to a clip curve a place gives way.
    yielding: f64,
    /// How far along the normal it does on the curve.
    gives_way: f64,
}

/// A clip curve over the unit disc, to which the inside test is indifferent: an affine map
/// scales all its areas alike.
#[must_use]
pub fn unit_conic(clip: &ClipCurve, radii: DVec2) -> Conic {
    let Conic { p1, p2, p3, rho } = clip.conic(radii);
    Conic { p1: p1 / radii, p2: p2 / radii, p3: p3 / radii, rho }
}

/// Linear colour of a splat.
#[must_use]
pub fn linear_color(splat: &Splat, has_colors: bool) -> Vec3 {
    if has_colors {
        Vec3::from(splat.color.map(shade::linear_from_byte))
    } else {
        DVec3::from(MATTE).as_vec3()
    }
}

/// Least and greatest height of a splat over its domain: 0 and the sagittas of both axes.
#[must_use]
pub fn heights(splat: &Splat) -> [f64; 2] {
    let sagitta = splat.curvature * splat.radii * splat.radii;
    [sagitta.min_element().min(0.0), sagitta.max_element().max(0.0)]
}

impl Cap {
    /// Makes a splat ready.
    fn new(splat: &Splat, eye: &Eye, has_colors: bool) -> Self {
        let center = eye.to_view(splat.center);
        let axes = DMat3::from_cols(
            eye.turn(splat.axes.x_axis),
            eye.turn(splat.axes.y_axis),
            eye.turn(splat.axes.z_axis),
        );
        let [low, high] = heights(splat);
        Self {
            tint: constants::tint(splat),
            center,
            axes,
            radii: splat.radii,
            inverse_radii: splat.radii.recip(),
            curvature: splat.curvature,
            reach: splat.bounding_radius(),
            near: eye.near - center.z,
            clips: splat.clips.iter().map(|clip| unit_conic(clip, splat.radii)).collect(),
            partners: splat.partners.iter().map(|group| locals(group, splat)).collect(),
            color: linear_color(splat, has_colors),
            low,
            high,
        }
    }

    /// From view to splat coordinates.
    fn to_local(&self, direction: DVec3) -> DVec3 {
        DVec3::new(
            self.axes.x_axis.dot(direction),
            self.axes.y_axis.dot(direction),
            self.axes.z_axis.dot(direction),
        )
    }

    /// The hit at a ray's parameter, if the splat is there.
    fn covered(&self, ray: &LocalRay, s: f64) -> Option<Hit> {
        if !(s >= self.near && s <= self.reach) {
            return None;
        }
        let uv = ray.at(s).truncate();
        let unit = uv * self.inverse_radii;
        let ellipse = unit.length_squared();
        let inside = ellipse <= 1.0
            && !self.clips.iter().any(|clip| clip.cuts(unit))
            && !partner::clipped_away(&self.partners, ray.at(s));
        inside.then_some(Hit { depth: self.center.z + s, at: uv, ellipse, gives_way: 0.0 })
    }

    /// How far a place of the splat lies from the nearest clip curve.
    fn clearance(&self, at: DVec2) -> f64 {
        let distance = |clip: &Conic| clip.distance(at * self.inverse_radii, self.radii);
        self.clips.iter().map(distance).fold(f64::INFINITY, f64::min)
    }
}

impl<'a> Caps<'a> {
    /// Makes an asset ready for a camera.
    #[must_use]
    pub fn new(asset: &Asset, eye: &'a Eye) -> Self {
        let caps = asset.splats.par_iter().map(|splat| Cap::new(splat, eye, asset.has_colors)).collect();
        let gives_way = constants::YIELD_SHARE * constants::band(asset);
        Self { eye, caps, yielding: constants::yielding(asset), gives_way }
    }
}

impl Scene for Caps<'_> {
    fn len(&self) -> usize {
        self.caps.len()
    }

    fn bound(&self, item: usize) -> Option<Bound> {
        let cap = &self.caps[item];
        let half_axes = [cap.radii.x * cap.axes.x_axis, cap.radii.y * cap.axes.y_axis];
        let (normal, low, high) = (cap.axes.z_axis, cap.low, cap.high);
        project::bound(&Prism { center: cap.center, half_axes, normal, low, high }, self.eye)
    }

    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit> {
        let cap = &self.caps[item];
        let lateral = ray.at(cap.center.z) - cap.center.truncate();
        let local =
            LocalRay { origin: cap.to_local(lateral.extend(0.0)), direction: cap.to_local(ray.direction()) };
        let hit = |s: f64| cap.covered(&local, s);
        let found = if cap.curvature == DVec2::ZERO {
            hit(intersect::plane_root(&local, cap.reach))
        } else {
            let [first, second] = intersect::quadric_roots(cap.curvature, &local, cap.reach);
            hit(first).or_else(|| hit(second))
        }?;
        let distance = cap.clearance(found.at) / self.yielding;
        if distance >= constants::YIELD_BEHIND {
            // Most are: far from any curve nothing gives way.
            return Some(found);
        }
        let normal = self.look(item, found.at).normal;
        let gives_way = composite::depth_yielded(distance, self.gives_way, normal, ray.direction());
        Some(Hit { gives_way, ..found })
    }

    fn look(&self, item: usize, at: DVec2) -> Look {
        let cap = &self.caps[item];
        let slope = -2.0 * cap.curvature * at;
        Look { normal: (cap.axes * slope.extend(1.0)).normalize(), color: cap.color }
    }

    fn tint(&self, item: usize) -> usize {
        self.caps[item].tint
    }
}
