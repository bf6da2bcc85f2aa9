//! The borders and feature lines of a region, in the splat's plane.

use std::cell::Cell;

use glam::{DVec2, DVec3};

use super::region::Region;
use crate::analyse::surface::{NONE, Surface};
use crate::fit::ellipse::crossings;
use crate::fit::offset::turns_sharply;
use crate::fit::pose::Pose;
use crate::model::polyline::nearest_on;

/// A directed line with the surface on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its vertices in `(u, v)`.
    pub points: Vec<DVec2>,
    /// How high each lies over the splat's plane.
    pub heights: Vec<f64>,
    /// Whether it is a loop; then its first point is not repeated.
    pub closed: bool,
    /// Whether the surface ends at some of it, so that nothing lies across.
    pub ends: bool,
}

/// Places told of on each side of an outline. Sides are short beside the stretches along which a curve that runs
/// beside the rim may leave an ellipse, but for long straight ones.
const PLACES: u32 = 4;

/// A side of a border: the points it leads from and to.
pub type Side = (u32, u32);

impl Outline {
    /// Whether a place in splat coordinates lies within `reach` of the line, in space.
    ///
    /// The search begins at side `last` and goes on to both sides of it; there the side found is left,
    /// for the next place of a curve to begin at.
    #[must_use]
    pub fn near(&self, place: DVec3, reach: f64, last: &Cell<usize>) -> bool {
        let sides = self.sides();
        let around = |n: usize| last.get() + if n.is_multiple_of(2) { sides - n / 2 } else { n / 2 + 1 };
        let is_near = |side: &usize| {
            nearest_on(self.vertex(*side), self.vertex(side + 1), place).distance(place) <= reach
        };
        let found = (0..sides).map(|n| around(n) % sides).find(is_near);
        last.set(found.unwrap_or(last.get()));
        found.is_some()
    }

    /// Places along it, a few on each side, in splat coordinates.
    pub fn places(&self) -> impl Iterator<Item = DVec3> {
        let share = |k: u32| (f64::from(k) + 0.5) / f64::from(PLACES);
        let on_side =
            move |n: usize| (0..PLACES).map(move |k| self.vertex(n).lerp(self.vertex(n + 1), share(k)));
        (0..self.sides()).flat_map(on_side)
    }

    fn sides(&self) -> usize {
        self.points.len() - usize::from(!self.closed)
    }

    /// A vertex in splat coordinates; after the last of a loop comes the first.
    fn vertex(&self, n: usize) -> DVec3 {
        let n = n % self.points.len();
        self.points[n].extend(self.heights[n])
    }

    /// Where it turns sharply to either side, in splat coordinates.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> {
        let count = self.points.len();
        let inner = if self.closed { 0..count } else { 1..count - 1 };
        let turns = move |&n: &usize| {
            let [before, at, after] = [n + count - 1, n, n + 1].map(|n| self.points[n % count]);
            let [before, after] = [at - before, after - at].map(DVec2::normalize_or_zero);
            turns_sharply(before, after)
        };
        inner.filter(turns).map(|n| self.points[n].extend(self.heights[n]))
    }
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
    let (sides, _) = one_sided(surface, border_sides(surface, region));
    let next = |point: u32| {
        let at = sides.partition_point(|side| side.0 < point);
        sides.get(at).filter(|side| side.0 == point).map(|side| side.1)
    };
    let mut followed: Vec<u32> = sides.iter().map(|side| side.1).collect();
    followed.sort_unstable();
    let local = |point: u32| pose.to_local(surface.point(point));
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
            points.push(local(point));
            ends |= open.get(point as usize).copied().unwrap_or_default();
            point = after;
        }
        if !points.is_empty() {
            let closed = point == start;
            if !closed {
                points.push(local(point));
            }
            let heights = points.iter().map(|point| point.z).collect();
            let points = points.iter().map(|point| point.truncate()).collect();
            found.push(Outline { points, heights, closed, ends });
        }
    }
    found
}

/// The sides of all borders with an end among the members or the rim, sorted.
#[must_use]
pub fn border_sides(surface: &Surface, region: &Region) -> Vec<Side> {
    let near = region
        .members
        .iter()
        .map(|member| member.point)
        .chain(region.rim.iter().map(|&(_, outside)| outside));
    let mut sides: Vec<Side> = near
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

/// Whether a feature line ends inside an ellipse: part of it longer than `least` lies there, and the
/// region is on both sides of it.
#[must_use]
pub fn holds_an_end(surface: &Surface, region: &Region, pose: &Pose, radii: DVec2, least: f64) -> bool {
    if surface.carried.is_empty() {
        return false;
    }
    let (_, two_sided) = one_sided(surface, border_sides(surface, region));
    two_sided.into_iter().filter(|&(from, _)| !surface.is_carried(from)).any(|(from, to)| {
        let [a, b] = [from, to].map(|point| pose.to_local(surface.point(point)).truncate());
        let within = crossings(a, b, radii).map(|(enter, leave)| leave.min(1.0) - enter.max(0.0));
        within.is_some_and(|share| share * a.distance(b) > least)
    })
}

/// Sides whose other side is not there, and those whose other side is there too.
fn one_sided(surface: &Surface, sides: Vec<Side>) -> (Vec<Side>, Vec<Side>) {
    let place = |point: u32| surface.places[point as usize];
    let mut turned: Vec<(u32, u32)> = sides.iter().map(|&(from, to)| (place(to), place(from))).collect();
    turned.sort_unstable();
    sides.into_iter().partition(|&(from, to)| turned.binary_search(&(place(from), place(to))).is_err())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_to_either_side_are_told_from_bends_and_from_ends() {
        let corners = |places: &[(f64, f64)], closed: bool| {
            let points: Vec<DVec2> = places.iter().map(|&(u, v)| DVec2::new(u, v)).collect();
            let heights = (0_u8..).map(f64::from).take(points.len()).collect();
            let outline = Outline { points, heights, closed, ends: false };
            outline.corners().map(|corner| corner.z).collect::<Vec<_>>()
        };
        let steps = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 1.2)];
        assert_eq!(corners(&steps, false), [1.0, 2.0]);
        assert_eq!(corners(&steps, true), [0.0, 1.0, 2.0, 4.0]);
    }
}
