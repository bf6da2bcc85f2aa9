//! `edge`: how well the clipped borders of the splats follow the feature lines.

use glam::DVec3;

use super::measures::Distances;
use crate::model::asset::Asset;

/// The two-sided distance between feature lines and the splats' clipped borders, model units.
///
/// `None` where `lines` have no length: then there is nothing to follow.
#[must_use]
pub fn edge(_asset: &Asset, _lines: &[Vec<DVec3>]) -> Option<Distances> {
    None
}
