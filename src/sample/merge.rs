//! Local moves on a cover: two splats that one can stand for are merged.
//!
//! A greedy cover leaves gaps that small splats fill, and by then much of what the large ones
//! around them cover is covered twice. What two neighbours alone cover is often small enough for
//! one splat, laid out for it.

use rayon::prelude::*;

use super::candidates::Regions;
use super::cover::{Cover, cost};
use super::enclose::Need;
use super::grow::Grower;
use super::settle::Candidate;
use crate::analyse::surface::Rows;

/// Splats looked at side by side before their merges are made. Batches are of the same size
/// whatever the threads, so that the result is the same too.
const BATCH: usize = 64;

/// A pass that merges fewer than this share of the splats is the last.
const WORTH: f64 = 0.005;

/// No two splats are merged whose own pieces reach this many times farther than the larger of
/// their radii: none so large kept the bound there.
const FARTHEST: f64 = 1.2;

/// How much merging is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Thoroughness {
    /// Passes over all splats.
    passes: usize,
    /// Neighbours that a splat is tried with in one pass, those first whose own pieces lie
    /// closest together.
    partners: usize,
}

impl Thoroughness {
    fn of(effort: u8) -> Self {
        let effort = usize::from(effort);
        Self { passes: effort / 2, partners: effort.div_ceil(2) }
    }
}

/// Merges splats while that saves bytes; how many there are fewer.
pub(super) fn merge(grower: &Grower, regions: &Regions, cover: &mut Cover, effort: u8) -> usize {
    let Thoroughness { passes, partners } = Thoroughness::of(effort);
    let before = cover.chosen.len();
    for _ in 0..passes {
        let started = cover.chosen.len();
        pass(grower, regions, cover, partners);
        if ((started - cover.chosen.len()) as f64) < WORTH * started as f64 {
            break;
        }
    }
    before - cover.chosen.len()
}

/// A splat for two.
struct Merger {
    pair: [usize; 2],
    candidate: Candidate,
}

fn pass(grower: &Grower, regions: &Regions, cover: &mut Cover, partners: usize) {
    let owners = owners(cover);
    let mut alive = vec![false; cover.candidates.len()];
    cover.chosen.iter().for_each(|&index| alive[index] = true);
    // Those with the least of their own first: they are the easiest to do without.
    let mut order: Vec<(f64, usize)> =
        cover.chosen.iter().map(|&index| (cover.own_area(index), index)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for batch in order.chunks(BATCH) {
        let state = (&*cover, &alive);
        let found: Vec<Option<Merger>> = batch
            .par_iter()
            .map(|&(_, index)| regions.with(|region| {
                let mergers = Mergers { grower, cover: state.0, alive: state.1, owners: &owners };
                mergers.best(index, partners, region)
            }))
            .collect();
        for merger in found.into_iter().flatten() {
            if merger.pair.iter().all(|&index| alive[index]) && cover.serves(merger.pair, &merger.candidate) {
                merger.pair.iter().for_each(|&index| alive[index] = false);
                cover.replace(merger.pair, merger.candidate);
            }
        }
    }
    cover.chosen.retain(|&index| alive.get(index).is_none_or(|&alive| alive));
    cover.drop_redundant();
}

/// For each piece, the chosen splats that cover it.
fn owners(cover: &Cover) -> Rows {
    let pairs = cover.chosen.iter().flat_map(|&index| {
        cover.candidates[index].pieces.iter().map(move |&piece| (piece, index as u32))
    });
    Rows::from_pairs(cover.times.len(), pairs.collect())
}

/// What a search for a merger looks at.
struct Mergers<'a> {
    grower: &'a Grower<'a>,
    cover: &'a Cover,
    alive: &'a [bool],
    owners: &'a Rows,
}

impl Mergers<'_> {
    /// The first merger found of a splat with one of its neighbours.
    fn best(&self, index: usize, partners: usize, region: &mut super::region::Region) -> Option<Merger> {
        if !self.alive[index] {
            return None;
        }
        let candidate = &self.cover.candidates[index];
        let mut around: Vec<u32> =
            candidate.pieces.iter().flat_map(|&piece| self.owners.row(piece)).copied().collect();
        around.sort_unstable();
        around.dedup();
        let around = around.into_iter().map(|other| other as usize);
        let mut needs: Vec<(f64, usize, Need)> = around
            .filter(|&other| other != index && self.alive[other])
            .filter_map(|other| self.need(index, other))
            .collect();
        needs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        needs.iter().take(partners).find_map(|(_, other, need)| {
            let pair = [index, *other];
            let merged = need.covered(self.grower, region)?;
            let [one, other] = pair.map(|of| cost(&self.cover.candidates[of].splat));
            (cost(&merged.splat) < one + other).then_some(Merger { pair, candidate: merged })
        })
    }

    /// What only two splats cover, and how far it reaches; `None` if too far.
    fn need(&self, index: usize, other: usize) -> Option<(f64, usize, Need)> {
        let pieces = self.cover.own([index, other]);
        let splats = [index, other].map(|of| &self.cover.candidates[of].splat);
        let larger = if splats[0].radii.element_product() >= splats[1].radii.element_product() { 0 } else { 1 };
        let need = Need::new(self.grower.surface, pieces, splats[larger].axes)?;
        let most = FARTHEST * splats.iter().map(|splat| splat.radii.max_element()).fold(0.0, f64::max);
        (need.reach <= most).then_some((need.reach, other, need))
    }
}
