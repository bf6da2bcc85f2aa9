//! Normals of a cloud: the file's where they are sound, else those of the local planes.

use glam::{DVec3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};
use rayon::prelude::*;

use super::distinct::Distinct;
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
/// # Errors
/// [`Error::Usage`] where normals are to be kept and none is sound.
pub fn normals(points: &Distinct, nearest: &Nearest, source: NormalSource) -> Result<Normals> {
    let sound = points.normals.iter().filter(|n| **n != Vec3::ZERO).count();
    if source == NormalSource::Keep && sound == 0 {
        return Err(Error::Usage(
            "--normals keep: the cloud has no sound normals; leave the option out to estimate them".into(),
        ));
    }
    let planes: Vec<Plane> = (0..points.positions.len())
        .into_par_iter()
        .map(|n| plane(&points.positions, n, listed(&nearest[n])))
        .collect();
    // A handful of kept normals among thousands of missing ones gives no signs to follow.
    if source == NormalSource::Estimate || 2 * sound < points.positions.len() {
        let mut normals: Vec<Vec3> = planes.iter().map(|plane| plane.normal).collect();
        orient(&points.positions, nearest, &mut normals);
        return Ok(Normals { normals, estimated: true });
    }
    let mut normals = mended(points, nearest, &planes);
    if source == NormalSource::Auto && agreement(nearest, &normals) < 1.0 - RANDOM_SIGNS {
        orient(&points.positions, nearest, &mut normals);
    }
    Ok(Normals { normals, estimated: false })
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
fn mended(points: &Distinct, nearest: &Nearest, planes: &[Plane]) -> Vec<Vec3> {
    let kept = |n: usize| {
        let (kept, plane) = (points.normals[n], &planes[n]);
        let wild = plane.flat && f64::from(kept.dot(plane.normal).abs()) < WILD;
        if wild { Vec3::ZERO } else { kept }
    };
    (0..planes.len())
        .into_par_iter()
        .map(|n| {
            let own = kept(n);
            if own != Vec3::ZERO {
                return own;
            }
            let around: Vec3 = listed(&nearest[n]).map(|other| kept(other as usize)).sum();
            let normal = planes[n].normal;
            if around.dot(normal) < 0.0 { -normal } else { normal }
        })
        .collect()
}

/// The plane of least squares through a point and others (model units).
#[must_use]
pub fn plane(positions: &[Vec3], index: usize, others: impl Iterator<Item = u32> + Clone) -> Plane {
    let here = positions[index].as_dvec3();
    let offsets = || others.clone().map(|other| positions[other as usize].as_dvec3() - here);
    let count = offsets().count() as f64 + 1.0;
    let mean = offsets().sum::<DVec3>() / count;
    // In units of the neighbourhood's size, so that the eigenvalues do not underflow.
    let size = offsets().map(|o| o.abs().max_element()).fold(0.0, f64::max);
    if size <= 0.0 {
        return Plane { normal: Vec3::Z, flat: false };
    }
    let mut covariance = Matrix3::zeros();
    for offset in offsets().chain(std::iter::once(DVec3::ZERO)) {
        let d = (offset - mean) / size;
        let v = nalgebra::Vector3::new(d.x, d.y, d.z);
        covariance += v * v.transpose();
    }
    let eigen = SymmetricEigen::new(covariance);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let least = eigen.eigenvectors.column(order[0]);
    let normal = DVec3::new(least[0], least[1], least[2]).normalize_or(DVec3::Z).as_vec3();
    let flat = eigen.eigenvalues[order[0]] < FLAT * eigen.eigenvalues[order[1]];
    Plane { normal: upward(normal), flat }
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
