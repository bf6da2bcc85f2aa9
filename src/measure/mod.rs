//! Numbers that say how good a result is: every error and cost of a file against its input.

mod area;
mod border;
mod box_tree;
mod cloud_fit;
pub mod edge;
mod feet;
pub mod fit;
pub mod image;
pub mod measures;
mod patch;
mod patches;
#[cfg(test)]
mod planted;
mod point_grid;
mod roots;
mod samples;
mod segment;
mod spread;
pub mod surface;
mod triangles;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::render::input::Model;
pub use measures::Measures;

/// What is measured, and against what.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The file as it is.
    pub bytes: &'a [u8],
    /// The file as decoded.
    pub asset: &'a Asset,
    /// The input it was baked from.
    pub against: Model<'a>,
    /// The feature lines, model units; `None` leaves `edge` out.
    pub lines: Option<&'a [Vec<DVec3>]>,
}

/// Measures everything.
///
/// # Errors
/// [`Error::Usage`] if file and input do not belong together.
pub fn measure(_subject: &Subject<'_>) -> Result<Measures> {
    Err(Error::Internal("not measured yet".into()))
}
