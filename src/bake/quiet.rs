//! A cloud without its noise.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::patch::Patch;
use crate::analyse::around::{Around, Seen};
use crate::analyse::canonical::order;
use crate::analyse::sided::Sided;
use crate::error::Result;
use crate::model::cloud::Cloud;

/// A quadric fitted to `n` points scatters in its middle by the square root of this over `n`, a
/// share of what the points do.
const LEVERAGE: f64 = 4.0;

/// Smoothed points scatter by this share of the error bound.
const QUIET: f64 = 1.0 / 6.0;

/// What smoothed points may scatter by, at most, as a share of what they are to.
const LOUDEST: f64 = 1.5;

/// The fewest and the most points that one is smoothed with.
const SMOOTHED_WITH: [usize; 2] = [32, 768];

/// On narrow faces there are fewer, and no fewer than this show how a quadric goes on.
const FEWEST: usize = 16;

/// A point that would move by more than this many standard deviations of the noise is none of it and
/// stays where it is: an outlier, or too far from its neighbours to be told.
const FARTHEST: f64 = 6.0;

/// The least error bound, model units, for which a cloud of this noise can be smoothed.
#[must_use]
pub fn least_bound(noise: f64) -> f64 {
    // There the most points smooth to no more than smoothed points may scatter by.
    noise / (LOUDEST * QUIET) * (LEVERAGE / SMOOTHED_WITH[1] as f64).sqrt()
}

/// Whether points scatter by more than smoothed ones are to, under an error bound (model units).
#[must_use]
pub fn is_noisy(noise: f64, max_error: f64) -> bool {
    noise > QUIET * max_error
}

/// Whether smoothed points still scatter by too much for an error bound (model units); `left` is the noise
/// of theirs, `None` where they show no surface.
///
/// Not all that passes for noise is: points strewn through space, as the leaves of trees are, have no
/// surface in their midst, and quadrics fitted to those around one and to those around the next differ.
#[must_use]
pub fn is_loud(left: Option<f64>, max_error: f64) -> bool {
    left.is_none_or(|left| left > LOUDEST * QUIET * max_error)
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

/// A cloud without its noise, as far as an error bound asks for that (model units); edges stay sharp along
/// the lines that its points are told apart by.
///
/// After Levin 1998 ("The approximation power of moving least-squares"), one step and with weights
/// that are all the same, of the points on one side of the lines alone.
///
/// # Errors
/// [`crate::Error::Internal`] should the neighbour search not take the points.
pub fn quieted(cloud: &Cloud, sided: &Sided, max_error: f64) -> Result<Quieted> {
    let moved = moved(sided, max_error)?;
    let mut quiet = Quieted { cloud: cloud.clone(), moved_rms: 0.0, moved_max: 0.0 };
    let mut squares = 0.0;
    // Along the curve, so that the order in the file does not matter.
    for n in order(&cloud.positions) {
        let n = n as usize;
        let Some((place, normal)) = moved[sided.points.place[n] as usize] else { continue };
        let way = cloud.positions[n].as_dvec3().distance(place);
        squares += way * way;
        quiet.moved_max = quiet.moved_max.max(way);
        quiet.cloud.positions[n] = place.as_vec3();
        if let Some(old) = quiet.cloud.normals.get_mut(n) {
            let side = if old.as_dvec3().dot(normal) < 0.0 { -1.0 } else { 1.0 };
            *old = (side * normal).as_vec3();
        }
    }
    quiet.moved_rms = (squares / cloud.positions.len().max(1) as f64).sqrt();
    Ok(quiet)
}

/// Where the distinct points of a cloud are moved to, with the normals there; `None` where they stay.
fn moved(sided: &Sided, max_error: f64) -> Result<Vec<Option<(DVec3, DVec3)>>> {
    let noise = sided.sites().noise;
    let ratio = noise / (QUIET * max_error);
    let count = ((LEVERAGE * ratio * ratio).ceil() as usize).clamp(SMOOTHED_WITH[0], SMOOTHED_WITH[1]);
    let positions = &sided.points.positions;
    let around = Around::new(sided)?;
    let foot = |seen: &mut Seen, n: u32| {
        let near = around.of(n, count, seen);
        let patch: Vec<Vec3> = near.into_iter().map(|other| positions[other as usize]).collect();
        if patch.len() < FEWEST {
            return None;
        }
        let here = positions[n as usize];
        let (place, normal) = Patch::of(&patch).foot(here);
        (here.as_dvec3().distance(place) <= FARTHEST * noise).then_some((place, normal))
    };
    Ok((0..positions.len() as u32).into_par_iter().map_init(Seen::default, foot).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::planted::{normal, random};
    use crate::analyse::sided::Lines;
    use crate::bake::noise::noise;
    use crate::bake::scattered::sphere;

    #[test]
    fn smoothed_points_lie_on_the_sphere_and_outliers_stay() {
        let mut cloud = sphere(20_000, 0.01);
        cloud.positions[7] = Vec3::new(0.0, 0.0, 0.95);
        let bound = 0.01;
        let noise = noise(&cloud).unwrap();
        let sided = Sided::of(&cloud, NormalSource::Auto, Lines::Given(&[]), Some(noise)).unwrap();
        let quiet = quieted(&cloud, &sided, bound).unwrap();
        assert_eq!(quiet.cloud.positions[7], cloud.positions[7]);
        let rest = quiet.cloud.positions.iter().enumerate().filter(|&(n, _)| n != 7);
        let off: Vec<f64> = rest.map(|(_, p)| p.as_dvec3().length() - 0.8).collect();
        let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
        assert!(rms < 1.5 * QUIET * bound, "{rms}");
        assert!(off.iter().all(|off| off.abs() < bound));
        assert!((0.8..1.2).contains(&(quiet.moved_rms / 0.01)), "{}", quiet.moved_rms);
    }

    #[test]
    fn smoothing_keeps_edges_along_lines() {
        // A floor and a wall; points lie 0.02 apart and scatter by half of that.
        let (noise, bound) = (0.01, 0.015);
        let place = |n: u64| {
            let (x, way) = (random(2 * n), random(2 * n + 1));
            let off = DVec3::new(normal(3 * n), normal(3 * n + 1), normal(3 * n + 2));
            DVec3::new(x, way.max(0.0), (-way).max(0.0)) + noise * off
        };
        let positions: Vec<Vec3> = (0..10_000).map(|n| place(n).as_vec3()).collect();
        let cloud = Cloud { positions, ..Cloud::default() };
        // How far off both the points beside the edge lie, root mean square.
        let off = |lines: &[Vec<DVec3>]| {
            let sided = Sided::of(&cloud, NormalSource::Auto, Lines::Given(lines), Some(noise)).unwrap();
            let smoothed = quieted(&cloud, &sided, bound).unwrap().cloud.positions;
            let beside = |p: &Vec3| p.x.abs() < 0.9 && p.y.max(p.z) < 0.06;
            let near = cloud.positions.iter().zip(&smoothed).filter(|(place, _)| beside(place));
            let squares: Vec<f64> = near.map(|(_, p)| f64::from(p.y.abs().min(p.z.abs())).powi(2)).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        let (sharp, round) = (off(&[vec![DVec3::NEG_X, DVec3::X]]), off(&[]));
        assert!(sharp < 0.5 * noise && sharp < 0.7 * round, "{sharp}, and over the edge {round}");
    }
}
