//! `forward`, `backward`, `normal` and `overlap`.

use super::measures::{Angles, Distances};
use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::render::input::Model;

/// How far the splats' surfaces and the input's lie from each other. Distances in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceErrors {
    /// From samples of the input's surface to the union of the clipped splats.
    pub forward: Distances,
    /// From samples of the clipped splats to the input's surface.
    pub backward: Distances,
    /// Between the splats' normal fields and the input's normals at the same places.
    pub normal: Angles,
    /// Sum of the clipped splats' areas over the mesh's area; `None` for a cloud.
    pub overlap: Option<f64>,
}

/// Measures the surfaces against each other.
///
/// # Errors
/// [`Error::Usage`] if either has no surface, or they do not lie in one frame.
pub fn surface(_asset: &Asset, _against: Model<'_>) -> Result<SurfaceErrors> {
    Err(Error::Internal("not measured yet".into()))
}
