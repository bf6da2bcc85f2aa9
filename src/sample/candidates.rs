//! Grows candidates from seeds spread over the surface, more of them with more effort.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::grow::Grower;
use super::region::Region;
use super::settle::Candidate;
use crate::analyse::canonical::mix;

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

/// Share of a candidate's radii inside which no further seed is planted.
#[must_use]
pub fn core_share(effort: u8) -> f64 {
    1.0 - 0.08 * f64::from(effort.clamp(1, 9))
}

/// Grows candidates from seeds until the core of one holds every piece that one covers.
///
/// `advance` is told how many pieces are done.
pub fn candidates(
    grower: &Grower,
    regions: &Regions,
    effort: u8,
    mut advance: impl FnMut(usize),
) -> Vec<Candidate> {
    let pieces = grower.surface.pieces.len();
    let mut order: Vec<u32> = (0..pieces as u32).collect();
    order.par_sort_unstable_by_key(|&piece| mix(u64::from(piece)));
    let mut done = vec![false; pieces];
    let mut found = Vec::new();
    let mut at = 0;
    while at < pieces {
        let mut batch = Vec::with_capacity(BATCH);
        while at < pieces && batch.len() < BATCH {
            if !done[order[at] as usize] {
                batch.push(order[at]);
            }
            at += 1;
        }
        let grow = |&piece: &u32| {
            let candidate = regions.with(|region| grower.grow(piece, region))?;
            Some((core(grower, &candidate, core_share(effort)), candidate))
        };
        let grown: Vec<Option<(Vec<u32>, Candidate)>> = batch.par_iter().map(grow).collect();
        for (core, candidate) in grown.into_iter().flatten() {
            core.into_iter().for_each(|piece| done[piece as usize] = true);
            found.push(candidate);
        }
        advance(at);
    }
    found
}

/// The pieces of a candidate whose middles lie within a share of its radii.
fn core(grower: &Grower, candidate: &Candidate, share: f64) -> Vec<u32> {
    let inside = |piece: &u32| {
        let uv = candidate.splat.to_local(grower.surface.middle(*piece)).truncate();
        candidate.splat.ellipse(uv) <= share * share
    };
    candidate.pieces.iter().copied().filter(inside).collect()
}
