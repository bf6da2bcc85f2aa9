//! The search among points.

use glam::Vec3;
use kiddo::ImmutableKdTree;
use qsplat::{Error, Result};

/// A search tree over points.
///
/// # Errors
/// [`Error::Internal`] should the tree refuse the points.
pub fn tree(points: &[Vec3]) -> Result<ImmutableKdTree<f32, 3>> {
    let points: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
    ImmutableKdTree::new_from_slice(&points)
        .map_err(|error| Error::Internal(format!("the search tree refused the points: {error:?}")))
}
