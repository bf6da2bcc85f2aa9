//! The borders and feature lines of a region, in the splat's plane.

use glam::DVec2;

use super::region::Region;
use crate::analyse::surface::{NONE, Surface};
use crate::fit::pose::Pose;

/// A directed line with the surface on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its vertices in `(u, v)`.
    pub points: Vec<DVec2>,
    /// Whether it is a loop; then its first point is not repeated.
    pub closed: bool,
}

/// The borders that pass the region's members and rim, each chained as far as those go and
/// one vertex farther.
///
/// Only lines that the walk over the surface met are here. A line of another patch that
/// runs through the splat's box bounds nothing (Ivo 2020, Fig. 26) and is never met. Where
/// the walk met both sides of a line, around the end of one that ends inside the surface,
/// the line bounds nothing either: both sides are the splat's own.
#[must_use]
pub fn outlines(surface: &Surface, region: &Region, pose: &Pose) -> Vec<Outline> {
    let sides = one_sided(surface, sides(surface, region));
    let next = |point: u32| {
        let at = sides.partition_point(|side| side.0 < point);
        sides.get(at).filter(|side| side.0 == point).map(|side| side.1)
    };
    let mut followed: Vec<u32> = sides.iter().map(|side| side.1).collect();
    followed.sort_unstable();
    let flat = |point: u32| pose.to_local(surface.point(point)).truncate();
    let mut done = vec![false; sides.len()];
    let mut found = Vec::new();
    let starts = sides.iter().map(|side| side.0).filter(|point| followed.binary_search(point).is_err());
    // Whatever no start leads to is a loop; those come second.
    for start in starts.chain(sides.iter().map(|side| side.0)) {
        let mut points = Vec::new();
        let mut point = start;
        while let Some(after) = next(point) {
            let at = sides.partition_point(|side| side.0 < point);
            if std::mem::replace(&mut done[at], true) {
                break;
            }
            points.push(flat(point));
            point = after;
        }
        if !points.is_empty() {
            let closed = point == start;
            if !closed {
                points.push(flat(point));
            }
            found.push(Outline { points, closed });
        }
    }
    found
}

/// The sides of all borders with an end among the members or the rim, sorted.
fn sides(surface: &Surface, region: &Region) -> Vec<(u32, u32)> {
    let near = region
        .members
        .iter()
        .map(|member| member.point)
        .chain(region.rim.iter().map(|&(_, outside)| outside));
    let mut sides: Vec<(u32, u32)> = near
        .filter(|&point| surface.on_border(point))
        .flat_map(|point| {
            let (prev, next) = (surface.border_prev[point as usize], surface.border_next[point as usize]);
            [(prev, point), (point, next)]
        })
        .filter(|&(from, to)| from != NONE && to != NONE)
        .collect();
    sides.sort_unstable();
    sides.dedup();
    sides
}

/// Leaves out the sides whose other side is there too.
fn one_sided(surface: &Surface, sides: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
    let place = |point: u32| surface.places[point as usize];
    let mut turned: Vec<(u32, u32)> = sides.iter().map(|&(from, to)| (place(to), place(from))).collect();
    turned.sort_unstable();
    sides.into_iter().filter(|&(from, to)| turned.binary_search(&(place(from), place(to))).is_err()).collect()
}
