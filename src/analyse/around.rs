//! The points around one of a cloud that lie on the same side of its feature lines.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::nearest::{NEAREST, Search, listed};
use super::sided::Sided;
use super::surface::NONE;
use crate::error::Result;

/// What lies around the points of a cloud.
pub struct Around<'a> {
    sided: &'a Sided,
    search: Search,
    /// The nearest others of each point on its own side, nearest first.
    links: Vec<[u32; NEAREST]>,
}

/// Which points a walk has seen, to be used again by the next.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    walk: u32,
    by: Vec<u32>,
}

impl Seen {
    /// Forgets all, to see some of so many points.
    fn begin(&mut self, count: usize) {
        self.by.resize(count, 0);
        self.walk += 1;
    }

    /// Whether a point is seen for the first time.
    fn first(&mut self, point: u32) -> bool {
        std::mem::replace(&mut self.by[point as usize], self.walk) != self.walk
    }
}

impl<'a> Around<'a> {
    /// # Errors
    /// [`crate::Error::Internal`] should the neighbour search not take the points.
    pub fn new(sided: &'a Sided) -> Result<Self> {
        let search = Search::new(&sided.points.positions)?;
        let sites = sided.sites();
        let parts = |a: u32, b: u32| sided.cut.as_ref().is_some_and(|cut| cut.parts(&sites, a, b));
        let links = |(point, row): (usize, &[u32; NEAREST])| {
            let mut links = [NONE; NEAREST];
            let same = listed(row).filter(|&other| !parts(point as u32, other));
            links.iter_mut().zip(same).for_each(|(link, other)| *link = other);
            links
        };
        let links = sided.nearest.par_iter().enumerate().map(links).collect();
        Ok(Self { sided, search, links })
    }

    /// The `count` points nearest to one on its own side, itself first; fewer where no more can be reached
    /// without a step across a line.
    #[must_use]
    pub fn of(&self, point: u32, count: usize, seen: &mut Seen) -> Vec<u32> {
        let here = self.sided.points.positions[point as usize];
        let near = self.search.around(here, count);
        let beside = |&n: &u32| self.sided.cut.as_ref().is_some_and(|cut| cut.is_beside(n));
        if near.iter().any(beside) {
            return self.walk(point, count, seen);
        }
        std::iter::once(point).chain(near.into_iter().filter(|&other| other != point)).collect()
    }

    /// The points that a walk over the links comes to, always on to the nearest to its start.
    fn walk(&self, start: u32, count: usize, seen: &mut Seen) -> Vec<u32> {
        let positions = &self.sided.points.positions;
        // Distances are at least 0, and such floats are ordered as their bits are.
        let away = |n: u32| positions[n as usize].distance_squared(positions[start as usize]).to_bits();
        seen.begin(positions.len());
        seen.first(start);
        let mut ahead = BinaryHeap::from([Reverse((0, start))]);
        let mut found = Vec::with_capacity(count);
        while let Some(Reverse((_, point))) = ahead.pop() {
            found.push(point);
            if found.len() == count {
                break;
            }
            let next = listed(&self.links[point as usize]).filter(|&other| seen.first(other));
            ahead.extend(next.map(|other| Reverse((away(other), other))));
        }
        found
    }
}
