//! Normals of a cloud: the file's where they are sound, else those of the local planes.

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_creases::Points;
use super::consensus;
use super::distinct::Distinct;
use super::least_axis::{LeastAxis, minors};
use super::nearest::{Nearest, listed};
use super::orient::{agreement, orient};
use crate::error::{Error, Result};

/// Where normals come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalSource {
    /// The cloud's where they are sound, else estimated.
    #[default]
    Auto,
    /// The cloud's; one without is an error.
    Keep,
    /// The positions.
    Estimate,
}

/// A kept normal that makes a smaller cosine than this (73°) with the plane of a flat
/// neighbourhood is wrong: even at the corner of a cube it is 0.58.
const WILD: f64 = 0.3;

/// A neighbourhood is flat if its least variance is below this share of the middle one.
const FLAT: f64 = 0.1;

/// Kept normals whose signs disagree at more than this share of the neighbouring pairs have
/// no meaningful signs. At the sharp edges and thin walls of a sound cloud far fewer do.
const RANDOM_SIGNS: f64 = 0.15;

/// A plane through a point's neighbourhood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, of either sign.
    pub normal: Vec3,
    /// Whether the neighbourhood is much wider than thick.
    pub flat: bool,
    /// Its least variance over the middle one, from 0 where the points lie on a plane or a line to 1 where they lie
    /// as in a ball.
    pub roundness: f64,
}

/// Unit normals, and whether they were estimated from the positions.
#[derive(Clone, Debug, Default)]
pub struct Normals {
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Whether they come from the positions alone.
    pub estimated: bool,
}

/// Unit normals of a cloud's points, outward as far as can be told.
///
/// `shown` are the points if they show a surface: estimated normals are then of one sheet where others cross it.
///
/// # Errors
/// [`Error::Usage`] where normals are to be kept and none is sound.
pub fn normals(
    points: &Distinct,
    nearest: &Nearest,
    source: NormalSource,
    shown: Option<&Points<'_>>,
) -> Result<Normals> {
    let sound = points.normals.iter().filter(|n| **n != Vec3::ZERO).count();
    if source == NormalSource::Keep && sound == 0 {
        return Err(Error::Usage(
            "--normals keep: the cloud has no sound normals; leave the option out to estimate them".into(),
        ));
    }
    // A handful of kept normals among thousands of missing ones gives no signs to follow.
    if source == NormalSource::Estimate || 2 * sound < points.positions.len() {
        let all = (0..points.positions.len()).into_par_iter();
        let mut normals: Vec<Vec3> = all.map(|n| estimate(points, nearest, shown, n)).collect();
        orient(&points.positions, nearest, &mut normals);
        return Ok(Normals { normals, estimated: true });
    }
    let mut normals = mended(points, nearest);
    if source == NormalSource::Auto && agreement(nearest, &normals) < 1.0 - RANDOM_SIGNS {
        orient(&points.positions, nearest, &mut normals);
    }
    Ok(Normals { normals, estimated: false })
}

/// The normal of a point's sheet, of either sign.
fn estimate(points: &Distinct, nearest: &Nearest, shown: Option<&Points<'_>>, n: usize) -> Vec3 {
    let all = plane(&points.positions, n, listed(&nearest[n]));
    shown.and_then(|shown| consensus::normal(shown, n, &all)).unwrap_or(all.normal)
}

/// Estimates the normals of points again whose neighbourhood a feature line parts.
pub fn parted(
    points: &Distinct,
    nearest: &Nearest,
    parts: &(impl Fn(u32, u32) -> bool + Sync),
    normals: &mut [Vec3],
) {
    normals.par_iter_mut().enumerate().for_each(|(n, normal)| {
        let near = || listed(&nearest[n]).filter(|&other| !parts(n as u32, other));
        let count = near().count();
        if count >= FEWEST && count < listed(&nearest[n]).count() {
            let found = plane(&points.positions, n, near()).normal;
            *normal = if found.dot(*normal) < 0.0 { -found } else { found };
        }
    });
}

/// Fewer neighbours than this give no plane to trust over one across a line.
const FEWEST: usize = 3;

/// The kept normals, with planes' normals in place of missing and wild ones.
fn mended(points: &Distinct, nearest: &Nearest) -> Vec<Vec3> {
    let kept: Vec<Vec3> = (0..points.normals.len())
        .into_par_iter()
        .map(|n| if wild(points, nearest, n) { Vec3::ZERO } else { points.normals[n] })
        .collect();
    kept.par_iter()
        .enumerate()
        .map(|(n, &own)| {
            if own != Vec3::ZERO {
                return own;
            }
            let around: Vec3 = listed(&nearest[n]).map(|other| kept[other as usize]).sum();
            let normal = plane(&points.positions, n, listed(&nearest[n])).normal;
            if around.dot(normal) < 0.0 { -normal } else { normal }
        })
        .collect()
}

/// Whether a kept normal lies nearly in the plane of a flat neighbourhood.
fn wild(points: &Distinct, nearest: &Nearest, n: usize) -> bool {
    let Some(spread) = spread(&points.positions, n, listed(&nearest[n])) else { return false };
    let kept = points.normals[n].as_dvec3();
    // For eigenvalues `l0 <= l1 <= l2` of the spread, `l1 >= minors / (2 trace)`. A wild normal
    // would see a variance of nearly `l1` or more: most need no eigenvectors to be told from one.
    let least_middle = minors(&spread) / (2.0 * (spread.x_axis.x + spread.y_axis.y + spread.z_axis.z));
    if kept.dot(spread * kept) < (1.0 - WILD * WILD) * least_middle {
        return false;
    }
    let plane = plane(&points.positions, n, listed(&nearest[n]));
    plane.flat && kept.dot(plane.normal.as_dvec3()).abs() < WILD
}

/// The second moments of a point and others about their mean, in units of the size of the
/// neighbourhood squared; `None` if all lie at one place.
fn spread(positions: &[Vec3], index: usize, others: impl Iterator<Item = u32> + Clone) -> Option<DMat3> {
    let here = positions[index].as_dvec3();
    let offsets = || others.clone().map(|other| positions[other as usize].as_dvec3() - here);
    let (mut sum, mut size, mut count) = (DVec3::ZERO, 0.0_f64, 1.0);
    for offset in offsets() {
        sum += offset;
        size = size.max(offset.abs().max_element());
        count += 1.0;
    }
    if size <= 0.0 {
        return None;
    }
    let mean = sum / count;
    let mut spread = DMat3::ZERO;
    for offset in offsets().chain(std::iter::once(DVec3::ZERO)) {
        // In units of the neighbourhood's size, so that the eigenvalues do not underflow.
        let d = (offset - mean) / size;
        spread.x_axis += d.x * d;
        spread.y_axis += d.y * d;
        spread.z_axis += d.z * d;
    }
    Some(spread)
}

/// The plane of least squares through a point and others (model units).
#[must_use]
pub fn plane(positions: &[Vec3], index: usize, others: impl Iterator<Item = u32> + Clone) -> Plane {
    let Some(spread) = spread(positions, index, others) else {
        return Plane { normal: Vec3::Z, flat: false, roundness: 0.0 };
    };
    let LeastAxis { axis, least, middle } = LeastAxis::of(&spread);
    // Rounding may leave less than nothing of what is nothing.
    let roundness = if least > 0.0 { least / middle } else { 0.0 };
    Plane { normal: upward(axis.as_vec3()), flat: least < FLAT * middle, roundness }
}

/// Of a normal and its opposite, the one whose greatest coordinate is positive: the solver's
/// own choice of sign may differ between machines.
fn upward(normal: Vec3) -> Vec3 {
    let a = normal.abs();
    let greatest = if a.z >= a.x && a.z >= a.y {
        normal.z
    } else if a.y >= a.x {
        normal.y
    } else {
        normal.x
    };
    if greatest < 0.0 { -normal } else { normal }
}
