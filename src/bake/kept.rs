//! What is left of a cloud without its outliers: all that an error bound holds for.

use std::borrow::Cow;

use super::lines::{cloud_lines, given_lines};
use super::options::{Edges, Options};
use crate::analyse::cloud_surface::cloud_discs;
use crate::error::Result;
use crate::ingest::Input;
use crate::model::discs::Discs;

/// An input, and how much of it was left out.
#[derive(Clone, Debug)]
pub struct Kept<'a> {
    /// The input; a cloud without its outliers, in the same frame.
    pub input: Cow<'a, Input>,
    /// Points of the cloud that belong to no surface: outliers. 0 for a mesh.
    pub outliers: usize,
    /// The surface that the points of the cloud tell of. Empty for a mesh.
    pub discs: Discs,
}

/// What a bake keeps of an input, or of what stands for that, with such edges and options and under this
/// bound in model units. Of the options only the edges' angle and the normals matter; `noise` is that of the
/// input's points, as [`Meant::noise`](super::Meant::noise).
///
/// The outliers are found from the cloud itself, as by [`bake`](super::bake): with the same options they are
/// the same points.
///
/// # Errors
/// Those of [`cloud_discs`].
pub fn kept<'a>(
    input: &'a Input,
    edges: &Edges,
    noise: Option<f64>,
    options: &Options,
    max_error: f64,
) -> Result<Kept<'a>> {
    let Input::Cloud(cloud) = input else {
        return Ok(Kept::of(input, &[], Discs::default()));
    };
    let given = given_lines(edges, &cloud.frame);
    let lines = cloud_lines(edges, &given, options.edge_angle, max_error);
    let told = cloud_discs(cloud, options.normals.into(), lines, noise)?;
    Ok(Kept::of(input, &told.left_out, told.discs))
}

impl<'a> Kept<'a> {
    /// What is left of an input without some of its points, which ascend, with the discs of the others.
    pub(super) fn of(input: &'a Input, left_out: &[u32], discs: Discs) -> Self {
        let outliers = left_out.len();
        let input = match input {
            Input::Cloud(cloud) if outliers > 0 => Cow::Owned(Input::Cloud(cloud.without(left_out))),
            Input::Cloud(_) | Input::Mesh(_) => Cow::Borrowed(input),
        };
        Self { input, outliers, discs }
    }
}
