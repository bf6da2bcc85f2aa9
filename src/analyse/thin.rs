//! Which points of a dense cloud stand for the others, so that growing a splat costs the same however densely
//! its surface was sampled.
//!
//! A point stands for others around it that its own tangent plane passes nearby. Splats are
//! fitted to such points alone; what has to be covered stays every point of the cloud, a
//! spot each, and a splat is judged on all of them.

use glam::Vec3;
use rayon::prelude::*;

use super::cloud_graph::Joined;
use super::surface::NONE;

/// How far a point may stand for others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Greatest distance, model units.
    pub radius: f64,
    /// Greatest distance from its tangent plane, model units.
    pub offset: f64,
}

/// Normals of points stood for agree with that of the point by at least this cosine (25°).
const AGREE: f32 = 0.906;

/// A point whose normal turns from that of one joined to it by more than this (cosine of 15°) lies
/// where the surface is creased, or where it is as fine as the points.
const CREASED: f32 = 0.966;

/// Sectors in which a point within a surface is joined to others, at least: of sixteen others strewn
/// at random more leave four empty once in a hundred times.
const AROUND: usize = 5;

/// Points whose claims are made one after another. Blocks are of the same size whatever the
/// threads, so that the claims are the same too.
const BLOCK: usize = 1 << 15;

/// Thinning that leaves more than this share of the points is not worth its indirection.
const WORTHWHILE: f64 = 0.6;

/// Points of a cloud as a sheet, side by side.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// Positions, model units, along a space-filling curve.
    pub positions: &'a [Vec3],
    /// Unit normals.
    pub normals: &'a [Vec3],
    /// What each is joined to.
    pub joined: &'a [Joined],
    /// Which belong to no surface.
    pub outlier: &'a [bool],
    /// Which are joined to a feature line.
    pub on_line: &'a [bool],
    /// Corners of what points stand for, where lines bound it, in the order of the points.
    pub cells: &'a [(u32, Vec<Vec3>)],
}

/// For each point the one that stands for it, [`NONE`] for an outlier; all for themselves where
/// `reach` is none, and where little would be saved.
#[must_use]
pub fn owners(sheet: &Sheet<'_>, reach: Option<Reach>) -> Vec<u32> {
    let themselves = || {
        let all = (0_u32..).zip(sheet.outlier);
        all.map(|(point, &outlier)| if outlier { NONE } else { point }).collect::<Vec<u32>>()
    };
    let Some(reach) = reach else { return themselves() };
    let claimed = claims(sheet, reach);
    let kept = (0_u32..).zip(&claimed).filter(|&(point, &by)| by == point).count();
    if kept as f64 > WORTHWHILE * claimed.len() as f64 { themselves() } else { claimed }
}

/// For each point the one that stands for it, itself perhaps.
fn claims(sheet: &Sheet<'_>, reach: Reach) -> Vec<u32> {
    let mut claimed = vec![NONE; sheet.positions.len()];
    claimed.par_chunks_mut(BLOCK).enumerate().for_each(|(block, claimed)| {
        let first = block * BLOCK;
        let mut reached = Vec::new();
        for at in 0..claimed.len() {
            if claimed[at] == NONE && !sheet.outlier[first + at] {
                claim(sheet, reach, [first, at], claimed, &mut reached);
            }
        }
    });
    claimed
}

/// Whether a point stands for itself alone: beside lines, where sheets end and splats are cut, beside
/// creases that no line was found for, where their growth has to end, and where the points show no
/// surface all around, at its borders and along the lines of a scanner.
fn stands_alone(sheet: &Sheet<'_>, point: usize) -> bool {
    let turns = |other: u32| sheet.normals[other as usize].dot(sheet.normals[point]) < CREASED;
    let mut others = sheet.joined[point].sectors.iter().copied().filter(|&other| other != NONE);
    sheet.on_line[point] || others.clone().count() < AROUND || others.any(turns)
}

/// Claims what a point reaches, in a block of points that starts at `first`.
fn claim(
    sheet: &Sheet<'_>,
    reach: Reach,
    [first, at]: [usize; 2],
    claimed: &mut [u32],
    reached: &mut Vec<u32>,
) {
    let point = first + at;
    claimed[at] = point as u32;
    if stands_alone(sheet, point) {
        return;
    }
    let (center, normal) = (sheet.positions[point], sheet.normals[point]);
    let stands_for = |other: usize| {
        let way = (sheet.positions[other] - center).as_dvec3();
        way.length_squared() <= reach.radius * reach.radius
            && way.dot(normal.as_dvec3()).abs() <= reach.offset
            && sheet.normals[other].dot(normal) >= AGREE
            && !sheet.outlier[other]
            && !stands_alone(sheet, other)
    };
    reached.clear();
    reached.push(point as u32);
    while let Some(from) = reached.pop() {
        let sectors = &sheet.joined[from as usize].sectors;
        for other in sectors.iter().copied().filter(|&other| other != NONE) {
            let slot = (other as usize).checked_sub(first).and_then(|slot| claimed.get_mut(slot));
            if let Some(slot) = slot.filter(|slot| **slot == NONE && stands_for(other as usize)) {
                *slot = point as u32;
                reached.push(other);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::DVec3;

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_surface};
    use crate::analyse::surface::Surface;
    use crate::model::cloud::Cloud;

    /// Points spread evenly over a unit sphere, with its normals.
    fn sphere(count: usize, reach: Option<Reach>) -> Surface {
        let point = |n: usize| {
            let z = 1.0 - 2.0 * (n as f64 + 0.5) / count as f64;
            let (sin, cos) = libm::sincos(2.399_963 * n as f64);
            let across = libm::sqrt(1.0 - z * z);
            DVec3::new(across * cos, across * sin, z).as_vec3() * 0.5
        };
        let positions: Vec<Vec3> = (0..count).map(point).collect();
        let normals = positions.iter().map(|p| p.normalize()).collect();
        let cloud = Cloud { positions, normals, ..Cloud::default() };
        cloud_surface(&cloud, NormalSource::Keep, Lines::Given(&[]), None, reach, None, None).unwrap().surface
    }

    #[test]
    fn every_spot_stays_and_has_a_point_near_it() {
        let whole = sphere(20_000, None);
        let reach = Reach { radius: 0.05, offset: 0.004 };
        let thinned = sphere(20_000, Some(reach));
        assert!(thinned.points.len() * 8 < whole.points.len(), "{}", thinned.points.len());
        let sorted = |surface: &Surface| {
            let mut spots: Vec<[u32; 4]> = surface
                .spots
                .iter()
                .map(|spot| spot.position.extend(spot.margin).to_array().map(f32::to_bits))
                .collect();
            spots.sort_unstable();
            spots
        };
        assert_eq!(sorted(&whole), sorted(&thinned));
        for (piece, spot) in (0_u32..).zip(&thinned.spots) {
            let [point, ..] = thinned.pieces[piece as usize];
            assert!(thinned.pieces_of.row(point).contains(&piece));
            let way = spot.position.as_dvec3().distance(thinned.point(point));
            assert!(way <= reach.radius + 2.0 * reach.offset, "{way}");
            assert!(way <= f64::from(thinned.margin[point as usize]) + reach.offset);
        }
        let (mut seen, mut reached) = (vec![false; thinned.points.len()], vec![0]);
        seen[0] = true;
        while let Some(row) = reached.pop() {
            for &other in thinned.neighbours.row(row) {
                assert!(other != row && thinned.neighbours.row(other).contains(&row));
                if !std::mem::replace(&mut seen[other as usize], true) {
                    reached.push(other);
                }
            }
        }
        assert!(seen.iter().all(|seen| *seen), "the surface stays joined");
    }

    #[test]
    fn a_sparse_cloud_stays_as_it_is() {
        let whole = sphere(2_000, None);
        let thinned = sphere(2_000, Some(Reach { radius: 0.005, offset: 0.004 }));
        assert_eq!(whole.points, thinned.points);
        // Nor does a point stand for what its tangent plane passes far off.
        let thinned = sphere(2_000, Some(Reach { radius: 0.1, offset: 1e-7 }));
        assert_eq!(whole.points, thinned.points);
    }
}
