//! How little any cover by the candidates could cost.
//!
//! Choosing candidates that cover every piece at the least cost is a weighted set cover, whose
//! optimum nobody finds in time; what it cannot fall below is soon found. Prices on pieces do it:
//! where no candidate costs less than the prices of all that it covers, every cover costs at least
//! the prices of all pieces.
//!
//! What is bounded is [`cost`], the file's size as the choice weighs it, over the candidates at hand:
//! those grown from seeds, last resorts, and those that moves and exchanges laid out. Splats that
//! nothing grew may make a cheaper cover.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::cover::{Cover, cost};
use super::set_cover::{Alike, SetCover};

/// Rounds at most. After half as many four models were within 0.2 % of the optimum of the linear
/// relaxation, as another solver (HiGHS) found it, after these within 0.1 %; half as many again
/// gained a hundred thousandth.
const ROUNDS: usize = 1000;

/// What a cover costs, and lower bounds of what any cover by the same candidates costs, in bytes as
/// [`cost`] weighs splats. The bounds hold up to the rounding of 64-bit sums.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LowerBound {
    /// What the cover at hand costs.
    pub cost: f64,
    /// Every piece priced by area, at the fewest bytes an area of the candidates that cover it. It
    /// holds for any other splat as well that costs at least these prices of what it covers: for one
    /// that covers, byte for byte, no more area than the best candidates over its pieces.
    pub area: f64,
    /// The Lagrangian bound: at most, and after enough rounds about, what the cheapest cover by
    /// fractions of candidates costs. Never below the bound by area.
    pub lagrangian: f64,
    /// Rounds that the Lagrangian bound took.
    pub rounds: usize,
}

impl LowerBound {
    /// By what share of the cheapest cover by the candidates the cover at hand costs more than it, at
    /// most.
    #[must_use]
    pub fn excess(&self) -> f64 {
        if self.lagrangian > 0.0 { (self.cost / self.lagrangian - 1.0).max(0.0) } else { 0.0 }
    }
}

impl Cover {
    /// Lower bounds of what a cover by its candidates costs, beside what it costs itself.
    #[must_use]
    pub fn lower_bound(&self) -> LowerBound {
        let costs: Vec<f64> = self.candidates.iter().map(|candidate| cost(&candidate.splat)).collect();
        let covered: Vec<&[u32]> =
            self.candidates.iter().map(|candidate| candidate.pieces.as_slice()).collect();
        let spent = self.chosen.iter().map(|&index| costs[index]).sum();
        Problem { costs: &costs, covered: &covered, areas: &self.areas }.bound(spent)
    }
}

/// A weighted set cover.
struct Problem<'a> {
    /// For each candidate what it costs, above zero.
    costs: &'a [f64],
    /// For each candidate the pieces it covers, ascending.
    covered: &'a [&'a [u32]],
    /// The area of each piece, at least zero.
    areas: &'a [f64],
}

impl Problem<'_> {
    /// Bounds beside a known cover that costs `spent`. A piece that no candidate covers counts for
    /// nothing.
    fn bound(&self, spent: f64) -> LowerBound {
        let area = self.by_area();
        let relaxed = SetCover::of_decisive(self.costs.to_vec(), &Alike::of(self.covered, self.areas.len()));
        let peak = relaxed.ascend(relaxed.feasible(), spent, ROUNDS, |_, _| ());
        // A cover proved to be the best may be bounded a rounding above itself.
        let lagrangian = peak.bound.max(area).min(spent);
        LowerBound { cost: spent, area: area.min(spent), lagrangian, rounds: peak.rounds }
    }

    /// The bound by area. Its prices of what a candidate covers are at most its own price an area
    /// times its area, so that none costs less than they come to.
    fn by_area(&self) -> f64 {
        let area = |pieces: &[u32]| pieces.iter().map(|&piece| self.areas[piece as usize]).sum::<f64>();
        let mut least = vec![f64::INFINITY; self.areas.len()];
        for (cost, pieces) in self.costs.iter().zip(self.covered) {
            let rate = cost / area(pieces);
            for &piece in *pieces {
                let least = &mut least[piece as usize];
                *least = least.min(rate);
            }
        }
        let priced = self.areas.iter().zip(least).filter(|&(&area, least)| {
            // What none covers has no price, nor has a candidate whose pieces have no area.
            area > 0.0 && least < f64::INFINITY
        });
        priced.map(|(area, least)| area * least).sum()
    }
}
