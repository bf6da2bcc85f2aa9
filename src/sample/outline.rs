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
    /// Whether the surface ends at some of it, so that nothing lies across.
    pub ends: bool,
}

/// For each point, whether nothing lies across the border's side that starts there: it is a
/// border of the surface, not a feature line.
#[must_use]
pub fn open_sides(surface: &Surface) -> Vec<bool> {
    let side = |from: usize| {
        let to = surface.border_next[from];
        let place = |point: u32| surface.places[point as usize];
        (to != NONE).then(|| {
            let (a, b) = (place(from as u32), place(to));
            (a.min(b), a.max(b))
        })
    };
    let mut sides: Vec<(u32, u32)> = (0..surface.points.len()).filter_map(side).collect();
    sides.sort_unstable();
    let count = |side: (u32, u32)| {
        let from = sides.partition_point(|&other| other < side);
        sides[from..].iter().take_while(|&&other| other == side).count()
    };
    (0..surface.points.len()).map(|from| side(from).is_some_and(|side| count(side) == 1)).collect()
}

/// The borders that pass the region's members and rim, each chained as far as those go and
/// one vertex farther.
///
/// Only lines that the walk over the surface met are here. A line of another patch that
/// runs through the splat's box bounds nothing (Ivo 2020, Fig. 26) and is never met. Where
/// the walk met both sides of a line, around the end of one that ends inside the surface,
/// the line bounds nothing either: both sides are the splat's own. `open` is as
/// [`open_sides`] has it, or empty where nobody asks for that.
#[must_use]
pub fn outlines(surface: &Surface, region: &Region, pose: &Pose, open: &[bool]) -> Vec<Outline> {
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
        let (mut points, mut ends) = (Vec::new(), false);
        let mut point = start;
        while let Some(after) = next(point) {
            let at = sides.partition_point(|side| side.0 < point);
            if std::mem::replace(&mut done[at], true) {
                break;
            }
            points.push(flat(point));
            ends |= open.get(point as usize).copied().unwrap_or_default();
            point = after;
        }
        if !points.is_empty() {
            let closed = point == start;
            if !closed {
                points.push(flat(point));
            }
            found.push(Outline { points, closed, ends });
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
