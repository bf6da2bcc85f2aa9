//! A cover divided among parts of the surface.

use super::SetCover;
use crate::analyse::canonical::mix;

/// Some of a cover's candidates that lie side by side, and the pieces they are to cover.
#[derive(Default)]
pub(super) struct Neighbourhood {
    pub(super) chosen: Vec<u32>,
    pub(super) pieces: Vec<u32>,
}

/// No neighbourhood yet.
const NONE: u32 = u32::MAX;

impl SetCover {
    /// Divides a cover into neighbourhoods of no more than `most` candidates, another way for each
    /// `round`. Each piece belongs to one of the neighbourhoods that cover it, so that all of them
    /// may be changed at once.
    pub(super) fn neighbourhoods(&self, chosen: &[u32], most: usize, round: u64) -> Vec<Neighbourhood> {
        let mut around = Around { cover: self, free: vec![false; self.costs.len()] };
        chosen.iter().for_each(|&index| around.free[index as usize] = true);
        let mut order = chosen.to_vec();
        order.sort_unstable_by_key(|&index| (mix(mix(round) ^ u64::from(index)), index));
        let mut home = vec![NONE; self.costs.len()];
        let mut found = Vec::new();
        for seed in order {
            let chosen = around.gather(seed, most);
            if chosen.is_empty() {
                continue;
            }
            chosen.iter().for_each(|&index| home[index as usize] = found.len() as u32);
            found.push(Neighbourhood { chosen, ..Neighbourhood::default() });
        }
        for piece in 0..self.pieces as u32 {
            let homes = self.covering.row(piece).iter().map(|&index| home[index as usize]);
            if let Some(at) = homes.min().filter(|&at| at != NONE) {
                found[at as usize].pieces.push(piece);
            }
        }
        found
    }
}

/// Gathers candidates around seeds.
struct Around<'a> {
    cover: &'a SetCover,
    /// For each candidate, whether it is chosen and in no neighbourhood yet.
    free: Vec<bool>,
}

impl Around<'_> {
    /// A seed and those free around it, breadth first; none if it is not free itself.
    fn gather(&mut self, seed: u32, most: usize) -> Vec<u32> {
        let mut gathered = Vec::new();
        self.take(seed, most, &mut gathered);
        let mut at = 0;
        while at < gathered.len() && gathered.len() < most {
            for &piece in self.cover.sets.row(gathered[at]) {
                for &other in self.cover.covering.row(piece) {
                    self.take(other, most, &mut gathered);
                }
            }
            at += 1;
        }
        gathered
    }

    fn take(&mut self, index: u32, most: usize, gathered: &mut Vec<u32>) {
        let free = &mut self.free[index as usize];
        if *free && gathered.len() < most {
            *free = false;
            gathered.push(index);
        }
    }
}
