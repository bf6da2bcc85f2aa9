//! What no stage over points can be expected to beat: one pass over all neighbourhoods.

use std::num::NonZeroUsize;

use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use qsplat::analyse::canonical::morton;
use rayon::prelude::*;

/// Neighbours asked of each point, itself among them.
const NEIGHBOURS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(15);

/// Sorts the points along the Morton curve, builds a k-d tree, and asks for every point's 16
/// nearest on all threads; the sum of their squared distances.
///
/// 0 for points that the tree refuses: then every ratio to this floor is absurd.
pub fn neighbour_pass(positions: &[Vec3]) -> f64 {
    let mut order: Vec<(u64, [f32; 3])> = positions.par_iter().map(|p| (morton(*p), p.to_array())).collect();
    order.par_sort_unstable_by_key(|point| point.0);
    let points: Vec<[f32; 3]> = order.into_iter().map(|point| point.1).collect();
    let Ok(tree) = ImmutableKdTree::<f32, 3>::new_from_slice(&points) else { return 0.0 };
    let farthest = |point: &[f32; 3]| {
        let found = tree.query(point).nearest_n::<SquaredEuclidean<f32>>(NEIGHBOURS).execute();
        f64::from(found.iter().map(|near| near.distance).fold(0.0, f32::max))
    };
    points.par_iter().map(farthest).sum()
}
