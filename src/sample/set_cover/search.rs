//! Cheaper covers: over all pieces at once, then neighbourhood by neighbourhood.

use rayon::prelude::*;

use super::SetCover;
use super::neighbourhoods::Neighbourhood;

/// Rounds of the ascent over all pieces. 1000 lead to covers a few tenths of a percent cheaper at
/// first, but the neighbourhoods make up for that in less time.
const ROUNDS: usize = 300;

/// Every so many rounds of that ascent a cover is made under its multipliers.
const EVERY: usize = 20;

/// Rounds of the ascent over a neighbourhood, which starts from the multipliers of the whole.
const LOCAL_ROUNDS: usize = 100;

/// Every so many rounds of that one.
const LOCAL_EVERY: usize = 10;

/// Candidates in a neighbourhood at most. On four models 20 ended up to 0.2 % dearer and 10 up to
/// 1.2 %; 80 ended as dear or up to 0.2 % cheaper, but large covers have fewer parts then to solve side
/// by side.
const NEIGHBOURS: usize = 40;

/// Times that the cover is divided into neighbourhoods. Of four models two end within 0.06 % of the
/// optimum (HiGHS), the others within 0.3 % and 0.6 % of the best known; after half as many sweeps it
/// is up to 0.3 % more, and twice as many gain 0.15 %.
const SWEEPS: u64 = 8;

impl SetCover {
    /// A cover that costs no more than a known one, mostly much less; ascending. The same whatever
    /// the threads.
    pub(in crate::sample) fn cheaper(&self, known: Vec<u32>) -> Vec<u32> {
        let (mut chosen, prices) = self.improved(known, self.feasible(), ROUNDS, EVERY);
        for round in 0..SWEEPS {
            let parts = self.neighbourhoods(&chosen, NEIGHBOURS, round);
            let found: Vec<Vec<u32>> = parts.into_par_iter().map(|part| self.within(part, &prices)).collect();
            let mut found = found.concat();
            // One may have come to be the choice of two neighbourhoods.
            found.sort_unstable();
            found.dedup();
            chosen = self.pruned(found);
        }
        chosen
    }

    /// The cheapest of a known cover and those made along an ascent, and the multipliers at its end.
    fn improved(
        &self,
        known: Vec<u32>,
        start: Vec<f64>,
        rounds: usize,
        every: usize,
    ) -> (Vec<u32>, Vec<f64>) {
        let spent = self.cost(&known);
        let mut seen = Vec::new();
        let peak = self.ascend(start, spent, rounds, |round, multipliers| {
            if round % every == 0 {
                seen.push(multipliers.to_vec());
            }
        });
        seen.push(peak.multipliers.clone());
        let made = seen.into_par_iter().map(|multipliers| self.greedy(&multipliers));
        let made: Vec<(f64, Vec<u32>)> = made.map(|found| (self.cost(&found), found)).collect();
        // The first of the cheapest, so that what is known stays unless another saves something.
        let best = made.into_iter().fold((spent, known), |best, new| if new.0 < best.0 { new } else { best });
        (best.1, peak.multipliers)
    }

    /// What covers the pieces of a neighbourhood at no more cost than before.
    fn within(&self, Neighbourhood { chosen, pieces }: Neighbourhood, prices: &[f64]) -> Vec<u32> {
        let (part, candidates) = self.part(&pieces);
        // Those chosen that cover none of the pieces are not among the part's.
        let known = chosen.iter().filter_map(|index| candidates.binary_search(index).ok());
        let known = known.map(|at| at as u32).collect();
        let start = pieces.iter().map(|&piece| prices[piece as usize]).collect();
        let (found, _) = part.improved(known, start, LOCAL_ROUNDS, LOCAL_EVERY);
        found.into_iter().map(|index| candidates[index as usize]).collect()
    }
}
