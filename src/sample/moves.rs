//! Local moves on a cover: splats are laid out anew, and two that one can stand for are merged.
//!
//! A greedy cover leaves gaps that small splats fill, and by then much of what the large ones
//! around them cover is covered twice. What two neighbours alone cover is often small enough for
//! one splat laid out for it. A splat for which no neighbour is found moves to the middle of what
//! it alone covers and grows from there, which leaves less for others to cover alone.

use rayon::prelude::*;

use super::candidates::Regions;
use super::cover::{Cover, cost};
use super::enclose::Need;
use super::grow::Grower;
use super::owners::{Owners, some_of};
use super::region::Region;
use super::settle::Candidate;
use crate::fit::pose::Axes;

/// Splats looked at side by side before their moves are made. Batches are of the same size
/// whatever the threads, so that the result is the same too.
const BATCH: usize = 64;

/// A pass that saves less than this share of the splats is the last.
const WORTH: f64 = 0.005;

/// No two splats are merged whose own pieces reach this many times farther than the larger of
/// their radii: none so large kept the bound there.
const FARTHEST: f64 = 1.2;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Thoroughness {
    /// Passes over all splats.
    passes: usize,
    /// Neighbours that a splat is tried with in one pass, the nearest first.
    partners: usize,
}

impl Thoroughness {
    fn of(effort: u8) -> Self {
        let half = usize::from(effort).div_ceil(2);
        Self { passes: half, partners: half }
    }
}

/// Moves and merges splats while that saves some; how many there are fewer.
pub(super) fn improve(grower: &Grower, regions: &Regions, cover: &mut Cover, effort: u8) -> usize {
    let Thoroughness { passes, partners } = Thoroughness::of(effort);
    let before = cover.chosen.len();
    for _ in 0..passes {
        let started = cover.chosen.len();
        pass(grower, regions, cover, partners);
        let saved = started - cover.chosen.len();
        if (saved as f64) < WORTH * started as f64 {
            break;
        }
    }
    before - cover.chosen.len()
}

/// One splat that takes the place of others.
struct Move {
    /// One splat or two, which it is to replace.
    old: Vec<usize>,
    new: Candidate,
}

fn pass(grower: &Grower, regions: &Regions, cover: &mut Cover, partners: usize) {
    let owners = Owners::of(cover);
    let mut alive = vec![false; cover.candidates.len()];
    cover.chosen.iter().for_each(|&index| alive[index] = true);
    // Those with the least of their own first: they are the easiest to do without.
    let mut order: Vec<(f64, usize)> =
        cover.chosen.iter().map(|&index| (cover.own_area(index), index)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for batch in order.chunks(BATCH) {
        let search = Search { grower, cover, alive: &alive, owners: &owners };
        let found: Vec<Option<Move>> = batch
            .par_iter()
            .map(|&(_, index)| regions.with(|region| search.best(index, partners, region)))
            .collect();
        for Move { old, new } in found.into_iter().flatten() {
            // An earlier move of the batch may have left more for these to cover alone.
            let holds = old.iter().all(|&index| alive[index]) && cover.serves(&old, &new);
            if holds && pays(cover, &old, &new) {
                old.iter().for_each(|&index| alive[index] = false);
                cover.replace(&old, new);
            } else {
                // It comes too late here, or is too dear, but may do in a choice made anew.
                cover.candidates.push(new);
            }
        }
    }
    cover.chosen.retain(|&index| alive.get(index).is_none_or(|&alive| alive));
    cover.drop_redundant();
}

/// What a search for a move looks at.
struct Search<'a> {
    grower: &'a Grower<'a>,
    cover: &'a Cover,
    /// For each candidate, whether it is chosen still.
    alive: &'a [bool],
    owners: &'a Owners,
}

impl Search<'_> {
    /// The first merger found of a splat with one of its neighbours that pays, or where it moves
    /// alone, whether or not that does.
    fn best(&self, index: usize, partners: usize, region: &mut Region) -> Option<Move> {
        if !self.alive[index] {
            return None;
        }
        let near = self.owners.neighbours(self.cover, index).into_iter();
        let nearest = near.filter(|&other| self.alive[other]).take(partners);
        let mut mergers = nearest.filter_map(|other| Some((other, self.pair(index, other)?)));
        let merger = mergers.find_map(|(other, need)| {
            let found = self.move_to(&need, vec![index, other], region)?;
            pays(self.cover, &found.old, &found.new).then_some(found)
        });
        merger.or_else(|| {
            let axes = self.cover.candidates[index].splat.axes;
            let need = Need::new(self.grower.surface, self.alone(index), axes)?;
            self.move_to(&need, vec![index], region)
        })
    }

    /// Those of [some](some_of) of the pieces of a splat that it alone covers, ascending.
    fn alone(&self, index: usize) -> Vec<u32> {
        let pieces = some_of(&self.cover.candidates[index].pieces);
        pieces.filter(|&piece| self.cover.times[piece as usize] == 1).collect()
    }

    /// Those of some of the pieces of one that only it and another cover, ascending.
    fn shared(&self, [one, other]: [usize; 2]) -> Vec<u32> {
        let [one, other] = [one, other].map(|of| &self.cover.candidates[of].pieces);
        let twice = some_of(one).filter(|&piece| self.cover.times[piece as usize] == 2);
        twice.filter(|piece| other.binary_search(piece).is_ok()).collect()
    }

    /// What only two splats cover; `None` if it reaches too far for one.
    fn pair(&self, index: usize, other: usize) -> Option<Need> {
        let [one, two] = [index, other].map(|of| &self.cover.candidates[of].splat);
        let larger = if one.radii.element_product() >= two.radii.element_product() { one } else { two };
        let mut pieces = [self.alone(index), self.alone(other), self.shared([index, other])].concat();
        // Three runs that ascend, which a stable sort merges.
        pieces.sort();
        let need = Need::new(self.grower.surface, pieces, larger.axes)?;
        let most = FARTHEST * one.radii.max(two.radii).max_element();
        (need.reach <= most).then_some(need)
    }

    /// A splat for a need in the place of those it comes from, whatever it costs.
    fn move_to(&self, need: &Need, old: Vec<usize>, region: &mut Region) -> Option<Move> {
        let new = need.covered(&[Axes::Principal], self.grower, region)?;
        Some(Move { old, new })
    }
}

/// Whether a splat costs no more than those it is to replace: one may cost as much as one.
fn pays(cover: &Cover, old: &[usize], new: &Candidate) -> bool {
    let spent: f64 = old.iter().map(|&index| cost(&cover.candidates[index].splat)).sum();
    cost(&new.splat) <= spent
}
