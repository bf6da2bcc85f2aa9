//! A cover by Lagrangian costs.

use std::collections::BinaryHeap;

use super::SetCover;
use crate::sample::gain::Gain;

impl SetCover {
    /// A cover taken greedily by reduced costs under some multipliers, without what it can do without;
    /// ascending.
    ///
    /// A candidate's score is its cost less the multipliers of what it would newly cover, a piece of
    /// these if that is above zero, and times them if it is below (Caprara, Fischetti and Toth 1999, "A
    /// heuristic method for the set covering problem", 2.2).
    pub(super) fn greedy(&self, multipliers: &[f64]) -> Vec<u32> {
        let sum = |pieces: &[u32]| pieces.iter().map(|&piece| multipliers[piece as usize]).sum::<f64>();
        let sets = (0_u32..).zip(&self.costs).map(|(index, cost)| (cost, self.sets.row(index)));
        let mut offers: Vec<Offer> =
            sets.map(|(cost, pieces)| Offer { reduced: cost - sum(pieces), new: pieces.len() }).collect();
        let first = (0..).zip(&offers).filter(|(_, offer)| offer.new > 0);
        let mut heap: BinaryHeap<Gain> =
            first.map(|(index, offer)| Gain { gain: offer.gain(), index }).collect();
        let mut covered = vec![false; self.pieces];
        let mut chosen = Vec::new();
        while let Some(top) = heap.pop() {
            let offer = &offers[top.index];
            if offer.new == 0 {
                continue;
            }
            let now = Gain { gain: offer.gain(), ..top };
            // As pieces are covered gains only fall, so one that still leads is the greatest.
            if heap.peek().is_some_and(|next| *next > now) {
                heap.push(now);
                continue;
            }
            chosen.push(now.index as u32);
            for &piece in self.sets.row(now.index as u32) {
                if !std::mem::replace(&mut covered[piece as usize], true) {
                    for &other in self.covering.row(piece) {
                        offers[other as usize].lose(multipliers[piece as usize]);
                    }
                }
            }
        }
        self.pruned(chosen)
    }
}

/// What a candidate would come to if it were taken now.
struct Offer {
    /// Its cost less the multipliers of what it would newly cover.
    reduced: f64,
    /// How many pieces it would newly cover.
    new: usize,
}

impl Offer {
    /// The score, negated.
    fn gain(&self) -> f64 {
        let new = self.new as f64;
        if self.reduced > 0.0 { -self.reduced / new } else { -self.reduced * new }
    }

    /// Another candidate covers a piece of this multiplier.
    fn lose(&mut self, multiplier: f64) {
        self.reduced += multiplier;
        self.new -= 1;
    }
}
