//! The cover chosen anew, from all the candidates known by now.
//!
//! The greedy choice and the moves each look at a few splats at a time. What they leave shows when
//! all of the cover is weighed at once ([`super::set_cover`]): at a tenth of a percent files are 2 to
//! 6 % smaller for it.

use super::cover::{Cover, cost};
use super::set_cover::{Alike, SetCover};

impl Cover {
    /// Takes a cheaper choice from the candidates that covers the same pieces, if one is found; `alike` has
    /// the first of them, and gets the others.
    pub(super) fn rechoose(&mut self, alike: &mut Alike) {
        let new = &self.candidates[alike.candidates()..];
        new.iter().for_each(|candidate| alike.add(&candidate.pieces));
        let costs = self.candidates.iter().map(|candidate| cost(&candidate.splat)).collect();
        let problem = SetCover::of_decisive(costs, alike);
        let known: Vec<u32> = self.chosen.iter().map(|&index| index as u32).collect();
        let spent = problem.cost(&known);
        let found = problem.cheaper(known);
        if problem.cost(&found) < spent {
            self.take(found.into_iter().map(|index| index as usize).collect());
        }
    }

    /// Chooses these instead.
    fn take(&mut self, chosen: Vec<usize>) {
        self.times.fill(0);
        for &piece in chosen.iter().flat_map(|&index| &self.candidates[index].pieces) {
            self.times[piece as usize] += 1;
        }
        self.chosen = chosen;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::cover::tests::candidate;

    /// All candidates cost the same here.
    fn cover(lists: &[&[u32]], chosen: &[usize], pieces: usize) -> Cover {
        let candidates = lists.iter().map(|pieces| candidate(pieces)).collect();
        let mut cover =
            Cover { candidates, times: vec![0; pieces], areas: vec![1.0; pieces], ..Cover::default() };
        cover.take(chosen.to_vec());
        cover
    }

    #[test]
    fn two_halves_take_the_place_of_what_greed_chose() {
        // The largest first, and two for what it leaves; none of them is redundant.
        let lists: [&[u32]; 5] = [&[1, 2, 4, 5], &[0], &[3], &[0, 1, 2], &[3, 4, 5]];
        let mut cover = cover(&lists, &[0, 1, 2], 6);
        assert_eq!(cover.drop_redundant(), 0);
        cover.rechoose(&mut Alike::new(cover.areas.len()));
        assert_eq!((cover.chosen.as_slice(), cover.times.as_slice()), (&[3, 4][..], &[1; 6][..]));
    }

    #[test]
    fn a_choice_that_cannot_be_bettered_stays_as_it_is() {
        // Another choice costs as much.
        let mut cover = cover(&[&[0, 1], &[2], &[0], &[1, 2]], &[1, 0], 3);
        cover.rechoose(&mut Alike::new(cover.areas.len()));
        assert_eq!((cover.chosen.as_slice(), cover.times.as_slice()), (&[1, 0][..], &[1; 3][..]));
    }
}
