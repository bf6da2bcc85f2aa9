//! Feature lines as a network of short segments, resampled at a cloud's spacing.

use glam::{DVec3, Vec3};

use super::canonical;
use super::detours::detours;
use super::doubled::merged;
use super::nearest::Spacings;
use super::segment_grid::SegmentGrid;
use super::surface::{NONE, Rows};

/// Of vertices nearer to each other than this share of the spacing one is enough.
const DENSE: f64 = 0.5;

/// A line that turns by more than this at a vertex (cosine of 15°) keeps it.
const TURN: f64 = 0.966;

/// A line goes smoothly on through a node where two segments meet within this cosine (30°).
const SMOOTH: f64 = 0.866;

/// Where more segments than this meet, none carries another on: corners of models have up to twelve, and the work at
/// each stays bounded.
pub(super) const CROWD: usize = 12;

/// A line farther than this many spacings from the cloud touches no surface. Spacings of single points are as small as
/// half of those around: lines three spacings off have no gaps.
const OFF: f64 = 5.0;

/// Of lines closer together than this many spacings one is left: a surface between them would have less than a row of
/// points. With 0.7 the thread of abc-00000049, of 500,000 points, takes 1.4 times the bytes; with 1.5 as many.
const CLOSE: f64 = 1.0;

/// Of several ways between two places where lines meet, none longer than this many spacings, one is left: where lines
/// are made one that keep close to each other here and there.
const DETOUR: f64 = 3.0;

/// Segments are halved no more than so often: a million samples on one.
const HALVINGS: u32 = 20;

/// No network has more segments.
const MOST_SEGMENTS: usize = 4_000_000;

/// Nodes and the segments between them, in an order that does not depend on that of the lines.
#[derive(Clone, Debug, Default)]
pub struct Network {
    /// Where lines begin, end, meet, or were sampled, model units.
    pub nodes: Vec<Vec3>,
    /// Pairs of nodes, the lesser first, ascending.
    pub segments: Vec<[u32; 2]>,
    /// For each node, its segments.
    pub at_node: Rows,
    /// Segments as given, counted over all lines, of those lines no part of which comes near the
    /// cloud; ascending.
    pub far: Vec<u32>,
    /// Length of the lines that ran closely beside others and gave way to them, model units.
    pub merged: f64,
    /// Segments that only carry lines on beyond their ends, ascending.
    pub carried: Vec<u32>,
}

/// Segments that go smoothly on, one to the next.
#[derive(Clone, Debug)]
pub struct Strand {
    /// The segments, in the order in which they follow each other.
    pub segments: Vec<u32>,
    /// Whether the last leads to the first.
    pub closed: bool,
    /// Model units.
    pub length: f64,
}

impl Network {
    /// Resamples lines (model units) where they pass near a cloud, and makes those one that keep close to each other.
    #[must_use]
    pub fn new(lines: &[Vec<DVec3>], around: &Spacings<'_>) -> Self {
        Self::sampled(lines, around).distinct(around)
    }

    fn sampled(lines: &[Vec<DVec3>], around: &Spacings<'_>) -> Self {
        let near = |place: DVec3| around.near(place);
        let (mut pieces, mut far, mut given) = (Vec::new(), Vec::new(), 0);
        for line in lines {
            let (before, first) = (pieces.len(), given);
            given += line.len().saturating_sub(1) as u32;
            for side in thinned(line, &near).windows(2) {
                halve(side[0], side[1], HALVINGS, &near, &mut pieces);
            }
            if pieces.len() == before {
                far.extend(first..given);
            }
        }
        Self { far, ..Self::of_pieces(&pieces) }
    }

    /// Makes lines one that keep close to each other.
    #[must_use]
    pub fn distinct(self, around: &Spacings<'_>) -> Self {
        let reach = |spacings: f64| move |place: DVec3| spacings * around.usual(place);
        let (pieces, merged) = merged(&self, &reach(CLOSE));
        let network = Self { far: self.far, merged: self.merged + merged, ..Self::of_pieces(&pieces) };
        let detours = detours(&network, &reach(DETOUR));
        let merged = network.merged + detours.iter().map(|&segment| network.length(segment)).sum::<f64>();
        Self { merged, ..network.without(&detours) }
    }

    pub(super) fn of_pieces(pieces: &[[Vec3; 2]]) -> Self {
        let mut nodes: Vec<Vec3> = pieces.as_flattened().to_vec();
        nodes.sort_unstable_by_key(|&node| canonical::key(node));
        nodes.dedup();
        let index = |node: Vec3| {
            let key = canonical::key(node);
            nodes.partition_point(|&other| canonical::key(other) < key) as u32
        };
        let mut segments: Vec<[u32; 2]> = pieces
            .iter()
            .map(|ends| ends.map(index))
            .filter(|[a, b]| a != b)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        segments.sort_unstable();
        segments.dedup();
        let at_node =
            segments.iter().zip(0_u32..).flat_map(|(ends, segment)| ends.map(|end| (end, segment))).collect();
        Self { at_node: Rows::from_pairs(nodes.len(), at_node), nodes, segments, ..Self::default() }
    }

    /// A segment's ends.
    #[must_use]
    pub fn ends(&self, segment: u32) -> [DVec3; 2] {
        self.segments[segment as usize].map(|node| self.nodes[node as usize].as_dvec3())
    }

    /// A segment's length.
    #[must_use]
    pub fn length(&self, segment: u32) -> f64 {
        let [a, b] = self.ends(segment);
        a.distance(b)
    }

    /// Unit vector from a segment's first end to its second.
    #[must_use]
    pub fn along(&self, segment: u32) -> DVec3 {
        let [a, b] = self.ends(segment);
        (b - a).normalize_or(DVec3::X)
    }

    /// Unit vector along a segment from one of its nodes.
    pub(super) fn along_from(&self, segment: u32, node: u32) -> DVec3 {
        let along = self.along(segment);
        if self.segments[segment as usize][0] == node { along } else { -along }
    }

    /// Adds to some segments all that meet them, and those that meet these in turn as far as they do within
    /// `reach` of a place.
    pub fn follow(&self, segments: &mut Vec<u32>, place: DVec3, reach: f64) {
        let (given, mut at) = (segments.len(), 0);
        while at < segments.len() {
            for node in self.segments[segments[at] as usize] {
                if at >= given && self.nodes[node as usize].as_dvec3().distance(place) > reach {
                    continue;
                }
                for &other in self.at_node.row(node) {
                    if !segments.contains(&other) {
                        segments.push(other);
                    }
                }
            }
            at += 1;
        }
    }

    /// A segment and those that carry it smoothly on beyond one of its nodes, each with the node that it leads to;
    /// without end where the line is closed.
    pub fn onward(&self, segment: u32, node: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.walk(segment, node, Self::beyond)
    }

    /// The same, on through nodes where more than two segments meet.
    pub fn through(&self, segment: u32, node: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.walk(segment, node, Self::straight_on)
    }

    /// The same, on through all nodes where two segments meet, however they turn.
    pub fn by_twos(&self, segment: u32, node: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.walk(segment, node, |network, segment, node| match *network.at_node.row(node) {
            [a, b] if a == segment => b,
            [a, _] => a,
            _ => NONE,
        })
    }

    fn walk(
        &self,
        segment: u32,
        node: u32,
        next: fn(&Self, u32, u32) -> u32,
    ) -> impl Iterator<Item = (u32, u32)> + '_ {
        std::iter::successors(Some((segment, node)), move |&(segment, node)| {
            let next = next(self, segment, node);
            (next != NONE).then(|| (next, self.across(next, node)))
        })
    }

    /// The strands of the network, each segment in one, the longest first.
    #[must_use]
    pub fn strands(&self) -> Vec<Strand> {
        let mut seen = vec![false; self.segments.len()];
        let mut strands = Vec::new();
        for first in 0..self.segments.len() as u32 {
            if !seen[first as usize] {
                let strand = self.strand(first);
                strand.segments.iter().for_each(|&segment| seen[segment as usize] = true);
                strands.push(strand);
            }
        }
        // Stable: of those as long the first stays first.
        strands.sort_by(|a, b| b.length.total_cmp(&a.length));
        strands
    }

    fn strand(&self, segment: u32) -> Strand {
        let onward = |end: usize| {
            self.onward(segment, self.segments[segment as usize][end]).skip(1).map(|(segment, _)| segment)
        };
        let closed = onward(1).any(|other| other == segment);
        let mut segments: Vec<u32> = if closed { Vec::new() } else { onward(0).collect() };
        segments.reverse();
        segments.push(segment);
        segments.extend(onward(1).take_while(|&other| other != segment));
        let length = segments.iter().map(|&segment| self.length(segment)).sum();
        Strand { segments, closed, length }
    }

    /// Finds its segments by place.
    #[must_use]
    pub fn grid(&self) -> SegmentGrid {
        SegmentGrid::new((0..self.segments.len() as u32).map(|segment| self.ends(segment)).collect())
    }

    /// The network with its nodes elsewhere (model units).
    #[must_use]
    pub fn moved(self, places: &[DVec3]) -> Self {
        let place = |node: u32| places[node as usize].as_vec3() + Vec3::ZERO;
        let pieces: Vec<[Vec3; 2]> = self.segments.iter().map(|ends| ends.map(place)).collect();
        Self { far: self.far, merged: self.merged, ..Self::of_pieces(&pieces) }
    }

    /// The network and pieces that carry its lines on.
    #[must_use]
    pub fn with_carried(self, pieces: &[[Vec3; 2]]) -> Self {
        let all = Self::of_pieces(&[self.pieces(|_| true).as_slice(), pieces].concat());
        let ends = |ends: &[u32; 2]| ends.map(|node| all.nodes[node as usize]);
        let carried = (0_u32..).zip(&all.segments).filter(|(_, nodes)| self.find(ends(nodes)).is_none());
        Self { carried: carried.map(|(n, _)| n).collect(), far: self.far, merged: self.merged, ..all }
    }

    /// The segment between two places.
    #[must_use]
    pub fn find(&self, ends: [Vec3; 2]) -> Option<u32> {
        let mut ends = ends.map(canonical::key);
        ends.sort_unstable();
        let key = |node: u32| canonical::key(self.nodes[node as usize]);
        // They are sorted by the keys of their ends.
        self.segments.binary_search_by(|own| own.map(key).cmp(&ends)).ok().map(|n| n as u32)
    }

    /// Whether a segment only carries a line on beyond its end.
    #[must_use]
    pub fn is_carried(&self, segment: u32) -> bool {
        self.carried.binary_search(&segment).is_ok()
    }

    /// The places of the ends of some segments.
    fn pieces(&self, wanted: impl Fn(u32) -> bool) -> Vec<[Vec3; 2]> {
        let segments = (0_u32..).zip(&self.segments).filter(|&(n, _)| wanted(n));
        segments.map(|(_, ends)| ends.map(|node| self.nodes[node as usize])).collect()
    }

    /// The network without some of its segments, which are numbered ascending; none carries it on yet.
    #[must_use]
    pub fn without(self, segments: &[u32]) -> Self {
        let pieces = self.pieces(|segment| segments.binary_search(&segment).is_err());
        Self { far: self.far, merged: self.merged, ..Self::of_pieces(&pieces) }
    }

    /// The node of a segment that is not this one of its two.
    pub(super) fn across(&self, segment: u32, node: u32) -> u32 {
        let [a, b] = self.segments[segment as usize];
        if a == node { b } else { a }
    }

    /// The segment that carries another smoothly on beyond one of its nodes, where no others meet them; or [`NONE`].
    #[must_use]
    pub fn beyond(&self, segment: u32, node: u32) -> u32 {
        if self.at_node.row(node).len() == 2 { self.straight_on(segment, node) } else { NONE }
    }

    /// The segment that carries another smoothly on beyond one of its nodes, whatever meets them there; or [`NONE`].
    /// Of all at the node each of the two turns least into the other.
    fn straight_on(&self, segment: u32, node: u32) -> u32 {
        if self.at_node.row(node).len() > CROWD {
            return NONE;
        }
        let onward = self.smoothest(segment, node);
        if onward != NONE && self.smoothest(onward, node) == segment { onward } else { NONE }
    }

    /// Of the others at a node of a segment the one that it turns least into, if it turns smoothly; or [`NONE`].
    fn smoothest(&self, segment: u32, node: u32) -> u32 {
        let outward = |segment: u32| self.along_from(segment, node);
        let own = outward(segment);
        let others = self.at_node.row(node).iter().filter(|&&other| other != segment);
        let turns = others.map(|&other| (own.dot(outward(other)), other));
        let least = turns.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        least.filter(|(turn, _)| *turn < -SMOOTH).map_or(NONE, |(_, other)| other)
    }
}

/// A line without vertices that lie closer together than a cloud's spacing can show.
fn thinned(line: &[DVec3], near: &impl Fn(DVec3) -> Option<(f64, f64)>) -> Vec<DVec3> {
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return Vec::new() };
    let mut kept = vec![first];
    let mut before = first;
    for pair in line.windows(2).skip(1) {
        let (here, next) = (pair[0], pair[1]);
        let from = kept[kept.len() - 1];
        let turn = (here - before).normalize_or_zero().dot((next - here).normalize_or_zero());
        let dense = near(here).is_some_and(|(_, spacing)| from.distance(here) < DENSE * spacing);
        if here != from && (turn < TURN || !dense) {
            kept.push(here);
        }
        before = here;
    }
    kept.push(last);
    kept
}

/// Halves a segment until it is no longer than the spacing; parts far from the cloud are
/// left out.
fn halve(
    a: DVec3,
    b: DVec3,
    halvings: u32,
    near: &impl Fn(DVec3) -> Option<(f64, f64)>,
    pieces: &mut Vec<[Vec3; 2]>,
) {
    let (middle, length) = (0.5 * (a + b), a.distance(b));
    let Some((distance, spacing)) = near(middle) else { return };
    if !(length > 0.0 && distance <= 0.5 * length + OFF * spacing) || pieces.len() >= MOST_SEGMENTS {
        return;
    }
    if length <= spacing || halvings == 0 {
        pieces.push([a.as_vec3() + Vec3::ZERO, b.as_vec3() + Vec3::ZERO]);
        return;
    }
    halve(a, middle, halvings - 1, near, pieces);
    halve(middle, b, halvings - 1, near, pieces);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::planted::{lay, random, spaced};

    #[test]
    fn lines_closer_than_points_usually_lie_are_one_all_along() {
        // A lattice of 0.02, and clumps of four points here and there between two lines.
        let lattice =
            (0..101 * 101).map(|n| 0.02 * Vec3::new((n % 101) as f32 - 50.0, (n / 101) as f32 - 50.0, 0.0));
        let clumps = (0..36).map(|n| {
            let (x, y) = (0.2 * f64::from(n / 4) - 0.79, 0.007);
            (DVec3::new(x, y, 0.0) + 0.002 * DVec3::new(random(2 * n as u64), random(2 * n as u64 + 1), 0.0))
                .as_vec3()
        });
        let positions: Vec<Vec3> = lattice.chain(clumps).collect();
        let (search, _, spacing) = lay(&positions);
        let line = |y: f64| vec![DVec3::new(-0.9, y, 0.0), DVec3::new(0.9, y, 0.0)];
        let network = Network::new(&[line(0.0), line(0.014)], &spaced(&search, &positions, &spacing));
        assert!(network.merged > 1.79, "{} of 1.8 gave way", network.merged);
    }

    #[test]
    fn of_lines_that_meet_the_straightest_go_on_through_each_other() {
        let ray = |degrees: f64| {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            [Vec3::ZERO, DVec3::new(cos, sin, 0.0).as_vec3()]
        };
        // Rays at some angles, and how many pairs of them go on through each other.
        for (rays, pairs) in [
            (vec![0.0, 180.0], 1),
            (vec![0.0, 130.0], 0),
            (vec![0.0, 90.0, 180.0], 1),
            (vec![0.0, 170.0, 195.0], 1),
            (vec![0.0, 90.0, 175.0, 265.0], 2),
            ((0..13).map(|n| 27.0 * f64::from(n)).collect(), 0),
        ] {
            let network = Network::of_pieces(&rays.iter().map(|&degrees| ray(degrees)).collect::<Vec<_>>());
            let center = network.nodes.iter().zip(0..).find(|(node, _)| **node == Vec3::ZERO).map(|(_, n)| n);
            let segments = 0..network.segments.len() as u32;
            let on: Vec<u32> = segments.map(|n| network.straight_on(n, center.unwrap_or(NONE))).collect();
            assert_eq!(on.iter().filter(|&&next| next != NONE).count(), 2 * pairs, "{rays:?}");
            let back = |(n, &next): (usize, &u32)| next == NONE || on[next as usize] == n as u32;
            assert!(on.iter().enumerate().all(back), "{rays:?}: {on:?}");
        }
    }
}
