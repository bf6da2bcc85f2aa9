//! Samples along creases linked to lines.

use std::collections::BTreeSet;

use glam::DVec3;
use rayon::prelude::*;

use super::ridge::{alike, search};
use super::samples::Sample;
use crate::analyse::nearest::Search;
use crate::analyse::surface::NONE;
use crate::error::Result;

/// The next sample lies within this share of a sample's size...
const REACH: f64 = 1.0;

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

/// Lines of samples, each linked to the next on either side where that is mutual.
///
/// # Errors
/// As [`Search::new`].
pub(super) fn chains(samples: &[Sample]) -> Result<Vec<Chain>> {
    if samples.is_empty() {
        return Ok(Vec::new());
    }
    let search = search(samples)?;
    let next: Vec<[u32; 2]> = (0..samples.len() as u32)
        .into_par_iter()
        .map(|n| [1.0, -1.0].map(|sign| next(samples, &search, n, sign)))
        .collect();
    let linked = |a: u32, side: usize| {
        let b = next[a as usize][side];
        let mutual = b != NONE && next[b as usize].contains(&a);
        // Two that are each other's next on both sides are no loop.
        (mutual && next[a as usize] != [b; 2]).then_some(b)
    };
    let mut unused: BTreeSet<u32> = (0..samples.len() as u32).collect();
    let mut found = Vec::new();
    while let Some(start) = unused.pop_first() {
        let mut line = vec![start];
        let closed = walk(start, 0, &linked, &next, &mut unused, &mut line);
        if !closed {
            line.reverse();
            walk(start, 1, &linked, &next, &mut unused, &mut line);
        }
        found.push(Chain { samples: line.into_iter().map(|n| samples[n as usize]).collect(), closed });
    }
    Ok(found)
}

/// Goes on along a line until it ends; whether it came back to where it started.
fn walk(
    start: u32,
    mut side: usize,
    linked: &impl Fn(u32, usize) -> Option<u32>,
    next: &[[u32; 2]],
    unused: &mut BTreeSet<u32>,
    line: &mut Vec<u32>,
) -> bool {
    let mut at = start;
    while let Some(onward) = linked(at, side) {
        if !unused.remove(&onward) {
            return onward == start && line.len() > 2;
        }
        line.push(onward);
        // On by the side that does not lead back.
        side = usize::from(next[onward as usize][0] == at);
        at = onward;
    }
    false
}

/// The sample that follows one in its direction, or against it; or [`NONE`].
fn next(samples: &[Sample], search: &Search, n: u32, sign: f64) -> u32 {
    let sample = &samples[n as usize];
    let cost = |other: u32| {
        let other = &samples[other as usize];
        let way: DVec3 = other.place - sample.place;
        let length = way.length();
        let ahead = sign * way.dot(sample.along);
        let follows = ahead >= AHEAD * length && way.dot(other.along).abs() >= AHEAD * length;
        (follows && length > 0.0 && length <= REACH * sample.size && alike(sample, other))
            .then(|| length * length / ahead)
    };
    let around = search.around(sample.place.as_vec3(), LOOKED_AT);
    let costs =
        around.into_iter().filter(|&other| other != n).filter_map(|other| Some((cost(other)?, other)));
    costs.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map_or(NONE, |(_, other)| other)
}
