//! Weighted set covers: which candidates cover every piece at the least cost.
//!
//! Nobody finds the optimum in time, but prices on pieces, which an [`ascent`] finds, both bound it
//! from below and lead a [`greedy`] choice close to it; a [`search`] through neighbourhoods then does
//! the rest.

mod alike;
mod ascent;
mod decisive;
mod greedy;
mod neighbourhoods;
mod search;
#[cfg(test)]
pub(super) mod tests;

use crate::analyse::surface::Rows;
pub(super) use alike::Alike;
use decisive::decisive;

/// Candidates and the pieces that are to be covered, each by one candidate at least.
pub(super) struct SetCover {
    /// For each candidate what it costs, above zero.
    costs: Vec<f64>,
    /// For each candidate the pieces it covers, ascending.
    sets: Rows,
    /// For each piece the candidates that cover it, ascending.
    covering: Rows,
    pieces: usize,
}

impl SetCover {
    /// Candidates of such costs, and of the pieces of each lot one, those that decide ([`decisive`]): what
    /// covers these covers every piece that some candidate covers.
    pub(super) fn of_decisive(costs: Vec<f64>, alike: &Alike) -> Self {
        let covering = alike.covering();
        let kept = decisive(&covering, costs.len());
        Self::over(costs, kept.len(), |piece| covering.row(kept[piece as usize]).iter().copied())
    }

    /// Some of the pieces, with those candidates that cover one of them; and which these are.
    fn part(&self, pieces: &[u32]) -> (Self, Vec<u32>) {
        let mut candidates: Vec<u32> =
            pieces.iter().flat_map(|&piece| self.covering.row(piece)).copied().collect();
        candidates.sort_unstable();
        candidates.dedup();
        let costs = candidates.iter().map(|&index| self.costs[index as usize]).collect();
        let renumbered = |index: &u32| candidates.partition_point(|other| other < index) as u32;
        let row = |piece: u32| self.covering.row(pieces[piece as usize]).iter().map(renumbered);
        (Self::over(costs, pieces.len(), row), candidates)
    }

    /// Pieces each of which is covered by some candidates, ascending.
    fn over<I: Iterator<Item = u32>>(costs: Vec<f64>, pieces: usize, row: impl Fn(u32) -> I) -> Self {
        let covering = Rows::placed(pieces, || {
            (0..pieces as u32).flat_map(|piece| row(piece).map(move |index| (piece, index)))
        });
        let sets = Rows::placed(costs.len(), || {
            (0..pieces as u32).flat_map(|piece| covering.row(piece).iter().map(move |&index| (index, piece)))
        });
        Self { costs, sets, covering, pieces }
    }

    /// What some candidates cost.
    pub(super) fn cost(&self, chosen: &[u32]) -> f64 {
        chosen.iter().map(|&index| self.costs[index as usize]).sum()
    }

    /// For each piece how many of some candidates cover it.
    fn times(&self, chosen: &[u32]) -> Vec<u32> {
        let mut times = vec![0; self.pieces];
        for &piece in chosen.iter().flat_map(|&index| self.sets.row(index)) {
            times[piece as usize] += 1;
        }
        times
    }

    /// A cover without those that it can do without, the dearest first, and of equals those that
    /// cover the fewest pieces; ascending.
    fn pruned(&self, mut chosen: Vec<u32>) -> Vec<u32> {
        let mut times = self.times(&chosen);
        let cost = |index: u32| self.costs[index as usize];
        let count = |index: u32| self.sets.row(index).len();
        chosen.sort_unstable_by(|&a, &b| {
            cost(b).total_cmp(&cost(a)).then(count(a).cmp(&count(b))).then(a.cmp(&b))
        });
        chosen.retain(|&index| {
            let pieces = self.sets.row(index);
            let redundant = pieces.iter().all(|&piece| times[piece as usize] > 1);
            if redundant {
                pieces.iter().for_each(|&piece| times[piece as usize] -= 1);
            }
            !redundant
        });
        chosen.sort_unstable();
        chosen
    }
}
