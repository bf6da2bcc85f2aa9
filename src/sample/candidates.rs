//! Grows candidates from seeds spread over the surface, more of them with more effort.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::grow::{Domain, Grower};
use super::region::Region;
use super::scout::Begun;
use super::settle::{Candidate, settle};
use crate::analyse::canonical::mix;
use crate::analyse::surface::Surface;

/// Seeds grown side by side before their cores are marked. Batches are of the same size
/// whatever the threads, so that the candidates are the same too.
const BATCH: usize = 128;

/// One region for each thread, kept from seed to seed.
pub struct Regions {
    regions: Vec<Mutex<Region>>,
}

impl Regions {
    /// Regions for the threads of the pool this is called in.
    #[must_use]
    pub fn new(points: usize) -> Self {
        Self { regions: (0..rayon::current_num_threads()).map(|_| Mutex::new(Region::new(points))).collect() }
    }

    /// Runs something with this thread's region.
    pub fn with<T>(&self, run: impl FnOnce(&mut Region) -> T) -> T {
        let thread = rayon::current_thread_index().unwrap_or(0) % self.regions.len();
        // A region holds nothing that a panic elsewhere could have left half-done.
        run(&mut self.regions[thread].lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Share of a candidate's radii inside which no further seed is planted, around its centre and around its own seed,
/// from which it may have grown to one side: others there grow to the same.
#[must_use]
pub fn core_share(effort: u8) -> f64 {
    1.0 - 0.08 * f64::from(effort.clamp(1, 9))
}

/// Pieces to grow splats from, strewn over the surface in an order of their own.
pub(super) struct Seeds {
    order: Vec<u32>,
    done: Vec<bool>,
    at: usize,
}

impl Seeds {
    /// All of so many pieces.
    pub(super) fn over(pieces: usize) -> Self {
        let mut order: Vec<u32> = (0..pieces as u32).collect();
        order.par_sort_unstable_by_key(|&piece| mix(u64::from(piece)));
        Self { order, done: vec![false; pieces], at: 0 }
    }

    /// The next that are not done; `None` once there are none.
    pub(super) fn next_batch(&mut self) -> Option<Vec<u32>> {
        let mut batch = Vec::with_capacity(BATCH);
        while self.at < self.order.len() && batch.len() < BATCH {
            let piece = self.order[self.at];
            if !self.done[piece as usize] {
                batch.push(piece);
            }
            self.at += 1;
        }
        (!batch.is_empty()).then_some(batch)
    }

    /// How many have been in a batch or left out so far.
    pub(super) fn passed(&self) -> usize {
        self.at
    }

    /// Leaves out these.
    pub(super) fn done(&mut self, pieces: Vec<u32>) {
        pieces.into_iter().for_each(|piece| self.done[piece as usize] = true);
    }
}

/// Grows candidates from seeds until the core of one holds every piece that one covers; those begun
/// come first.
///
/// `advance` is told how many pieces are done.
pub fn candidates(
    grower: &Grower,
    regions: &Regions,
    begun: &Begun,
    effort: u8,
    mut advance: impl FnMut(usize),
) -> Vec<Candidate> {
    let with_core = |candidate: Candidate, seed: u32| {
        let core = core(grower.surface, &candidate, seed, core_share(effort));
        (core, candidate)
    };
    // Seeds beside that of a splat in finer steps may lead to others that need none.
    let without_core = |candidate: Candidate| (Vec::new(), candidate);
    let end = |(domain, piece): &(Domain, u32)| {
        let seeds = grower.surface.pieces[*piece as usize];
        let settled =
            |grower: &Grower, region: &mut Region| settle(grower, domain.clone(), &seeds, *piece, region);
        regions.with(|region| {
            let found = settled(grower, region).map(|found| with_core(found, *piece));
            found.or_else(|| grower.finer().find_map(|finer| settled(&finer, region)).map(without_core))
        })
    };
    let mut seeds = Seeds::over(grower.surface.pieces.len());
    let mut found = Vec::new();
    let mut take = |seeds: &mut Seeds, grown: Vec<Option<(Vec<u32>, Candidate)>>| {
        for (core, candidate) in grown.into_iter().flatten() {
            seeds.done(core);
            found.push(candidate);
        }
    };
    take(&mut seeds, begun.domains.par_iter().map(end).collect());
    while let Some(batch) = seeds.next_batch() {
        let grow = |&piece: &u32| {
            regions.with(|region| {
                let found = grower.grow(piece, region).map(|found| with_core(found, piece));
                found.or_else(|| grower.grow_finer(piece, region).map(without_core))
            })
        };
        take(&mut seeds, batch.par_iter().map(grow).collect());
        advance(seeds.passed());
    }
    found
}

/// The pieces of a candidate whose middles lie within a share of its radii of its centre or of its seed's middle.
fn core(surface: &Surface, Candidate { splat, pieces, .. }: &Candidate, seed: u32, share: f64) -> Vec<u32> {
    let at = |piece: u32| splat.to_local(surface.middle(piece)).truncate();
    let seed = at(seed);
    let inside = |piece: &u32| {
        let uv = at(*piece);
        splat.ellipse(uv).min(splat.ellipse(uv - seed)) <= share * share
    };
    pieces.iter().copied().filter(inside).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::sample::cover::tests::candidate;

    #[test]
    fn no_seed_is_planted_beside_the_one_that_a_splat_grew_from_to_one_side() {
        let at = |x: f32| Vec3::new(x, 0.0, 0.0);
        let surface = Surface {
            points: [-0.9, 0.3, 0.6, 0.9].map(at).to_vec(),
            pieces: (0..4).map(|n| [n; 3]).collect(),
            ..Surface::default()
        };
        let around = |seed: u32| core(&surface, &candidate(&[0, 1, 2, 3]), seed, 0.4);
        assert_eq!((around(1), around(3)), (vec![1, 2], vec![1, 2, 3]));
    }
}
