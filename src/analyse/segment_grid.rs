//! Finds the feature line segments near a point.

use glam::{DVec3, IVec3};

use crate::model::polyline::nearest_on;

/// Segments sorted into the cells of a uniform grid.
#[derive(Clone, Debug)]
pub struct SegmentGrid {
    segments: Vec<[DVec3; 2]>,
    cell: f64,
    /// `(cell, segment)`, sorted.
    places: Vec<([i32; 3], u32)>,
}

/// Cells a side over `[-1, 1]`; fewer where the segments are long, so that a segment never
/// enters more than [`LONGEST`] cells a side.
const FINEST: f64 = 256.0;

/// A segment's bounding box spans at most this many cells a side.
const LONGEST: f64 = 8.0;

/// The place on a segment nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Index of the segment.
    pub segment: u32,
    /// The place.
    pub point: DVec3,
    /// Its distance.
    pub distance: f64,
}

impl SegmentGrid {
    /// Sorts segments (model units) into cells.
    #[must_use]
    pub fn new(segments: Vec<[DVec3; 2]>) -> Self {
        let longest = segments.iter().map(|[a, b]| (*b - *a).abs().max_element()).fold(0.0, f64::max);
        let cell = (2.0 / FINEST).max(longest / LONGEST);
        let mut places = Vec::new();
        for (index, [a, b]) in segments.iter().enumerate() {
            let (low, high) = (cell_of(a.min(*b), cell), cell_of(a.max(*b), cell));
            for x in low.x..=high.x {
                for y in low.y..=high.y {
                    for z in low.z..=high.z {
                        places.push(([x, y, z], index as u32));
                    }
                }
            }
        }
        places.sort_unstable();
        Self { segments, cell, places }
    }

    /// A segment's ends.
    #[must_use]
    pub fn segment(&self, index: u32) -> [DVec3; 2] {
        self.segments[index as usize]
    }

    /// The nearest place within `reach` of a point; ties go to the lesser index.
    #[must_use]
    pub fn nearest(&self, point: DVec3, reach: f64) -> Option<Nearest> {
        self.nearest_of(point, reach, |_| true)
    }

    /// As [`Self::nearest`], of some segments alone.
    #[must_use]
    pub fn nearest_of(&self, point: DVec3, reach: f64, among: impl Fn(u32) -> bool) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        self.visit(point, reach, |found| {
            let nearer = |n: &Nearest| (found.distance, found.segment) < (n.distance, n.segment);
            if best.as_ref().is_none_or(nearer) && among(found.segment) {
                best = Some(found);
            }
        });
        best
    }

    /// The segments within `reach` of a point, ascending.
    #[must_use]
    pub fn within(&self, point: DVec3, reach: f64) -> Vec<u32> {
        let mut found = Vec::new();
        self.visit(point, reach, |near| found.push(near.segment));
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Calls `found` with the nearest place of each segment within `reach` of a point, perhaps repeatedly.
    fn visit(&self, point: DVec3, reach: f64, mut found: impl FnMut(Nearest)) {
        let (low, high) = (cell_of(point - reach, self.cell), cell_of(point + reach, self.cell));
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                // The cells of a column along z lie together in the sorted list.
                let from = self.places.partition_point(|(cell, _)| *cell < [x, y, low.z]);
                for &(cell, segment) in &self.places[from..] {
                    if cell > [x, y, high.z] {
                        break;
                    }
                    let [a, b] = self.segments[segment as usize];
                    let near = nearest_on(a, b, point);
                    let distance = near.distance(point);
                    if distance <= reach {
                        found(Nearest { segment, point: near, distance });
                    }
                }
            }
        }
    }
}

fn cell_of(point: DVec3, cell: f64) -> IVec3 {
    (point / cell).floor().as_ivec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_agrees_with_brute_force() {
        let value = |n: u64| (super::super::canonical::mix(n) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let point = |n: u64| DVec3::new(value(3 * n), value(3 * n + 1), value(3 * n + 2));
        let segments: Vec<_> = (0..200).map(|n| [point(n), point(n) + 0.1 * point(n + 1000)]).collect();
        let grid = SegmentGrid::new(segments.clone());
        for n in 0..200 {
            let (at, reach) = (point(n + 5000), 0.2);
            let brute =
                segments.iter().map(|[a, b]| nearest_on(*a, *b, at).distance(at)).fold(f64::MAX, f64::min);
            let found = grid.nearest(at, reach).map(|n| n.distance);
            assert_eq!(found, (brute <= reach).then_some(brute));
            let near = |s: &u32| {
                let [a, b] = segments[*s as usize];
                nearest_on(a, b, at).distance(at) <= reach
            };
            assert_eq!(grid.within(at, reach), (0..200).filter(near).collect::<Vec<u32>>());
        }
    }
}
