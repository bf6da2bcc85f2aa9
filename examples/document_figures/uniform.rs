//! Uniform sampling of a cloud by discs of one radius.
//!
//! Clustering by region growing after Wu and Kobbelt 2004, as T 2.2.1 and 3.1 describe it: a
//! point that nothing covers becomes the centre of a splat; the points beneath that splat count
//! as covered, but for those on their convex hull, which neighbours must cover, so that no hole
//! is left.

use std::cmp::Ordering;

use glam::DVec2;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use qsplat::Result;
use qsplat::analyse::canonical::mix;
use qsplat::fit::pose::Pose;

use super::hull::hull;
use super::scatter::Scattered;
use super::search::tree;

/// Normals that make a smaller cosine (60°) belong to another sheet of the surface.
const FACING: f32 = 0.5;

/// A sampling.
pub struct Sampling {
    /// How many splats.
    pub splats: usize,
    /// Sum of their areas, squared model units.
    pub area: f64,
}

/// Points and the search among them.
pub struct Cloud<'a> {
    scattered: &'a Scattered,
    tree: ImmutableKdTree<f32, 3>,
}

impl<'a> Cloud<'a> {
    /// Builds the search tree.
    ///
    /// # Errors
    /// [`qsplat::Error::Internal`] should the tree refuse the points.
    pub fn new(scattered: &'a Scattered) -> Result<Self> {
        Ok(Self { scattered, tree: tree(&scattered.points)? })
    }

    /// Covers all points by splats of no more than this radius (model units).
    ///
    /// Seeds come in an order that has nothing to do with where they lie.
    pub fn sample(&self, radius: f64) -> Sampling {
        let count = self.scattered.points.len() as u32;
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_unstable_by_key(|&n| mix(u64::from(n)));
        let mut covered = vec![false; count as usize];
        let mut sampling = Sampling { splats: 0, area: 0.0 };
        for seed in order {
            if !covered[seed as usize] {
                let reach = self.cover(seed, radius, &mut covered);
                sampling.splats += 1;
                sampling.area += std::f64::consts::PI * reach * reach;
            }
        }
        sampling
    }

    /// Marks what a splat around a seed covers; how far from it the farthest of its points lies.
    fn cover(&self, seed: u32, radius: f64, covered: &mut [bool]) -> f64 {
        let (points, normals) = (&self.scattered.points, &self.scattered.normals);
        let (center, normal) = (points[seed as usize], normals[seed as usize]);
        let pose = Pose::at(center.as_dvec3(), normal.as_dvec3());
        let found = self
            .tree
            .query(&center.to_array())
            .within::<SquaredEuclidean<f32>>((radius * radius) as f32)
            .unsorted()
            .execute();
        let members: Vec<u32> = found
            .iter()
            .map(|found| found.item)
            .filter(|&n| normals[n as usize].dot(normal) > FACING)
            .collect();
        let local: Vec<DVec2> =
            members.iter().map(|&n| pose.to_local(points[n as usize].as_dvec3()).truncate()).collect();
        let mut rim = hull(&local).into_iter().peekable();
        for (index, &member) in members.iter().enumerate() {
            match rim.peek().map(|corner| corner.cmp(&index)) {
                Some(Ordering::Equal) => _ = rim.next(),
                _ => covered[member as usize] = true,
            }
        }
        // Even on the hull, as where it lies alone, the seed itself needs no further splat.
        covered[seed as usize] = true;
        local.iter().map(|uv| uv.length()).fold(0.0, f64::max)
    }
}
