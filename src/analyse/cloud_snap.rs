//! Given lines that pass beside the creases of a cloud that they mean, moved onto them, as [`super::snap`] moves those
//! given with a mesh.
//!
//! The creases that points around the lines show ([`super::cloud_creases`]) are each meant by the line nearest to them
//! that runs their way. Lines are told apart from corner to corner. Where one lies farther off its crease than its
//! points tell, or trembles about it, its nodes move onto the crease, corners to where the creases meet, and nodes that
//! see no crease as those around them do.

use glam::DVec3;
use rayon::prelude::*;

use super::cloud_creases::{Piece, Points, meeting, traces};
use super::given_lines::SHARP_DEGREES;
use super::line_network::Network;
use super::line_ways::{self, Way, ways};
use super::segment_grid::Nearest;
use super::surface::Rows;
use crate::error::Result;
use crate::model::polyline::nearest_on;

/// Lines may lie off the creases they mean by this many spacings.
const REACH: f64 = 3.0;

/// A crease is seen by points within this many spacings of it.
const SEEN: f64 = 1.0;

/// A line means creases that run its way within this cosine (60°): lines that tremble are meant to be straight.
const ALONG: f64 = 0.5;

/// A node moves to the nearest place of a crease, no farther ahead of it than this many spacings where that ends.
const NEXT: f64 = 0.5;

/// A node sees the pieces of creases that so many segments on either side of it are the nearest to.
const WINDOW: usize = 4;

/// Lines of which less than this share of the nodes see a crease beside them mean none. Within two spacings of a corner
/// none is seen.
const SEEN_SHARE: f64 = 0.25;

/// Points that scatter by more than this many spacings show where creases lie less exactly than lines do: at half a
/// spacing exact lines seem to lie up to 0.7 off, and moved there take a file 2.7 times as large.
const NOISIEST: f64 = 0.1;

/// Lines that lie off their creases by no more than so many spacings on the median stay as they are: the two of a
/// narrow crest, made one, lie 0.3 off where its sides would meet...
const BESIDE: f64 = 0.4;

/// ... but for creases whose points leave nothing to explain: exact lines appear to lie off these by 0.05.
const BESIDE_EXACT: f64 = 0.1;

/// But such as stray by more than so many from the mean of those around do not lie on it: exact lines appear to by 0.05.
const TREMBLES: f64 = 0.15;

/// Those around are so many nodes on either side.
const AROUND: usize = 16;

/// Ways of fewer nodes than this do as their corners: of so short ones a crease shows too little.
const FEWEST: usize = 8;

/// Lines are moved so many times: made one where they keep close to each other then, they see more of their creases.
/// A third time takes a file of trembling lines 3 % less, the others nothing.
const ROUNDS: usize = 2;

/// The network with lines moved onto the creases beside them, and the length of those that moved; nothing moves in a
/// noisy cloud.
///
/// # Errors
/// [`crate::Error::Internal`] should the neighbour search not take the places of creases.
pub fn onto_creases(mut network: Network, points: &Points<'_>) -> Result<(Network, f64)> {
    if points.noise > NOISIEST * points.usual_spacing() {
        return Ok((network, 0.0));
    }
    let creases = creases_beside(&network, points)?;
    let mut moved = 0.0;
    for round in 0..ROUNDS {
        let snap = Snap::new(&network, points, &creases);
        let places = snap.places();
        let moves = |node: u32| places[node as usize] != snap.place(node);
        let segments = 0..network.segments.len() as u32;
        let moving = segments.filter(|&segment| network.segments[segment as usize].into_iter().any(moves));
        // From zero: the sum of nothing is -0.
        let length = moving.fold(0.0, |sum, segment| sum + network.length(segment));
        if length == 0.0 {
            break;
        }
        if round == 0 {
            moved = length;
        }
        network = network.moved(&places).distinct(&points.laid);
    }
    Ok((network, moved))
}

/// Pieces of the creases that points around a network show.
fn creases_beside(network: &Network, points: &Points<'_>) -> Result<Vec<Piece>> {
    let grid = network.grid();
    let near = |&n: &u32| {
        let reach = (REACH + SEEN) * f64::from(points.laid.spacing[n as usize]);
        grid.nearest(points.laid.positions[n as usize].as_dvec3(), reach).is_some()
    };
    let seeds: Vec<u32> = (0..points.laid.positions.len() as u32).into_par_iter().filter(near).collect();
    traces(points, &seeds, SHARP_DEGREES)
}

/// What a crease tells of a node: by how much it lies off it, and the crease's direction.
#[derive(Clone, Copy, Debug)]
struct Vote {
    offset: DVec3,
    along: DVec3,
    /// Whether that is known exactly.
    exact: bool,
}

/// Lines, and the places on creases that they mean.
struct Snap<'a> {
    network: &'a Network,
    points: &'a Points<'a>,
    /// Pieces of them.
    creases: &'a [Piece],
    /// For each segment, the pieces that it is the nearest to.
    of_segment: Rows,
}

impl<'a> Snap<'a> {
    fn new(network: &'a Network, points: &'a Points<'a>, creases: &'a [Piece]) -> Self {
        let grid = network.grid();
        let means = |&Piece { ends: [a, b], .. }: &Piece| {
            let (place, along) = (0.5 * (a + b), (b - a).normalize_or_zero());
            let runs_along = |segment: u32| network.along(segment).dot(along).abs() >= ALONG;
            grid.nearest_of(place, REACH * points.laid.at(place), runs_along).map(|near| near.segment)
        };
        let pairs = creases.iter().zip(0_u32..).filter_map(|(crease, n)| Some((means(crease)?, n)));
        let of_segment = Rows::from_pairs(network.segments.len(), pairs.collect());
        Self { network, points, creases, of_segment }
    }

    /// Where a node is.
    fn place(&self, node: u32) -> DVec3 {
        self.network.nodes[node as usize].as_dvec3()
    }

    /// Where each node moves to.
    fn places(&self) -> Vec<DVec3> {
        let corner = line_ways::corners(self.network);
        let ways = ways(self.network, &corner);
        let votes = self.votes(&ways, &corner);
        let mut known: Vec<Option<DVec3>> = votes.iter().map(|vote| Some(vote.as_ref()?.offset)).collect();
        for (node, offset) in at_corners(&ways, &votes) {
            known[node as usize] = Some(offset);
        }
        let mut offsets = vec![DVec3::ZERO; known.len()];
        ways.iter().for_each(|way| fill(way, &known, &mut offsets));
        let place = |node: u32| {
            let offset = offsets[node as usize];
            let place = self.place(node) + offset;
            // What shows no crease but moves as others do is to stay on the surface.
            let loose = known[node as usize].is_none() && offset != DVec3::ZERO;
            if loose { self.points.foot(place).unwrap_or(place) } else { place }
        };
        (0..offsets.len() as u32).map(place).collect()
    }

    /// What the creases say of each node but corners; that lines lie on them which do so as far as is known.
    fn votes(&self, ways: &[Way], corner: &[bool]) -> Vec<Option<Vote>> {
        let mut votes: Vec<Option<Vote>> = vec![None; corner.len()];
        for way in ways.iter().filter(|way| way.nodes.len() >= FEWEST) {
            for (at, &node) in way.nodes.iter().enumerate().filter(|(_, node)| !corner[**node as usize]) {
                votes[node as usize] = self.vote(way, at);
            }
            if !(is_seen(way, &votes) && self.is_displaced(way, &votes)) {
                let own = way.nodes.iter().filter(|node| !corner[**node as usize]);
                own.for_each(|&node| {
                    votes[node as usize] =
                        votes[node as usize].map(|vote| Vote { offset: DVec3::ZERO, ..vote });
                });
            }
        }
        votes
    }

    /// What the place on a crease says that lies beside a node of a way.
    fn vote(&self, way: &Way, at: usize) -> Option<Vote> {
        let here = self.place(way.nodes[at]);
        let near = way.around(at, WINDOW).flat_map(|segment| self.of_segment.row(segment));
        let foot = |&piece: &u32| {
            let [a, b] = self.creases[piece as usize].ends;
            let point = nearest_on(a, b, here);
            Nearest { segment: piece, point, distance: point.distance(here) }
        };
        let nearer =
            |a: &Nearest, b: &Nearest| a.distance.total_cmp(&b.distance).then(a.segment.cmp(&b.segment));
        self.beside(here, near.map(foot).min_by(nearer)?)
    }

    /// What the nearest place of a crease says of another; nothing where the crease ends before it comes by.
    fn beside(&self, here: DVec3, near: Nearest) -> Option<Vote> {
        let (offset, along) = (near.point - here, self.along(near.segment));
        let exact = self.creases[near.segment as usize].exact;
        (offset.dot(along).abs() <= NEXT * self.points.laid.at(here)).then_some(Vote { offset, along, exact })
    }

    /// Unit vector along a piece of a crease.
    fn along(&self, piece: u32) -> DVec3 {
        let [a, b] = self.creases[piece as usize].ends;
        (b - a).normalize_or(DVec3::X)
    }

    /// Whether a way lies farther off its crease than that is known, or now on one side of it and now on the other.
    fn is_displaced(&self, way: &Way, votes: &[Option<Vote>]) -> bool {
        let off = |&node: &u32| {
            let vote = votes[node as usize]?;
            Some((vote.offset / self.points.laid.at(self.place(node)), vote.exact))
        };
        let (off, exact): (Vec<DVec3>, Vec<bool>) = way.nodes.iter().filter_map(off).unzip();
        let strays = |at: usize| {
            let around = &off[at.saturating_sub(AROUND)..(at + AROUND + 1).min(off.len())];
            off[at].distance(around.iter().sum::<DVec3>() / around.len() as f64)
        };
        let known = exact.iter().filter(|exact| **exact).count() > off.len() / 2;
        let beside = if known { BESIDE_EXACT } else { BESIDE };
        median(off.iter().map(|off| off.length())) > beside || median((0..off.len()).map(strays)) > TREMBLES
    }
}

/// The middle one of some values; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Whether enough of the nodes of a way have a crease beside them.
fn is_seen(way: &Way, votes: &[Option<Vote>]) -> bool {
    let seen = way.nodes.iter().filter(|&&node| votes[node as usize].is_some()).count();
    seen as f64 >= SEEN_SHARE * way.nodes.len() as f64
}

/// By how much each corner moves: to where the creases meet that the ways show which end there.
fn at_corners(ways: &[Way], votes: &[Option<Vote>]) -> Vec<(u32, DVec3)> {
    let vote = |&node: &u32| votes[node as usize];
    let mut arms: Vec<(u32, Vote)> = Vec::new();
    for way in ways.iter().filter(|way| !way.closed) {
        let [first, last] = way.ends();
        arms.extend(way.nodes.iter().find_map(vote).map(|vote| (first, vote)));
        arms.extend(way.nodes.iter().rev().find_map(vote).map(|vote| (last, vote)));
    }
    // Stable: the arms of a corner stay in the order of the ways.
    arms.sort_by_key(|&(node, _)| node);
    let meets = |arms: &[(u32, Vote)]| {
        let lines: Vec<[DVec3; 2]> = arms.iter().map(|(_, vote)| [vote.offset, vote.along]).collect();
        let moves = lines.iter().any(|[offset, _]| *offset != DVec3::ZERO);
        (arms[0].0, if moves { meeting(&lines) } else { DVec3::ZERO })
    };
    arms.chunk_by(|a, b| a.0 == b.0).map(meets).collect()
}

/// Moves the nodes of a way: those between two that are `known` by what these do, each for its nearness.
fn fill(way: &Way, known: &[Option<DVec3>], offsets: &mut [DVec3]) {
    let of = |at: usize| known[way.nodes[at] as usize];
    let count = way.nodes.len();
    let told: Vec<usize> = (0..count).filter(|&at| of(at).is_some()).collect();
    let (Some(&first), Some(&last)) = (told.first(), told.last()) else { return };
    for at in 0..count {
        let after = told.partition_point(|&told| told < at);
        let (before, after) = match (after.checked_sub(1), told.get(after)) {
            (_, Some(&after)) if after == at => (at, at),
            (Some(before), Some(&after)) => (told[before], after),
            // Beyond the outermost: round the loop, or as that does.
            (before, _) if way.closed => (told[before.unwrap_or(told.len() - 1)], first),
            (None, _) => (first, first),
            (Some(_), None) => (last, last),
        };
        let (Some(a), Some(b)) = (of(before), of(after)) else { continue };
        let steps = |from: usize, to: usize| ((to + count - from) % count) as f64;
        let share = if before == after { 0.0 } else { steps(before, at) / steps(before, after) };
        offsets[way.nodes[at] as usize] = a.lerp(b, share);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::{ROOF_STEP, fall, lay, random, roof, spaced};

    /// How far off the ridge of a roof of 60° what became of lines lies at the most, in steps, ends of the roof aside,
    /// how much of their length moved, and how long what became of them is.
    fn snapped(lines: &[Vec<DVec3>], noise: f64) -> [f64; 3] {
        let positions = roof(60.0, noise);
        let (search, nearest, spacing) = lay(&positions);
        let laid = spaced(&search, &positions, &spacing);
        let (network, moved) =
            onto_creases(Network::new(lines, &laid), &Points { laid, nearest: &nearest, noise }).unwrap();
        let inner = network.nodes.iter().filter(|node| node.x.abs() < 0.9);
        let off = inner.map(|node| node.as_dvec3().with_x(0.0).length() / ROOF_STEP).fold(0.0, f64::max);
        let all = (0..network.segments.len() as u32).map(|segment| network.length(segment));
        [off, moved, all.sum()]
    }

    /// A line along the ridge in so many sides, off it as told in steps.
    fn beside(sides: u32, off: impl Fn(u32) -> DVec3) -> Vec<DVec3> {
        (0..=sides)
            .map(|n| DVec3::X * (2.0 * f64::from(n) / f64::from(sides) - 1.0) + ROOF_STEP * off(n))
            .collect()
    }

    #[test]
    fn lines_beside_a_crease_move_onto_it_and_such_as_lie_on_it_stay() {
        let exact = snapped(&[beside(1, |_| DVec3::ZERO)], 0.0);
        assert!(exact[0].max(exact[1]) == 0.0 && exact[2] > 1.9, "{exact:?}: it moved");
        let shift = |n: f64| move |_| n * DVec3::new(0.3, 0.8, -0.5);
        let tremble = |n: u32| DVec3::new(0.0, random(u64::from(2 * n)), random(u64::from(2 * n + 1)));
        let cases = [
            ("a step off", beside(1, shift(1.0))),
            ("three steps off", beside(1, shift(2.9))),
            ("trembling", beside(25, tremble)),
        ];
        for (name, line) in cases {
            let [off, moved, length] = snapped(&[line], 0.0);
            assert!(off < 0.67, "{name}: {off} steps off");
            assert!(moved > 1.8 && (1.8..2.2).contains(&length), "{name}: {moved}, {length}");
        }
        let [off, moved, _] = snapped(&[beside(1, shift(0.3))], 0.0);
        assert!(off < 0.1 && moved > 1.8, "a third of a step off: {off}, {moved}");
        let down = DVec3::new(0.0, 8.0, fall(60.0, 8.0));
        let far = snapped(&[beside(1, |_| down)], 0.0);
        assert!(far[1] == 0.0 && far[2] > 1.9, "{far:?}: a line down the face moved");
        let noisy = snapped(&[beside(1, shift(1.0))], 0.3 * ROOF_STEP);
        assert!(noisy[1] == 0.0, "a line moved in the noise");
    }

    #[test]
    fn a_line_down_a_face_stays_on_it_and_moves_with_the_crease_that_it_meets() {
        let off = 2.0 * ROOF_STEP * DVec3::Y;
        let down = |y: f64| DVec3::new(0.1, y, fall(60.0, y));
        let lines = [
            vec![DVec3::NEG_X + off, down(0.0) + off, DVec3::X + off],
            (0..=10).map(|n| down(0.1 * f64::from(n)) + off).collect(),
        ];
        let positions = roof(60.0, 0.0);
        let (search, nearest, spacing) = lay(&positions);
        let laid = spaced(&search, &positions, &spacing);
        let network = Network::new(&lines, &laid);
        let (network, _) = onto_creases(network, &Points { laid, nearest: &nearest, noise: 0.0 }).unwrap();
        for node in network.nodes.iter().map(|node| node.as_dvec3()).filter(|node| node.x.abs() < 0.9) {
            let above = (node.z - fall(60.0, node.y)).abs() / ROOF_STEP;
            assert!(above < 0.4, "{node} floats by {above} steps");
        }
        let meet = (0..network.nodes.len() as u32).filter(|&node| network.at_node.row(node).len() == 3);
        let meet: Vec<DVec3> = meet.map(|node| network.nodes[node as usize].as_dvec3()).collect();
        assert!(meet.len() == 1 && meet[0].with_x(0.0).length() < 0.35 * ROOF_STEP, "{meet:?}");
    }
}
