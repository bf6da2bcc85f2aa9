//! A small set of candidates that covers every piece.
//!
//! Greedy by newly covered area a byte, with lazy updates (Wu and Kobbelt 2004, 4), then
//! whatever is left is seeded on its own, then redundant splats go, then splats are moved and
//! merged, and at last the choice is made anew from all the candidates of which these tell, and from
//! others that take from their neighbours what these cover.

use std::collections::{BTreeSet, BinaryHeap};

use super::candidates::Regions;
use super::exchange::exchange;
use super::gain::Gain;
use super::grow::Grower;
use super::moves::improve;
use super::polygon;
use super::region::Region;
use super::set_cover::Alike;
use super::settle::Candidate;
use super::tighten::tighten;
use crate::model::sight::Sight;
use crate::model::splat::{Kind, Splat};
use rayon::prelude::*;

/// About what a splat costs in the file, in bytes: enough to weigh kinds against each other.
///
/// Over the files of nine models a flat splat comes to 6 to 8 bytes, a quadric to 7 to 10, a straight
/// clip to 2 and a curved one to 3 to 6, the more the larger the splat is and the fewer are told by those
/// that they follow. Weights nearer to these (clips of 2.2 and 3.5, or of 2.5 and 4.5) made files no smaller
/// than those here.
#[must_use]
pub fn cost(splat: &Splat) -> f64 {
    let base = match splat.kind() {
        Kind::Flat => 9.0,
        // A cylinder costs a little less; weighed so, the cover of a free form takes more of them,
        // which reach less far.
        Kind::Cylinder | Kind::Quadric => 11.0,
    };
    base + splat.clips.iter().map(|clip| if clip.is_straight() { 3.0 } else { 7.0 }).sum::<f64>()
}

/// What the choice came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choice {
    /// Candidates grown.
    pub candidates: usize,
    /// Pieces that only a splat of their own could cover.
    pub last_resorts: usize,
    /// Pieces that not even that could cover, because it cannot be stored.
    pub uncovered: usize,
    /// Splats dropped because others cover all that they cover.
    pub redundant: usize,
    /// Splats saved by moving and merging them, before the choice is made anew.
    pub merged: usize,
    /// Splats added where lines were followed by none.
    pub following: usize,
    /// Splats added to close holes that show where the rest is looked at from the side.
    pub sealing: usize,
    /// Splats taken out, and others put in their places, because they show beside the outline.
    pub withdrawn: usize,
    /// Splats whose points did not determine a whole quadric.
    pub low_rank: usize,
}

/// Candidates, and those of them that are chosen to cover every piece.
#[derive(Default)]
pub struct Cover {
    pub(super) candidates: Vec<Candidate>,
    /// Indices of candidates.
    pub(super) chosen: Vec<usize>,
    /// For each piece, how many of the chosen cover it.
    pub(super) times: Vec<u32>,
    /// The area of each piece.
    pub(super) areas: Vec<f64>,
    /// Rays that no splat may stop.
    pub(super) beside: Vec<Sight>,
    /// Chosen ones that stop such rays, and that no others could take the place of.
    pub(super) lasting: BTreeSet<usize>,
}

/// Chooses from the candidates, adding to them what no candidate covers.
#[must_use]
pub fn cover(grower: &Grower, regions: &Regions, candidates: Vec<Candidate>, effort: u8) -> (Cover, Choice) {
    let pieces = 0..grower.surface.pieces.len() as u32;
    let areas: Vec<f64> = pieces.into_par_iter().map(|piece| grower.surface.area(piece)).collect();
    let mut choice = Choice::default();
    let mut times = vec![0_u32; areas.len()];
    let chosen = greedy(&candidates, &areas, &mut times);
    let mut cover = Cover { candidates, chosen, times, areas, ..Cover::default() };
    cover_rest(grower, regions, &mut cover, &mut choice);
    choice.candidates = cover.candidates.len();
    choice.redundant = cover.drop_redundant();
    choice.merged = improve(grower, regions, &mut cover, effort);
    let mut alike = Alike::new(cover.areas.len());
    cover.rechoose(&mut alike);
    exchange(grower, regions, &mut cover, &mut alike, effort);
    tighten(grower, regions, &mut cover);
    choice.low_rank = cover.chosen.iter().filter(|&&index| cover.candidates[index].rank < 6).count();
    (cover, choice)
}

impl Cover {
    /// The chosen candidates, in the order in which they were chosen.
    #[must_use]
    pub fn chosen(&self) -> Vec<Candidate> {
        self.chosen.iter().map(|&index| self.candidates[index].clone()).collect()
    }

    /// The splats of these.
    #[must_use]
    pub fn splats(&self) -> Vec<Splat> {
        self.chosen.iter().map(|&index| self.candidates[index].splat.clone()).collect()
    }

    /// Rounds the clip curves of all candidates to what is stored: what is looked for from here on is whether rays pass
    /// them.
    pub fn store(&mut self, grower: &Grower) {
        let candidates = std::mem::take(&mut self.candidates).into_par_iter();
        self.candidates = candidates.map(|candidate| candidate.stored(grower)).collect();
    }

    /// What the chosen cost.
    pub(super) fn cost(&self) -> f64 {
        self.chosen.iter().map(|&index| cost(&self.candidates[index].splat)).sum()
    }

    /// The pieces that no other splat covers than these, ascending.
    pub(super) fn own(&self, these: &[usize]) -> Vec<u32> {
        let times = |piece: u32| self.times[piece as usize] as usize;
        let all = these.iter().flat_map(|&index| &self.candidates[index].pieces).copied();
        let mut met: Vec<u32> = all.filter(|&piece| times(piece) <= these.len()).collect();
        // A few runs that ascend, which a stable sort merges.
        met.sort();
        met.chunk_by(|a, b| a == b).filter(|same| times(same[0]) == same.len()).map(|same| same[0]).collect()
    }

    /// The area of the pieces that only this splat covers.
    pub(super) fn own_area(&self, index: usize) -> f64 {
        let own = self.candidates[index].pieces.iter().filter(|&&piece| self.times[piece as usize] == 1);
        own.map(|&piece| self.areas[piece as usize]).sum()
    }

    /// Whether a candidate covers all that no other splat covers than these.
    pub(super) fn serves(&self, these: &[usize], candidate: &Candidate) -> bool {
        candidate.covers(self.own(these))
    }

    /// Takes a candidate for some of the chosen, which the caller takes off the list.
    pub(super) fn replace(&mut self, these: &[usize], candidate: Candidate) {
        for &piece in these.iter().flat_map(|&index| &self.candidates[index].pieces) {
            self.times[piece as usize] -= 1;
        }
        self.choose(candidate);
    }

    /// Adds a candidate, and takes it.
    pub(super) fn choose(&mut self, candidate: Candidate) {
        self.candidates.push(candidate);
        self.add(self.candidates.len() - 1);
    }

    /// Takes one more of the candidates.
    pub(super) fn add(&mut self, index: usize) {
        for &piece in &self.candidates[index].pieces {
            self.times[piece as usize] += 1;
        }
        self.chosen.push(index);
    }

    /// Drops splats all of whose pieces others cover, those with the least area first; how many.
    pub(super) fn drop_redundant(&mut self) -> usize {
        let area =
            |index: usize| self.candidates[index].pieces.iter().map(|&p| self.areas[p as usize]).sum::<f64>();
        let mut order: Vec<(f64, usize)> = self.chosen.iter().map(|&index| (area(index), index)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut dropped = Vec::new();
        for (_, index) in order {
            let pieces = &self.candidates[index].pieces;
            if pieces.iter().all(|&piece| self.times[piece as usize] > 1) {
                for &piece in pieces {
                    self.times[piece as usize] -= 1;
                }
                dropped.push(index);
            }
        }
        dropped.sort_unstable();
        self.chosen.retain(|index| dropped.binary_search(index).is_err());
        dropped.len()
    }
}

fn greedy(candidates: &[Candidate], areas: &[f64], times: &mut [u32]) -> Vec<usize> {
    let gain = |index: usize, times: &[u32]| {
        let candidate = &candidates[index];
        let new = candidate.pieces.iter().filter(|&&p| times[p as usize] == 0);
        // A piece without area still has to be covered.
        new.map(|&p| areas[p as usize].max(f64::MIN_POSITIVE)).sum::<f64>() / cost(&candidate.splat)
    };
    let first = (0..candidates.len()).into_par_iter();
    let first: Vec<Gain> = first.map(|index| Gain { gain: gain(index, times), index }).collect();
    let mut heap = BinaryHeap::from(first);
    let mut chosen = Vec::new();
    while let Some(top) = heap.pop() {
        let now = Gain { gain: gain(top.index, times), index: top.index };
        if now.gain <= 0.0 {
            continue;
        }
        // Gains only fall, so one that still leads the others' old gains is the greatest.
        if heap.peek().is_some_and(|next| *next > now) {
            heap.push(now);
            continue;
        }
        for &piece in &candidates[top.index].pieces {
            times[piece as usize] += 1;
        }
        chosen.push(top.index);
    }
    chosen
}

/// Seeds left to grow before the pieces they cover are marked.
const BATCH: usize = 64;

/// Covers what no candidate does.
fn cover_rest(grower: &Grower, regions: &Regions, cover: &mut Cover, choice: &mut Choice) {
    let mut at = 0;
    while at < cover.times.len() {
        let mut batch = Vec::with_capacity(BATCH);
        while at < cover.times.len() && batch.len() < BATCH {
            if cover.times[at] == 0 {
                batch.push(at as u32);
            }
            at += 1;
        }
        let meshed = grower.surface.spots.is_empty();
        let grow = |piece: u32, region: &mut Region| {
            let grown = grower.grow(piece, region).or_else(|| grower.grow_finer(piece, region));
            let grown = grown.or_else(|| grower.grow_broad(piece, region));
            let laxer = if meshed { Grower::grow_overhanging } else { Grower::grow_beside_lines };
            grown.or_else(|| laxer(grower, piece, region))
        };
        let grown: Vec<Option<Candidate>> =
            batch.par_iter().map(|&piece| regions.with(|region| grow(piece, region))).collect();
        for (&piece, grown) in batch.iter().zip(grown) {
            if cover.times[piece as usize] > 0 {
                continue;
            }
            let last_resort = grown.is_none();
            match grown.or_else(|| regions.with(|region| polygon::over(grower, piece, region))) {
                Some(candidate) => {
                    choice.last_resorts += usize::from(last_resort);
                    cover.choose(candidate);
                }
                None => choice.uncovered += 1,
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use glam::{DMat3, DVec2, DVec3};

    pub(in crate::sample) fn candidate(pieces: &[u32]) -> Candidate {
        let splat = Splat {
            center: DVec3::ZERO,
            axes: DMat3::IDENTITY,
            radii: DVec2::ONE,
            curvature: DVec2::ZERO,
            clips: Vec::new(),
            partners: Vec::new(),
            color: [u8::MAX; 3],
        };
        Candidate { splat, end_clips: Vec::new(), last_resort: false, pieces: pieces.to_vec(), rank: 6 }
    }

    #[test]
    fn what_splats_alone_cover_is_what_their_successor_must() {
        let candidates = vec![candidate(&[0, 1, 2]), candidate(&[2, 3]), candidate(&[1, 3, 4])];
        let mut cover = Cover {
            candidates,
            chosen: vec![0, 1, 2],
            times: vec![1, 2, 2, 2, 1],
            areas: vec![1.0; 5],
            ..Cover::default()
        };
        assert_eq!((cover.own(&[0]), cover.own(&[1]), cover.own(&[0, 1])), (vec![0], vec![], vec![0, 2]));
        assert!(cover.serves(&[0, 1], &candidate(&[0, 2])) && !cover.serves(&[0, 1], &candidate(&[0, 1])));
        cover.replace(&[0, 1], candidate(&[0, 2]));
        cover.chosen.retain(|&index| index > 1);
        assert_eq!((cover.times.as_slice(), cover.chosen.as_slice()), (&[1, 1, 1, 1, 1][..], &[2, 3][..]));
        assert_eq!(cover.drop_redundant(), 0);
    }
}
