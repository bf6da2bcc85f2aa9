//! What is left of a cloud without its outliers: all that an error bound holds for.

use std::borrow::Cow;

use super::options::{Edges, Options};
use super::{cloud_lines, given_lines};
use crate::analyse::cloud_surface::cloud_outliers;
use crate::error::Result;
use crate::ingest::Input;

/// An input, and how much of it was left out.
#[derive(Clone, Debug)]
pub struct Kept<'a> {
    /// The input; a cloud without its outliers, in the same frame.
    pub input: Cow<'a, Input>,
    /// Points of the cloud that belong to no surface: outliers. 0 for a mesh.
    pub outliers: usize,
}

/// What a bake keeps of an input, or of what stands for that, with such edges and options and under this
/// bound in model units. Of the options only the edges' angle and the normals matter.
///
/// The outliers are found from the cloud itself, as by [`bake`](super::bake): with the same options they are
/// the same points.
///
/// # Errors
/// Those of [`cloud_outliers`].
pub fn kept<'a>(input: &'a Input, edges: &Edges, options: &Options, max_error: f64) -> Result<Kept<'a>> {
    let whole = Kept { input: Cow::Borrowed(input), outliers: 0 };
    let Input::Cloud(cloud) = input else { return Ok(whole) };
    let given = given_lines(edges, &cloud.frame);
    let lines = cloud_lines(cloud, edges, &given, options.edge_angle, max_error);
    let left_out = cloud_outliers(cloud, options.normals.into(), lines)?;
    if left_out.is_empty() {
        return Ok(whole);
    }
    Ok(Kept { input: Cow::Owned(Input::Cloud(cloud.without(&left_out))), outliers: left_out.len() })
}
