//! A few points of a cloud and the quadric through them.

use glam::{DVec2, DVec3, Vec3};

use crate::analyse::cloud_normals::plane;
use crate::fit::pose::{Fitting, Pose, Principal, above, principal};

/// What a quadric in its frame takes from the points it is fitted to: six of the fit's terms.
const TERMS: usize = 6;

/// Points of a patch that are compared with their neighbours.
const COMPARED: usize = 64;

/// The quadric of least squares through some points, the first of which is the one of interest.
pub(super) struct Patch {
    quadric: Principal,
}

impl Patch {
    pub(super) fn of(points: &[Vec3]) -> Self {
        let here = points[0].as_dvec3();
        let radius = points.iter().map(|point| point.as_dvec3().distance(here)).fold(0.0, f64::max);
        let normal = plane(points, 0, 1..points.len() as u32).normal.as_dvec3();
        let weighted = points.iter().map(|point| (point.as_dvec3(), 1.0));
        // Points of one place have no radius; any unit does for them.
        let fitting = Fitting::within(if radius > 0.0 { radius } else { 1.0 });
        Self { quadric: principal(&Pose::at(here, normal), &fitting, weighted) }
    }

    /// Standard deviations of the points that it was fitted to: of the distances between neighbours,
    /// and of those from the quadric.
    pub(super) fn scatter(&self, points: &[Vec3]) -> [f64; 2] {
        let Principal { pose, curvature, .. } = self.quadric;
        let places: Vec<(DVec2, f64)> = points
            .iter()
            .map(|point| pose.to_local(point.as_dvec3()))
            .map(|local| (local.truncate(), above(curvature, local)))
            .collect();
        // Neighbours to the side: the nearest in space would be those that stray alike.
        let beside = |n: usize| {
            let away = |other: usize| places[other].0.distance_squared(places[n].0);
            let others = (0..places.len()).filter(|&other| other != n);
            others.min_by(|&a, &b| away(a).total_cmp(&away(b)))
        };
        let compared = (0..places.len()).step_by(places.len().div_ceil(COMPARED));
        let differences: Vec<f64> =
            compared.filter_map(|n| Some(places[n].1 - places[beside(n)?].1)).collect();
        let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
        let whole = squares(&mut places.iter().map(|place| place.1)) / (points.len() - TERMS) as f64;
        let freedom = (points.len() - TERMS) as f64 / points.len() as f64;
        let between = 0.5 * squares(&mut differences.iter().copied()) / differences.len().max(1) as f64;
        [(between / freedom).sqrt(), whole.sqrt()]
    }

    /// The place on the quadric over or under a point, and the normal there.
    pub(super) fn foot(&self, point: Vec3) -> (DVec3, DVec3) {
        let Principal { pose, curvature, .. } = self.quadric;
        let uv = pose.to_local(point.as_dvec3()).truncate();
        let place = pose.center + pose.axes * uv.extend((curvature * uv * uv).element_sum());
        let normal = pose.axes * (-2.0 * curvature * uv).extend(1.0).normalize();
        (place, normal)
    }
}
