//! Finds what lies near a point through a hierarchy of bounding boxes.

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

/// A hierarchy over boxes, each known by its number.
pub(super) struct BoxTree {
    tree: Bvh,
}

/// What lies nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest<T> {
    /// Number of its box.
    pub(super) item: u32,
    pub(super) distance: f64,
    /// What else was found of it.
    pub(super) place: T,
}

impl BoxTree {
    /// A hierarchy over boxes given by their least and greatest corners; numbers without a box
    /// are never found.
    pub(super) fn new(boxes: impl Iterator<Item = Option<(DVec3, DVec3)>>) -> Self {
        let corner = |p: DVec3| Vector::new(p.x, p.y, p.z);
        let leaf = |(low, high)| Aabb::new(corner(low), corner(high));
        let leaves: Vec<(usize, Aabb)> =
            boxes.enumerate().filter_map(|(n, corners)| Some((n, leaf(corners?)))).collect();
        Self { tree: Bvh::from_iter(BvhBuildStrategy::Binned, leaves) }
    }

    /// The nearest item that lies nearer than `within`.
    ///
    /// `measure` gives an item's distance, if it is below the one it is handed.
    pub(super) fn nearest<T>(
        &self,
        point: DVec3,
        within: f64,
        measure: impl Fn(u32, f64) -> Option<(f64, T)>,
    ) -> Option<Nearest<T>> {
        let found = self.tree.find_best(within, |node, _| gap(node, point), measure);
        found.map(|(item, (distance, place))| Nearest { item, distance, place })
    }

    /// As [`BoxTree::nearest`], for points that follow each other closely: `last` is the point
    /// before and its distance, and bounds the next one's.
    pub(super) fn next_nearest<T>(
        &self,
        point: DVec3,
        last: &mut Option<(DVec3, f64)>,
        measure: impl Fn(u32, f64) -> Option<(f64, T)>,
    ) -> Option<Nearest<T>> {
        let bound =
            last.map_or(f64::INFINITY, |(at, distance)| (distance + at.distance(point)) * LOOSE + LEAST);
        let found = self.nearest(point, bound, measure);
        *last = found.as_ref().map(|found| (point, found.distance));
        found
    }

    /// The items whose boxes a sphere meets, in no order that means anything.
    pub(super) fn near(&self, point: DVec3, radius: f64) -> impl Iterator<Item = u32> {
        self.tree.leaves(move |node| gap(node, point) <= radius)
    }
}

/// Covers the rounding of a bound that is taken over from the point before.
const LOOSE: f64 = 1.0 + 1e-9;

/// As much, where that bound is 0; model units, far below the grids of any file.
const LEAST: f64 = 1e-12;

/// Distance from a point to a box, 0 inside.
fn gap(node: &BvhNode, point: DVec3) -> f64 {
    let [low, high] = [node.mins(), node.maxs()].map(|corner| DVec3::new(corner.x, corner.y, corner.z));
    (low - point).max(point - high).max(DVec3::ZERO).length()
}
