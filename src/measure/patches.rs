//! The union of an asset's clipped splats as one surface.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::box_tree::{BoxTree, Nearest};
use super::patch::Patch;
use crate::model::asset::Asset;

/// All patches of an asset, and a way to the nearest.
pub(super) struct Patches<'a> {
    pub(super) patches: Vec<Patch<'a>>,
    tree: BoxTree,
}

impl<'a> Patches<'a> {
    pub(super) fn new(asset: &'a Asset) -> Self {
        let patches: Vec<Patch<'a>> = asset.splats.par_iter().map(Patch::new).collect();
        let tree = BoxTree::new(patches.iter().map(Patch::bounds));
        Self { patches, tree }
    }

    /// The place of the union nearest to a point; `last` is the point before, see
    /// [`BoxTree::next_nearest`]. `None` if nothing is left of any splat.
    pub(super) fn nearest(&self, point: DVec3, last: &mut Option<(DVec3, f64)>) -> Option<Nearest<DVec2>> {
        self.tree.next_nearest(point, last, |item, within| self.measure(item, point, within))
    }

    /// The nearest place of every patch that is at most `reach` away, nearest first.
    pub(super) fn within(&self, point: DVec3, reach: f64) -> Vec<Nearest<DVec2>> {
        let above = reach.next_up();
        let mut found: Vec<Nearest<DVec2>> = (self.tree.near(point, reach))
            .filter_map(|item| {
                let (distance, place) = self.measure(item, point, above)?;
                Some(Nearest { item, distance, place })
            })
            .collect();
        found.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.item.cmp(&b.item)));
        found
    }

    fn measure(&self, item: u32, point: DVec3, within: f64) -> Option<(f64, DVec2)> {
        let foot = self.patches[item as usize].nearest(point, within)?;
        Some((foot.distance, foot.uv))
    }

    /// The unit normal of a place.
    pub(super) fn normal(&self, at: &Nearest<DVec2>) -> DVec3 {
        self.patches[at.item as usize].splat.normal(at.place)
    }

    /// Sum of the areas.
    pub(super) fn area(&self) -> f64 {
        self.patches.iter().map(|patch| patch.area).sum()
    }
}
