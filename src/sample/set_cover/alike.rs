//! Pieces that the same candidates cover.

use crate::analyse::surface::Rows;

/// Pieces in lots, each of those that exactly the same candidates cover.
///
/// Candidate by candidate, each lot is split into what it covers and what not, so that what is left of
/// a lot is covered as before, and what is split off by one more. Next to no time beside listing the
/// candidates of each piece, which of a dense cloud are millions; and where candidates are added, theirs
/// is all that is gone through.
pub(in crate::sample) struct Alike {
    /// For each piece its lot. All begin in the first, and those that never leave it have no candidate.
    of: Vec<u32>,
    lots: Vec<Lot>,
    candidates: u32,
}

/// Pieces that the same candidates cover.
#[derive(Clone, Copy)]
struct Lot {
    /// The lot that it was split off, which the same candidates cover but for the last of this one; itself
    /// for the first lot.
    from: u32,
    last: u32,
    /// The candidate that split it last, and into which lot went what that covers.
    by: u32,
    into: u32,
}

/// No candidate.
const NONE: u32 = u32::MAX;

impl Alike {
    /// So many pieces that no candidate covers.
    pub(in crate::sample) fn new(pieces: usize) -> Self {
        let first = Lot { from: 0, last: NONE, by: NONE, into: 0 };
        Self { of: vec![0; pieces], lots: vec![first], candidates: 0 }
    }

    /// So many pieces, and the candidates that cover these.
    pub(in crate::sample) fn of(covered: &[&[u32]], pieces: usize) -> Self {
        let mut alike = Self::new(pieces);
        covered.iter().for_each(|covered| alike.add(covered));
        alike
    }

    /// How many candidates have been added.
    pub(in crate::sample) fn candidates(&self) -> usize {
        self.candidates as usize
    }

    /// Adds a candidate, by the pieces that it covers, nothing twice.
    pub(in crate::sample) fn add(&mut self, covered: &[u32]) {
        let candidate = self.candidates;
        for &piece in covered {
            let lot = &mut self.of[piece as usize];
            let newest = self.lots.len() as u32;
            let split = &mut self.lots[*lot as usize];
            if split.by != candidate {
                (split.by, split.into) = (candidate, newest);
                self.lots.push(Lot { from: *lot, last: candidate, by: NONE, into: 0 });
            }
            *lot = self.lots[*lot as usize].into;
        }
        self.candidates += 1;
    }

    /// For each lot that some candidate covers these, ascending; lots by the first of their pieces.
    pub(super) fn covering(&self) -> Rows {
        let mut met = vec![false; self.lots.len()];
        met[0] = true;
        let first = |lot: &u32| !std::mem::replace(&mut met[*lot as usize], true);
        let lots: Vec<u32> = self.of.iter().copied().filter(first).collect();
        Rows::built(lots.len() as u32, |row, candidates| candidates.extend(self.of_lot(lots[row as usize])))
    }

    /// The candidates that cover a lot, descending.
    fn of_lot(&self, lot: u32) -> impl Iterator<Item = u32> {
        let lots = std::iter::successors(Some(lot), |&lot| Some(self.lots[lot as usize].from));
        lots.take_while(|&lot| lot != 0).map(|lot| self.lots[lot as usize].last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_lot_stands_for_all_that_the_same_candidates_cover() {
        let mut alike = Alike::new(6);
        let rows = |alike: &Alike, count: u32| {
            let rows = alike.covering();
            (0..count).map(|row| rows.row(row).to_vec()).collect::<Vec<_>>()
        };
        // Pieces 1 and 4 by both, 2 and 3 by the first, 5 by the last, 0 by none.
        alike.add(&[1, 2, 3, 4]);
        assert_eq!(rows(&alike, 1), [[0]]);
        alike.add(&[1, 4, 5]);
        assert_eq!(rows(&alike, 3), [vec![0, 1], vec![0], vec![1]]);
        // A third takes all of one lot and some of two others.
        alike.add(&[0, 2, 3, 4]);
        assert_eq!(rows(&alike, 5), [vec![2], vec![0, 1], vec![0, 2], vec![0, 1, 2], vec![1]]);
    }
}
