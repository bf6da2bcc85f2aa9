//! How noisy a cloud is, and the cloud without its noise.
//!
//! Points scatter about the surface that they were taken from. No splat of more than a few points
//! keeps a bound that is below this scatter, and a splat for every few points says nothing of the
//! surface; so the scatter is measured before anything is baked.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::analyse::canonical::order;
use crate::analyse::cloud_normals::plane;
use crate::analyse::nearest::Search;
use crate::error::Result;
use crate::fit::pose::{Fitting, Pose, Principal, above, principal};
use crate::model::cloud::Cloud;

/// Patches that are looked at, spread evenly along the Morton curve: their medians count, since
/// some patches lie across an edge.
const PATCHES: usize = 512;

/// Sizes of the patches tried, points: the least in which the surface shows. Where points scatter
/// by more than they lie apart, few of them are no patch of a surface but a ball.
const SIZES: [usize; 4] = [24, 64, 256, 1024];

/// A patch shows a surface if its radius is this many times the scatter, or more.
const WIDE: f64 = 4.0;

/// The nearest to a point are sought among this many times as many along the Morton curve.
const WINDOW: usize = 8;

/// What a quadric in its frame takes from the points it is fitted to: six of the fit's terms.
const TERMS: usize = 6;

/// Points of a patch that are compared with their neighbours.
const COMPARED: usize = 64;

/// The standard deviation of a cloud's points from its surface, model units; `None` where they show
/// no surface at any scale, and for fewer than the smallest patch has.
///
/// It is the median over patches, each fitted by a quadric, of what each point's distance from the
/// quadric differs from that of the point beside it. Detail of the surface, however fine, is much
/// the same at both and hardly counts; scatter is not (von Neumann 1941, "Distribution of the ratio
/// of the mean square successive difference to the variance").
#[must_use]
pub fn noise(positions: &[Vec3]) -> Option<f64> {
    let order = order(positions);
    let sizes = SIZES.into_iter().take_while(|&size| size <= positions.len());
    sizes.map(|size| typical(positions, &order, size)).find_map(|Typical { noise, rms, radius }| {
        let shown = WIDE * rms <= radius;
        shown.then_some(noise)
    })
}

/// Medians over patches, model units.
struct Typical {
    /// Of what the distances differ by between neighbours, as a standard deviation.
    noise: f64,
    /// Of the distances.
    rms: f64,
    radius: f64,
}

/// What patches of so many points typically are.
fn typical(positions: &[Vec3], order: &[u32], size: usize) -> Typical {
    let patches = PATCHES.min(order.len());
    let found: Vec<[f64; 3]> = (0..patches)
        .into_par_iter()
        .map(|n| {
            let seed = (2 * n + 1) * order.len() / (2 * patches);
            let from = seed.saturating_sub(WINDOW * size / 2);
            let window = &order[from..(from + WINDOW * size).min(order.len())];
            let here = positions[order[seed] as usize].as_dvec3();
            let away = |&p: &u32| positions[p as usize].as_dvec3().distance_squared(here);
            let mut near: Vec<(f64, u32)> = window.iter().map(|p| (away(p), *p)).collect();
            // Stable: of those equally far the first on the curve, whatever their order in the file.
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            near.truncate(size);
            let patch: Vec<Vec3> = near.iter().map(|&(_, p)| positions[p as usize]).collect();
            let [noise, rms] = Patch::of(&patch).scatter(&patch);
            [noise, rms, near.last().map_or(0.0, |farthest| farthest.0.sqrt())]
        })
        .collect();
    let median = |which: usize| {
        let mut values: Vec<f64> = found.iter().map(|found| found[which]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    Typical { noise: median(0), rms: median(1), radius: median(2) }
}

/// The quadric of least squares through some points, the first of which is the one of interest.
struct Patch {
    quadric: Principal,
}

impl Patch {
    fn of(points: &[Vec3]) -> Self {
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
    fn scatter(&self, points: &[Vec3]) -> [f64; 2] {
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
    fn foot(&self, point: Vec3) -> (DVec3, DVec3) {
        let Principal { pose, curvature, .. } = self.quadric;
        let uv = pose.to_local(point.as_dvec3()).truncate();
        let place = pose.center + pose.axes * uv.extend((curvature * uv * uv).element_sum());
        let normal = pose.axes * (-2.0 * curvature * uv).extend(1.0).normalize();
        (place, normal)
    }
}

/// A quadric fitted to `n` points scatters in its middle by the square root of this over `n`, a
/// share of what the points do.
const LEVERAGE: f64 = 4.0;

/// Smoothed points scatter by this share of the error bound.
const QUIET: f64 = 1.0 / 6.0;

/// The fewest and the most points that one is smoothed with.
const SMOOTHED_WITH: [usize; 2] = [32, 768];

/// A point that would move by more than this many standard deviations of the noise is none of it and
/// stays where it is: an outlier, or too far from its neighbours to be told.
const FARTHEST: f64 = 6.0;

/// The least error bound, model units, for which a cloud of this noise can be smoothed.
#[must_use]
pub fn least_bound(noise: f64) -> f64 {
    // There the most points smooth to twice the scatter that is aimed at.
    0.5 * noise / QUIET * (LEVERAGE / SMOOTHED_WITH[1] as f64).sqrt()
}

/// A cloud whose points are moved onto the quadrics fitted to the points around them.
#[derive(Clone, Debug)]
pub struct Quieted {
    /// The cloud. Normals, if it had any, are those of the quadrics, on the side of the old ones.
    pub cloud: Cloud,
    /// Root mean square of the ways the points were moved, model units.
    pub moved_rms: f64,
    /// The longest, model units.
    pub moved_max: f64,
}

/// A cloud without its noise, as far as an error bound asks for that (model units).
///
/// After Levin 1998 ("The approximation power of moving least-squares"), one step and with weights
/// that are all the same.
///
/// # Errors
/// [`crate::Error::Internal`] should the neighbour search not take the points.
pub fn quieted(cloud: &Cloud, noise: f64, max_error: f64) -> Result<Quieted> {
    let ratio = noise / (QUIET * max_error);
    let count = ((LEVERAGE * ratio * ratio).ceil() as usize).clamp(SMOOTHED_WITH[0], SMOOTHED_WITH[1]);
    // Along the curve, so that the order in the file does not matter, even between points equally far.
    let order = order(&cloud.positions);
    let positions: Vec<Vec3> = order.iter().map(|&n| cloud.positions[n as usize]).collect();
    let search = Search::new(&positions)?;
    let moved: Vec<(DVec3, DVec3)> = (0_u32..positions.len() as u32)
        .into_par_iter()
        .map(|n| {
            let point = positions[n as usize];
            let others = search.around(point, count).into_iter().filter(|&other| other != n);
            let near = others.map(|other| positions[other as usize]);
            let patch: Vec<Vec3> = std::iter::once(point).chain(near).collect();
            Patch::of(&patch).foot(point)
        })
        .collect();
    let mut quiet = Quieted { cloud: cloud.clone(), moved_rms: 0.0, moved_max: 0.0 };
    let mut squares = 0.0;
    for (&n, &(place, normal)) in order.iter().zip(&moved) {
        let n = n as usize;
        let way = cloud.positions[n].as_dvec3().distance(place);
        if way > FARTHEST * noise {
            continue;
        }
        squares += way * way;
        quiet.moved_max = quiet.moved_max.max(way);
        quiet.cloud.positions[n] = place.as_vec3();
        if let Some(old) = quiet.cloud.normals.get_mut(n) {
            let side = if old.as_dvec3().dot(normal) < 0.0 { -1.0 } else { 1.0 };
            *old = (side * normal).as_vec3();
        }
    }
    quiet.moved_rms = (squares / order.len().max(1) as f64).sqrt();
    Ok(quiet)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::canonical::mix;

    /// Within `[-1, 1]`.
    fn random(n: u64) -> f64 {
        (mix(n) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// About normal, of variance 1: the sum of twelve numbers (Irwin and Hall).
    fn normal(n: u64) -> f64 {
        (0..12).map(|k| 0.5 * random(16 * n + k)).sum()
    }

    /// Points on a sphere of radius 0.8, strewn evenly, that scatter by `scatter` in every direction.
    fn sphere(count: u64, scatter: f64) -> Cloud {
        let point = |n: u64| {
            let z = 1.0 - (2.0 * n as f64 + 1.0) / count as f64;
            let (sin, cos) = libm::sincos(2.399_963 * n as f64);
            let across = libm::sqrt(1.0 - z * z);
            let off = DVec3::new(normal(3 * n), normal(3 * n + 1), normal(3 * n + 2));
            (0.8 * DVec3::new(across * cos, across * sin, z) + scatter * off).as_vec3()
        };
        Cloud { positions: (0..count).map(point).collect(), ..Cloud::default() }
    }

    #[test]
    fn planted_scatter_is_found_and_shape_is_not_taken_for_it() {
        // Points of this sphere lie 0.02 apart.
        for scatter in [1e-4, 1e-3, 0.01, 0.02, 0.04] {
            let found = noise(&sphere(20_000, scatter).positions).unwrap();
            assert!((0.75..1.25).contains(&(found / scatter)), "{found} for {scatter}");
        }
        assert!(noise(&sphere(20_000, 0.0).positions).unwrap() < 2e-5);
        let solid: Vec<Vec3> =
            (0..5000).map(|n| [3 * n, 3 * n + 1, 3 * n + 2].map(|n| random(n) as f32).into()).collect();
        assert_eq!(noise(&solid), None, "a solid shows no surface");
        assert_eq!(noise(&solid[..20]), None);
    }

    #[test]
    fn smoothed_points_lie_on_the_sphere_and_outliers_stay() {
        let mut cloud = sphere(20_000, 0.01);
        cloud.positions[7] = Vec3::new(0.0, 0.0, 0.95);
        let bound = 0.01;
        let quiet = quieted(&cloud, noise(&cloud.positions).unwrap(), bound).unwrap();
        assert_eq!(quiet.cloud.positions[7], cloud.positions[7]);
        let rest = quiet.cloud.positions.iter().enumerate().filter(|&(n, _)| n != 7);
        let off: Vec<f64> = rest.map(|(_, p)| p.as_dvec3().length() - 0.8).collect();
        let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
        assert!(rms < 1.5 * QUIET * bound, "{rms}");
        assert!(off.iter().all(|off| off.abs() < bound));
        assert!((0.8..1.2).contains(&(quiet.moved_rms / 0.01)), "{}", quiet.moved_rms);
    }
}
