//! Given lines that pass beside the edges they mean.
//!
//! Lines drawn by hand, or exported from another version of the model, lie a little off the
//! creases they were meant for, twice over, or in pieces. Every such piece means the nearest crease
//! that runs its way.

use glam::DVec3;
use rayon::prelude::*;

use super::chains::{Chain, chains};
use super::edges::Edges;
use super::refine::length;
use super::segment_grid::SegmentGrid;
use super::weld::Welded;

/// Pieces are this share of the reach long: none passes a crease unnoticed.
const STEP: f64 = 0.5;

/// Lines so long that they would become more pieces than this become longer ones.
const MOST: f64 = 1e6;

/// A line means creases that run its way within this cosine (60°): lines that tremble are meant to
/// be straight.
const ALONG: f64 = 0.5;

/// A line runs beside an edge whose middle is no more than this many times as far from it as the
/// line is from its crease: not where it has ended.
const BESIDE: f64 = 1.5;

/// Gaps of this many reaches, between edges that lines mean, are meant too: the line is broken.
const WIDEST_GAP: f64 = 4.0;

/// A part of a given segment that runs along no edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// The segment.
    pub(super) segment: u32,
    ends: [DVec3; 2],
}

impl Piece {
    fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// Its middle.
    pub(super) fn middle(&self) -> DVec3 {
        0.5 * (self.ends[0] + self.ends[1])
    }
}

/// Some of the segments in pieces, in the order of `some`.
pub(super) fn pieces(
    segments: &[[DVec3; 2]],
    some: impl Iterator<Item = usize> + Clone,
    reach: f64,
) -> Vec<Piece> {
    let all: f64 = some.clone().map(|n| segments[n][0].distance(segments[n][1])).sum();
    let step = (STEP * reach).max(all / MOST);
    some.flat_map(|segment| {
        let [a, b] = segments[segment];
        let count = (a.distance(b) / step).ceil().max(1.0);
        let at = move |n: usize| a.lerp(b, n as f64 / count);
        (0..count as usize).map(move |n| Piece { segment: segment as u32, ends: [at(n), at(n + 1)] })
    })
    .collect()
}

/// What stray pieces of lines mean.
#[derive(Clone, Debug, Default)]
pub(super) struct Snapped {
    /// For each edge of the mesh, whether a piece means it.
    pub(super) edges: Vec<bool>,
    /// Length of the pieces that mean an edge.
    pub(super) length: f64,
    /// Segments, ascending, none of whose pieces means any.
    pub(super) lost: Vec<u32>,
}

/// Finds the edges that pieces of lines mean, within `reach` (model units), of those that may be
/// meant: on the chain of such edges nearest to a piece, all that it runs beside, and what lies
/// between them. Pieces come in the order of their segments; what other lines run along is
/// `followed`.
pub(super) fn snap(
    welded: &Welded,
    edges: &Edges,
    [may_be, followed]: [&[bool]; 2],
    stray: &[Piece],
    reach: f64,
) -> Snapped {
    let mut snapped = Snapped { edges: vec![false; may_be.len()], ..Snapped::default() };
    if stray.is_empty() {
        return snapped;
    }
    let chains = chains(welded.positions.len(), edges, may_be);
    let votes = votes(welded, edges, &chains, stray, reach);
    for of_segment in votes.chunk_by(|a, b| stray[a.piece].segment == stray[b.piece].segment) {
        let meant = || of_segment.iter().filter(|vote| vote.chain.is_some());
        snapped.length += meant().map(|vote| stray[vote.piece].length()).sum::<f64>();
        if meant().next().is_none() {
            snapped.lost.push(stray[of_segment[0].piece].segment);
        }
    }
    let mut of_chain: Vec<&Vote> = votes.iter().filter(|vote| vote.chain.is_some()).collect();
    of_chain.sort_by_key(|vote| (vote.chain, vote.piece));
    for votes in of_chain.chunk_by(|a, b| a.chain == b.chain) {
        let Some(chain) = votes[0].chain else { continue };
        let lines = SegmentGrid::new(votes.iter().map(|vote| stray[vote.piece].ends).collect());
        for &edge in &chains[chain].edges {
            let [a, b] = welded.places(edges.edges[edge as usize].ends);
            let near = lines.nearest(0.5 * (a + b), BESIDE * reach);
            snapped.edges[edge as usize] = near.is_some_and(|near| {
                let vote = votes[near.segment as usize];
                near.distance <= BESIDE * vote.distance + stray[vote.piece].length()
            });
        }
        close_gaps(&chains[chain], followed, &mut snapped.edges, |edge| {
            length(welded, &edges.edges[edge as usize]) / (WIDEST_GAP * reach)
        });
    }
    snapped
}

/// Takes in the edges of a chain that lie between others, if they are short together: `share` is an
/// edge's length as a share of the widest gap.
fn close_gaps(chain: &Chain, followed: &[bool], meant: &mut [bool], share: impl Fn(u32) -> f64) {
    let is_meant: Vec<bool> =
        chain.edges.iter().map(|&edge| meant[edge as usize] || followed[edge as usize]).collect();
    let mut before = None;
    for at in (0..is_meant.len()).filter(|&at| is_meant[at]) {
        let gap = before.map_or(&[][..], |before| &chain.edges[before + 1..at]);
        if gap.iter().map(|&edge| share(edge)).sum::<f64>() <= 1.0 {
            gap.iter().for_each(|&edge| meant[edge as usize] = true);
        }
        before = Some(at);
    }
}

/// Which chain a piece means.
struct Vote {
    piece: usize,
    chain: Option<usize>,
    /// How far off, model units.
    distance: f64,
}

/// The chain nearest to each piece, of those that run its way.
fn votes(welded: &Welded, edges: &Edges, chains: &[Chain], stray: &[Piece], reach: f64) -> Vec<Vote> {
    let of = |(chain, edge): (usize, u32)| (chain, welded.places(edges.edges[edge as usize].ends));
    let every =
        chains.iter().enumerate().flat_map(|(n, chain)| chain.edges.iter().map(move |&edge| (n, edge)));
    let (chain_of, sides): (Vec<usize>, Vec<[DVec3; 2]>) = every.map(of).unzip();
    let directions: Vec<DVec3> = sides.iter().map(|[a, b]| (*b - *a).normalize_or_zero()).collect();
    let grid = SegmentGrid::new(sides);
    let vote = |(piece, stray): (usize, &Piece)| {
        let along = (stray.ends[1] - stray.ends[0]).normalize_or_zero();
        let runs_along = |side: u32| directions[side as usize].dot(along).abs() >= ALONG;
        let near = grid.nearest_of(stray.middle(), reach, runs_along);
        let chain = near.as_ref().map(|near| chain_of[near.segment as usize]);
        Vote { piece, chain, distance: near.map_or(0.0, |near| near.distance) }
    };
    stray.par_iter().enumerate().map(vote).collect()
}
