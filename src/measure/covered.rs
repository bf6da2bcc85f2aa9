//! Which places of clipped borders lie inside another splat, where they bound nothing.

use glam::{DVec2, DVec3};

use super::box_tree::BoxTree;
use crate::model::asset::Asset;
use crate::model::clip_curve::Conic;
use crate::model::curve_ends::APART;
use crate::model::splat::Splat;

/// Error bounds by which a place at a feature edge must lie inside another splat's border. Both sides
/// are cut at most one bound outside the line there, so that each passes over the other's border by
/// less.
const INSIDE: f64 = 3.0;

/// A place farther from every line than this, in error bounds, is at no feature edge: what covers it
/// at all hides a border there.
pub(super) const AT_EDGE: f64 = 1.0;

/// Directions in which the border is looked for.
const AROUND: u32 = 8;

/// The splats of an asset, to be asked what lies inside them.
pub(super) struct Insides<'a> {
    splats: Vec<(&'a Splat, Vec<Conic>)>,
    tree: BoxTree,
    max_error: f64,
}

impl<'a> Insides<'a> {
    pub(super) fn new(asset: &'a Asset) -> Self {
        let splats = asset.splats.iter().map(|splat| (splat, splat.conics())).collect();
        let around = |splat: &Splat| {
            let reach = DVec3::splat(splat.bounding_radius());
            Some((splat.center - reach, splat.center + reach))
        };
        let tree = BoxTree::new(asset.splats.iter().map(around));
        Self { splats, tree, max_error: asset.max_error }
    }

    /// Whether a place on a splat's border lies inside another: well inside `at_edge` of a line.
    pub(super) fn hold(&self, place: DVec3, own: u32, at_edge: bool) -> bool {
        let margin = if at_edge { INSIDE * self.max_error } else { 0.0 };
        self.tree.near(place, 0.0).any(|index| index != own && self.inside(index, place, margin))
    }

    fn inside(&self, index: u32, place: DVec3, margin: f64) -> bool {
        let (splat, conics) = &self.splats[index as usize];
        let local = splat.to_local(place);
        let uv = local.truncate();
        let inner = splat.radii - margin;
        let around = (0..AROUND).map(|n| {
            let angle = std::f64::consts::TAU * f64::from(n) / f64::from(AROUND);
            uv + margin * DVec2::new(libm::cos(angle), libm::sin(angle))
        });
        inner.min_element() > 0.0
            && (uv / inner).length_squared() <= 1.0
            && (local.z - splat.height(uv)).abs() <= APART * self.max_error
            && around
                .chain([uv])
                .all(|uv| !conics.iter().any(|conic| conic.cuts(uv)) && !splat.partners_cut(uv))
    }
}
