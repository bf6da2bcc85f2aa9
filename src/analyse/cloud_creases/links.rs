//! Samples along creases linked to lines.

use glam::DVec3;
use rayon::prelude::*;

use super::ridge::{alike, search};
use super::samples::Sample;
use crate::analyse::nearest::Search;
use crate::analyse::surface::NONE;
use crate::error::Result;

/// The next sample lies within this share of a sample's size...
const REACH: f64 = 1.25;

/// ... and in its direction (cosine of 37°), as it lies in that of the next.
const AHEAD: f64 = 0.8;

/// Samples looked at around one.
const LOOKED_AT: usize = 24;

/// A line of samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    /// In order along it; the first is not repeated at the end.
    pub(super) samples: Vec<Sample>,
    /// Whether the last is followed by the first.
    pub(super) closed: bool,
}

/// Lines of samples, each linked to at most one on either side: the nearest pairs first.
///
/// # Errors
/// As [`Search::new`].
pub(super) fn chains(samples: &[Sample]) -> Result<Vec<Chain>> {
    if samples.is_empty() {
        return Ok(Vec::new());
    }
    let search = search(samples)?;
    let near = (0..samples.len() as u32).into_par_iter().flat_map_iter(|n| pairs(samples, &search, n));
    let mut pairs: Vec<Pair> = near.collect();
    pairs.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.ends.cmp(&b.ends)));
    let mut next = vec![[NONE; 2]; samples.len()];
    for Pair { ends: [(a, side_a), (b, side_b)], .. } in pairs {
        let free = next[a as usize][side_a] == NONE && next[b as usize][side_b] == NONE;
        if free && !next[a as usize].contains(&b) {
            next[a as usize][side_a] = b;
            next[b as usize][side_b] = a;
        }
    }
    let mut used = vec![false; samples.len()];
    let mut found = Vec::new();
    for start in 0..samples.len() as u32 {
        if std::mem::replace(&mut used[start as usize], true) {
            continue;
        }
        let mut line = vec![start];
        let closed = walk(start, 0, &next, &mut used, &mut line);
        if !closed {
            line.reverse();
            walk(start, 1, &next, &mut used, &mut line);
        }
        found.push(Chain { samples: line.into_iter().map(|n| samples[n as usize]).collect(), closed });
    }
    Ok(found)
}

/// Goes on along a line until it ends; whether it came back to where it started.
fn walk(start: u32, mut side: usize, next: &[[u32; 2]], used: &mut [bool], line: &mut Vec<u32>) -> bool {
    let mut at = start;
    loop {
        let onward = next[at as usize][side];
        if onward == NONE || std::mem::replace(&mut used[onward as usize], true) {
            return onward == start;
        }
        line.push(onward);
        // On by the side that does not lead back.
        side = usize::from(next[onward as usize][0] == at);
        at = onward;
    }
}

/// Two samples that may follow each other.
#[derive(Clone, Copy, Debug)]
struct Pair {
    /// Their distance, more where the way turns.
    cost: f64,
    /// Each with its side that faces the other: 0 in its direction, 1 against it.
    ends: [(u32, usize); 2],
}

/// Pairs of a sample and those of greater number that may follow it on either side.
fn pairs(samples: &[Sample], search: &Search, n: u32) -> Vec<Pair> {
    let sample = &samples[n as usize];
    let pair = |number: u32| {
        let other = &samples[number as usize];
        let way: DVec3 = other.place - sample.place;
        let length = way.length();
        let [here, there] = [way.dot(sample.along), -way.dot(other.along)];
        let follows = here.abs().min(there.abs()) >= AHEAD * length;
        let near = length > 0.0 && length <= REACH * sample.size;
        let ends = [(n, usize::from(here < 0.0)), (number, usize::from(there < 0.0))];
        let cost = length * length * length / (here * there).abs();
        (follows && near && alike(sample, other)).then_some(Pair { cost, ends })
    };
    search
        .around(sample.place.as_vec3(), LOOKED_AT)
        .into_iter()
        .filter(|&other| other > n)
        .filter_map(pair)
        .collect()
}
