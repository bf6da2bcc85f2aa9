//! Where a cloud leaves it open how far its surface goes on: at its borders and around holes.
//!
//! Elsewhere margins fill the surface, but for the few empty discs that chance leaves among points strewn at
//! random, and splats that cover these have no hole. Whoever bakes a scan wants to know where that does not hold.

use std::cmp::Reverse;

use glam::{DVec3, Vec3};

use super::cloud_graph::Joined;
use super::sets::Sets;
use super::surface::NONE;

/// Fewer open points together than this are no border: up to 21 come together by chance among 200 thousand points
/// strewn at random over a torus, up to 17 among a million over a sphere.
const FEWEST: usize = 24;

/// A border, or the rim of a hole: open points that are joined to each other, or both to points that are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPlace {
    /// How many points there are.
    pub points: usize,
    /// The middle of the box around them, model units.
    pub middle: DVec3,
    /// Half the diagonal of that box, model units.
    pub reach: f64,
}

/// The open places of a cloud, those of most points first; `counts` tells which points may be of one.
pub(super) fn open_places(
    positions: &[Vec3],
    joined: &[Joined],
    counts: impl Fn(usize) -> bool,
) -> Vec<OpenPlace> {
    let open: Vec<u32> =
        (0..joined.len()).filter(|&n| joined[n].open && counts(n)).map(|n| n as u32).collect();
    let mut sets = Sets::new(joined.len());
    let around = |point: u32| joined[point as usize].sectors.into_iter().filter(|&other| other != NONE);
    for &point in &open {
        for near in around(point) {
            around(near).chain([near]).for_each(|other| sets.merge(point, other));
        }
    }
    let mut grouped: Vec<(u32, u32)> = open.into_iter().map(|point| (sets.root(point), point)).collect();
    grouped.sort_unstable();
    let groups = grouped.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() >= FEWEST);
    let mut places: Vec<OpenPlace> =
        groups.map(|group| place(group.iter().map(|&(_, point)| positions[point as usize]))).collect();
    places.sort_by_key(|place| Reverse(place.points));
    places
}

fn place(points: impl Iterator<Item = Vec3> + Clone) -> OpenPlace {
    let low = points.clone().fold(Vec3::INFINITY, Vec3::min).as_dvec3();
    let high = points.clone().fold(Vec3::NEG_INFINITY, Vec3::max).as_dvec3();
    OpenPlace { points: points.count(), middle: low.midpoint(high), reach: 0.5 * low.distance(high) }
}
