//! The highest Lagrangian bound of a set cover, by subgradient ascent.
//!
//! With a multiplier `u` of at least zero for every piece, `L(u) = Σ u + Σ min(0, c - Σ u of what is
//! covered)`, the latter over the candidates of cost `c`, is at most the cost of any cover (Fisher
//! 1981, "The Lagrangian relaxation method for solving integer programming problems"), and the highest
//! is the optimum of the linear relaxation. `L` is concave; where it has a kink, one minus how often
//! the candidates of negative reduced cost cover a piece is a slope. Steps are Polyak's, as in Beasley
//! 1990 ("A Lagrangian heuristic for set-covering problems"), along a running mean of the slopes: the
//! slope alone swings from one side of a ridge to the other (Barahona and Anbil 2000, "The volume
//! algorithm").

use rayon::prelude::*;

use super::SetCover;

/// A known cover that costs by no more than this share more than the bound is as good as proved the
/// best.
const GAP: f64 = 1e-6;

/// The first factor of Polyak's steps. Along a mean such as this, 0.2 and 0.5 end within a fiftieth
/// of a percent of it, and from 1 some models were thrown so far off that they never came back.
const FACTOR: f64 = 0.1;

/// Weight of the newest slope in the mean. The slope alone, of weight one, ended up to half a percent
/// lower, 0.2 up to a tenth of a percent.
const NEW: f64 = 0.1;

/// Rounds without gain after which the factor is halved. With 10 the bound stood still earlier, by up
/// to a tenth of a percent lower.
const PATIENCE: usize = 20;

/// Steps of a lesser factor gain about a hundred thousandth.
const LEAST_FACTOR: f64 = 1e-5;

/// Candidates whose reduced costs one thread works out at a time: fewer take less than handing
/// them over.
const SHARE: usize = 256;

/// Where an ascent ended.
pub(in crate::sample) struct Peak {
    /// The highest bound found.
    pub(in crate::sample) bound: f64,
    /// Its multipliers.
    pub(in crate::sample) multipliers: Vec<f64>,
    /// Rounds that were gone.
    pub(in crate::sample) rounds: usize,
}

impl SetCover {
    /// Climbs from some multipliers, beside a cover that costs `spent`, for so many rounds at most,
    /// and shows the multipliers of each round from 1 on. The same whatever the threads.
    pub(in crate::sample) fn ascend(
        &self,
        start: Vec<f64>,
        spent: f64,
        rounds: usize,
        mut show: impl FnMut(usize, &[f64]),
    ) -> Peak {
        let (mut slope, mut direction) = (vec![0.0; self.pieces], vec![0.0; self.pieces]);
        let mut peak = Peak { bound: f64::NEG_INFINITY, multipliers: start.clone(), rounds: 0 };
        let (mut multipliers, mut factor, mut idle) = (start, FACTOR, 0);
        for round in 1..=rounds {
            let value = self.value(&multipliers, &mut slope);
            show(round, &multipliers);
            peak.rounds = round;
            idle += 1;
            if value > peak.bound {
                (peak.bound, idle) = (value, 0);
                peak.multipliers.copy_from_slice(&multipliers);
            }
            if idle == PATIENCE {
                (factor, idle) = (0.5 * factor, 0);
            }
            let steep = turn(&mut direction, &slope, &multipliers);
            let go_on = spent - peak.bound > GAP * spent && factor > LEAST_FACTOR && steep > 0.0;
            if !go_on {
                break;
            }
            let step = factor * (spent - value) / steep;
            for (multiplier, along) in multipliers.iter_mut().zip(&direction) {
                *multiplier = (*multiplier + step * along).max(0.0);
            }
        }
        peak
    }

    /// Multipliers that leave no reduced cost negative: each candidate's cost shared by what it
    /// covers, of which a piece takes the least.
    pub(in crate::sample) fn feasible(&self) -> Vec<f64> {
        let mut multipliers = vec![f64::INFINITY; self.pieces];
        for (index, cost) in (0_u32..).zip(&self.costs) {
            let pieces = self.sets.row(index);
            for &piece in pieces {
                let least = &mut multipliers[piece as usize];
                *least = least.min(cost / pieces.len() as f64);
            }
        }
        multipliers
    }

    /// The bound at some multipliers, and its slope there.
    fn value(&self, multipliers: &[f64], slope: &mut [f64]) -> f64 {
        let reduced = |index: usize| {
            let pieces = self.sets.row(index as u32).iter();
            self.costs[index] - pieces.map(|&piece| multipliers[piece as usize]).sum::<f64>()
        };
        let candidates = (0..self.costs.len()).into_par_iter().with_min_len(SHARE);
        let reduced: Vec<f64> = candidates.map(reduced).collect();
        slope.fill(1.0);
        // Sums in order, so that they are the same whatever the threads.
        let mut value = multipliers.iter().sum();
        for (index, reduced) in (0_u32..).zip(reduced).filter(|&(_, reduced)| reduced < 0.0) {
            value += reduced;
            self.sets.row(index).iter().for_each(|&piece| slope[piece as usize] -= 1.0);
        }
        value
    }
}

/// Turns a direction towards a slope, but never below multipliers of zero; its squared length.
fn turn(direction: &mut [f64], slope: &[f64], multipliers: &[f64]) -> f64 {
    for ((along, slope), &multiplier) in direction.iter_mut().zip(slope).zip(multipliers) {
        let floor = if multiplier > 0.0 { f64::NEG_INFINITY } else { 0.0 };
        *along = ((1.0 - NEW) * *along + NEW * slope.max(floor)).max(floor);
    }
    direction.iter().map(|along| along * along).sum()
}
