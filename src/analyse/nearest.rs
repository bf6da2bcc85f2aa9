//! The nearest neighbours of every point of a cloud.

use std::num::NonZeroUsize;

use glam::{DVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

use super::blocks::Blocks;
use super::surface::NONE;
use crate::error::{Error, Result};

/// Neighbours kept of a point: about two rings of an even sampling.
pub const NEAREST: usize = 16;

/// Of neighbours at distances that differ by less than this share, none or all are kept: on
/// a lattice the farthest kept would be a matter of chance otherwise.
const TIE: f64 = 1e-5;

/// Ties are kept, in whatever choice the search made, where fewer would remain otherwise.
const FEWEST: usize = 8;

/// Points asked for: itself, those kept, and one more that shows whether the last is tied.
pub(super) const ASKED: usize = NEAREST + 2;

/// For each point its nearest others, nearest first, filled up with [`NONE`].
pub type Nearest = Vec<[u32; NEAREST]>;

/// Finds what lies near a place.
pub struct Search {
    tree: ImmutableKdTree<f32, 3>,
    points: Vec<[f32; 3]>,
}

impl Search {
    /// A search over distinct points (model units).
    ///
    /// # Errors
    /// [`Error::Internal`] should the search tree not take the points.
    pub fn new(positions: &[Vec3]) -> Result<Self> {
        let points: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
        let tree = ImmutableKdTree::new_from_slice(&points).map_err(|error| {
            Error::Internal(format!("the neighbour search refused the points: {error:?}"))
        })?;
        Ok(Self { tree, points })
    }

    /// The nearest others of each point, fastest for points along the Morton curve.
    #[must_use]
    pub fn nearest(&self) -> Nearest {
        let all = 0..self.points.len() as u32;
        let blocks = Blocks::new(&self.points, self);
        blocks
            .map_or_else(|| all.into_par_iter().map(|n| self.others(n)).collect(), |blocks| blocks.nearest())
    }

    /// The nearest others of one point.
    pub(super) fn others(&self, index: u32) -> [u32; NEAREST] {
        const COUNT: NonZeroUsize = NonZeroUsize::MIN.saturating_add(ASKED - 1);
        let point = &self.points[index as usize];
        let found = self.tree.query(point).nearest_n::<SquaredEuclidean<f32>>(COUNT).execute();
        chosen(&self.points, index, found.iter().map(|found| found.item))
    }

    /// The `count` points nearest to a place, nearest first; all where there are fewer.
    #[must_use]
    pub fn around(&self, place: Vec3, count: usize) -> Vec<u32> {
        let Some(count) = NonZeroUsize::new(count) else { return Vec::new() };
        let found = self.tree.query(&place.to_array()).nearest_n::<SquaredEuclidean<f32>>(count).execute();
        found.iter().map(|found| found.item).collect()
    }

    /// The point nearest to a place; `None` only where there are no points.
    #[must_use]
    pub fn closest(&self, place: DVec3) -> Option<u32> {
        let place = place.as_vec3().to_array();
        let one = NonZeroUsize::MIN;
        self.tree
            .query(&place)
            .nearest_n::<SquaredEuclidean<f32>>(one)
            .execute()
            .first()
            .map(|found| found.item)
    }
}

/// The others among those found, nearest first, without the last ones if they are tied.
pub(super) fn chosen(positions: &[[f32; 3]], index: u32, found: impl Iterator<Item = u32>) -> [u32; NEAREST] {
    let at = |n: u32| Vec3::from(positions[n as usize]).as_dvec3();
    let here: DVec3 = at(index);
    let mut others = [(f64::INFINITY, NONE); ASKED];
    let mut count = 0;
    for other in found.filter(|&other| other != index).take(ASKED) {
        others[count] = (at(other).distance_squared(here), other);
        count += 1;
    }
    others[..count].sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    if count > NEAREST {
        let limit = others[NEAREST].0 * (1.0 - TIE);
        let untied = others[..NEAREST].partition_point(|other| other.0 < limit);
        count = if untied < FEWEST { NEAREST } else { untied };
    }
    let mut row = [NONE; NEAREST];
    for (slot, other) in row.iter_mut().zip(&others[..count]) {
        *slot = other.1;
    }
    row
}

/// The neighbours in a row of [`Nearest`].
pub fn listed(row: &[u32]) -> impl Iterator<Item = u32> + Clone + '_ {
    row.iter().copied().take_while(|&other| other != NONE)
}

/// The points of a cloud and how far apart they lie.
#[derive(Clone, Copy)]
pub struct Spacings<'a> {
    /// Finds them.
    pub search: &'a Search,
    /// Model units.
    pub positions: &'a [Vec3],
    /// Local spacings, model units.
    pub spacing: &'a [f32],
}

impl Spacings<'_> {
    /// How far the nearest point to a place is, and its spacing, model units; `None` where it has none.
    #[must_use]
    pub fn near(&self, place: DVec3) -> Option<(f64, f64)> {
        let point = self.search.closest(place)? as usize;
        let spacing = f64::from(self.spacing[point]);
        (spacing > 0.0).then(|| (self.positions[point].as_dvec3().distance(place), spacing))
    }

    /// The mean spacing of the points around a place, model units; 0 where there are none. That of a single one may be
    /// half of it.
    #[must_use]
    pub fn usual(&self, place: DVec3) -> f64 {
        let around = self.search.around(place.as_vec3(), USUAL);
        let sum: f64 = around.iter().map(|&point| f64::from(self.spacing[point as usize])).sum();
        sum / around.len().max(1) as f64
    }

    /// The spacing of the point nearest to a place, model units; 0 where it has none.
    #[must_use]
    pub fn at(&self, place: DVec3) -> f64 {
        self.near(place).map_or(0.0, |(_, spacing)| spacing)
    }
}

/// Points whose mean spacing is that of the surface around: two rings of an even sampling.
const USUAL: usize = 16;

/// Neighbours whose mean distance is a point's spacing: the first ring of an even sampling.
const RING: usize = 6;

/// Mean distance of each point's nearest few neighbours, model units; 0 for a lone point.
#[must_use]
pub fn spacing(positions: &[Vec3], nearest: &Nearest) -> Vec<f32> {
    let mean = |(index, row): (usize, &[u32; NEAREST])| {
        let here = positions[index].as_dvec3();
        let ring = listed(row).take(RING);
        let count = ring.clone().count().max(1);
        (ring.map(|other| positions[other as usize].as_dvec3().distance(here)).sum::<f64>() / count as f64)
            as f32
    };
    nearest.par_iter().enumerate().map(mean).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn neighbours_agree_with_brute_force_and_ties_go_together() {
        let value = |n: u64| (super::super::canonical::mix(n) >> 40) as f32 / (1 << 23) as f32 - 1.0;
        let random: Vec<Vec3> =
            (0..700).map(|n| Vec3::new(value(3 * n), value(3 * n + 1), value(3 * n + 2))).collect();
        let lattice: Vec<Vec3> =
            (0..900).map(|n| Vec3::new((n % 30) as f32, (n / 30) as f32, 0.0) / 30.0).collect();
        let line: Vec<Vec3> = (0..5).map(|n| Vec3::X * n as f32 / 5.0).collect();
        let sorted = |points: &[Vec3]| {
            let order = super::super::canonical::order(points);
            order.into_iter().map(|n| points[n as usize]).collect::<Vec<Vec3>>()
        };
        // A dense sheet beside a sparse one, both with places where they end.
        let dense = (0..1500).map(|n| Vec3::new(value(5 * n), value(5 * n + 1), 0.01 * value(5 * n + 2)));
        let dense = sorted(&dense.map(|p| 0.1 * p + 0.3 * Vec3::Z).chain(random.clone()).collect::<Vec<_>>());
        let grid = sorted(&lattice);
        for points in [random, lattice, line, vec![Vec3::ZERO], dense, grid] {
            let found = Search::new(&points).unwrap().nearest();
            for (index, row) in found.iter().enumerate() {
                let distance = |n: u32| points[n as usize].as_dvec3().distance(points[index].as_dvec3());
                let listed: Vec<u32> = listed(row).collect();
                let farthest = listed.iter().map(|&n| distance(n)).fold(0.0, f64::max);
                // Whatever is not listed is no nearer than whatever is.
                let mut missing =
                    (0..points.len() as u32).filter(|n| *n != index as u32 && !listed.contains(n));
                assert!(missing.all(|n| distance(n) >= farthest));
                assert!(listed.len() >= FEWEST.min(points.len() - 1));
            }
        }
    }

    #[test]
    fn spacing_is_the_mean_over_the_first_ring() {
        let lattice: Vec<Vec3> =
            (0..900).map(|n| Vec3::new((n % 30) as f32, (n / 30) as f32, 0.0) / 64.0).collect();
        let spacing = spacing(&lattice, &Search::new(&lattice).unwrap().nearest());
        let expected = (4.0 + 2.0 * std::f32::consts::SQRT_2) / 6.0 / 64.0;
        assert!((spacing[15 * 30 + 15] - expected).abs() < 1e-6);
    }
}
