//! Thins the surface of a dense cloud, so that growing a splat costs the same however densely
//! its surface was sampled.
//!
//! A point stands for others around it that its own tangent plane passes nearby. Splats are
//! fitted to such points alone; what has to be covered stays every point of the cloud, a
//! spot each, and a splat is judged on all of them.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::surface::{NONE, Rows, Spot, Surface};

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

/// Points whose claims are made one after another. Blocks are of the same size whatever the
/// threads, so that the claims are the same too.
const BLOCK: usize = 1 << 15;

/// Thinning that leaves more than this share of the points is not worth its indirection.
const WORTHWHILE: f64 = 0.6;

/// A cloud's surface with fewer points; the same one where little would be saved.
///
/// Points must lie along a space-filling curve, as those of a cloud's surface do.
#[must_use]
pub fn thin(surface: Surface, reach: Reach) -> Surface {
    let claimed = claims(&surface, reach);
    let mut index = vec![NONE; claimed.len()];
    let mut kept = Vec::new();
    for (point, &by) in (0_u32..).zip(&claimed) {
        if by == point {
            index[point as usize] = kept.len() as u32;
            kept.push(point);
        }
    }
    if kept.len() as f64 > WORTHWHILE * claimed.len() as f64 {
        return surface;
    }
    let owner: Vec<u32> = claimed.iter().map(|&by| index[by as usize]).collect();
    let owned = Rows::grouped(kept.len(), &owner);
    quotient(&surface, &kept, &owner, &owned)
}

/// For each point the one that stands for it, itself perhaps.
fn claims(surface: &Surface, reach: Reach) -> Vec<u32> {
    let mut claimed = vec![NONE; surface.points.len()];
    claimed.par_chunks_mut(BLOCK).enumerate().for_each(|(block, claimed)| {
        let mut reached = Vec::new();
        for at in 0..claimed.len() {
            if claimed[at] == NONE {
                claim(surface, reach, block * BLOCK, at, claimed, &mut reached);
            }
        }
    });
    claimed
}

/// Claims what a point reaches, in a block of points that starts at `first`.
fn claim(
    surface: &Surface,
    reach: Reach,
    first: usize,
    at: usize,
    claimed: &mut [u32],
    reached: &mut Vec<u32>,
) {
    let point = (first + at) as u32;
    claimed[at] = point;
    if is_bound(surface, point) {
        return;
    }
    let (center, normal) = (surface.points[point as usize], surface.normals[point as usize]);
    let stands_for = |other: u32| {
        let way = (surface.points[other as usize] - center).as_dvec3();
        way.length_squared() <= reach.radius * reach.radius
            && way.dot(normal.as_dvec3()).abs() <= reach.offset
            && surface.normals[other as usize].dot(normal) >= AGREE
            && !is_bound(surface, other)
    };
    reached.clear();
    reached.push(point);
    while let Some(from) = reached.pop() {
        for &other in surface.neighbours.row(from) {
            let slot = (other as usize).checked_sub(first).and_then(|slot| claimed.get_mut(slot));
            if let Some(slot) = slot.filter(|slot| **slot == NONE && stands_for(other)) {
                *slot = point;
                reached.push(other);
            }
        }
    }
}

/// Points on lines and those without a spot of their own stay as they are.
fn is_bound(surface: &Surface, point: u32) -> bool {
    surface.on_border(point) || surface.pieces_of.row(point).is_empty()
}

/// The surface over the points kept: joined where points they stand for are.
fn quotient(surface: &Surface, kept: &[u32], owner: &[u32], owned: &Rows) -> Surface {
    let rows: Vec<u32> = (0..kept.len() as u32).collect();
    let joined: Vec<Vec<u32>> = rows
        .par_iter()
        .map(|&row| {
            let around = owned.row(row).iter().flat_map(|&point| surface.neighbours.row(point));
            let mut others: Vec<u32> =
                around.map(|&other| owner[other as usize]).filter(|&other| other != row).collect();
            others.sort_unstable();
            others.dedup();
            others
        })
        .collect();
    let spots_of = |row: u32| owned.row(row).iter().flat_map(|&point| surface.pieces_of.row(point)).copied();
    let spots: Vec<Spot> =
        rows.iter().flat_map(|&row| spots_of(row)).map(|spot| surface.spots[spot as usize]).collect();
    let pieces = rows.iter().flat_map(|&row| spots_of(row).map(move |_| [row; 3])).collect();
    let lengths: Vec<u32> = rows.iter().map(|&row| spots_of(row).count() as u32).collect();
    let follow = |point: u32| if point == NONE { NONE } else { owner[point as usize] };
    Surface {
        points: rows.par_iter().map(|&row| middle(surface, kept[row as usize], owned.row(row))).collect(),
        places: kept.iter().map(|&point| surface.places[point as usize]).collect(),
        normals: kept.iter().map(|&point| surface.normals[point as usize]).collect(),
        colors: match surface.colors.is_empty() {
            true => Vec::new(),
            false => rows.iter().map(|&row| mean_color(surface, owned.row(row))).collect(),
        },
        neighbours: Rows::from_lists(&joined),
        pieces,
        pieces_of: Rows::consecutive(&lengths),
        spots,
        margin: rows.iter().map(|&row| margin(surface, kept[row as usize], owned.row(row))).collect(),
        border_next: kept.iter().map(|&point| follow(surface.border_next[point as usize])).collect(),
        border_prev: kept.iter().map(|&point| follow(surface.border_prev[point as usize])).collect(),
    }
}

/// A point, moved along its normal to the mean height of those it stands for: their noise is
/// averaged, and the spread of the points stays even.
fn middle(surface: &Surface, point: u32, owned: &[u32]) -> Vec3 {
    let (center, normal) = (surface.point(point), surface.normal(point));
    let heights: f64 = owned.iter().map(|&other| (surface.point(other) - center).dot(normal)).sum();
    (center + heights / owned.len() as f64 * normal).as_vec3()
}

/// How far a point stands for the surface: to the far side of the farthest point it stands for.
fn margin(surface: &Surface, point: u32, owned: &[u32]) -> f32 {
    let center: DVec3 = surface.point(point);
    let far = |&other: &u32| surface.point(other).distance(center) as f32 + surface.margin[other as usize];
    owned.iter().map(far).fold(0.0, f32::max)
}

fn mean_color(surface: &Surface, owned: &[u32]) -> [u8; 3] {
    let mut sums = [0_u64; 3];
    for &point in owned {
        for (sum, channel) in sums.iter_mut().zip(surface.colors[point as usize]) {
            *sum += u64::from(channel);
        }
    }
    let count = owned.len() as u64;
    sums.map(|sum| ((sum + count / 2) / count) as u8)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_surface};
    use crate::model::cloud::Cloud;

    /// Points spread evenly over a unit sphere, with its normals.
    fn sphere(count: usize) -> Surface {
        let point = |n: usize| {
            let z = 1.0 - 2.0 * (n as f64 + 0.5) / count as f64;
            let (sin, cos) = libm::sincos(2.399_963 * n as f64);
            let across = libm::sqrt(1.0 - z * z);
            DVec3::new(across * cos, across * sin, z).as_vec3() * 0.5
        };
        let positions: Vec<Vec3> = (0..count).map(point).collect();
        let normals = positions.iter().map(|p| p.normalize()).collect();
        let cloud = Cloud { positions, normals, ..Cloud::default() };
        cloud_surface(&cloud, NormalSource::Keep, Lines::Given(&[])).unwrap().surface
    }

    #[test]
    fn every_spot_stays_and_has_a_point_near_it() {
        let whole = sphere(20_000);
        let reach = Reach { radius: 0.05, offset: 0.004 };
        let thinned = thin(whole.clone(), reach);
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
        let whole = sphere(2_000);
        let thinned = thin(whole.clone(), Reach { radius: 0.005, offset: 0.004 });
        assert_eq!(whole.points, thinned.points);
        // Nor does a point stand for what its tangent plane passes far off.
        let thinned = thin(whole.clone(), Reach { radius: 0.1, offset: 1e-7 });
        assert_eq!(whole.points, thinned.points);
    }
}
