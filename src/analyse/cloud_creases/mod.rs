//! Finds the creases of a cloud.
//!
//! 1. `samples`: where the points beside one lie as on no smooth surface, two half planes, which may bend along
//!    their line, are fitted to those around (`plane`, `hinge`); where they explain them much better than a quadric does
//!    (`bowl`), their line passes the crease.
//! 2. `ridge`: such samples are drawn together onto one line, and thinned out along it.
//! 3. `links`: each is linked to the next on either side; `lines` keeps the chains that are sharp
//!    enough and smooths them.
//! 4. `corners`: `ends` that lead to one place, or into another line, are carried on to it, or to each other over a
//!    gap, straight or on a circle (`arcs`). Where three meet, `faces` tells the corner from the planes around, unless
//!    noise calls for more points than lie beside it.
//! 5. `arms`: creases too short for samples of their own, and gaps, are looked for between the ends of lines.
//!
//! Sizes are told in spacings of the points. Each stage takes what the one before made in the order of
//! the points, which lie along a Morton curve, so that nothing depends on the order of the input or
//! on the threads.

mod arcs;
mod arms;
mod bowl;
mod corners;
mod ends;
mod faces;
mod hinge;
mod lines;
mod links;
mod plane;
mod ridge;
mod samples;
#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::prelude::*;

use super::distinct::distinct;
use super::nearest::{Search, Spacings, spacing};
use super::sets::Sets;
use crate::error::Result;
use crate::model::cloud::Cloud;
use corners::Joined;
pub use corners::meeting;
use lines::Line;
use links::Chain;
pub use samples::Points;

/// What counts as a crease.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sought {
    /// The angle by which the surface turns, degrees.
    pub degrees: f64,
    /// Lines shorter than this, taken together with all that they meet, are left out; model units.
    pub shortest: f64,
}

/// A crease goes on, from where it is sharp enough by itself, where it turns by this share of the
/// angle.
const WEAK_SHARE: f64 = 0.75;

/// A line with loose ends is at least this many neighbourhoods long: one with none, with one, with
/// two.
const LENGTHS: [f64; 3] = [0.5, 3.0, 5.0];

/// The same where noise calls for no more points than are looked at without it: chance makes few lines there. Up to
/// noise of 0.2 spacings those of nine parts and scans lie on creases as before (95 to 100 % of them) and take in 1 to
/// 14 % more; at 0.5, in larger neighbourhoods, up to half of what shorter ones add would lie on none.
const CLEAR_LENGTHS: [f64; 3] = [0.2, 1.2, 2.0];

/// What lies between ends is at most this long, in sizes: longer creases have samples of their own.
const LONGEST: f64 = 6.0;

/// Lines along which the surface of a cloud is creased, model units; a closed one repeats its first
/// place at the end.
///
/// `noise` is the standard deviation of the points from their surface, model units; `None` where they show
/// none, and have no creases.
///
/// # Errors
/// [`crate::Error::Internal`] should the neighbour search not take the points.
pub fn cloud_creases(cloud: &Cloud, sought: &Sought, noise: Option<f64>) -> Result<Vec<Vec<DVec3>>> {
    let Some(noise) = noise else { return Ok(Vec::new()) };
    let positions = distinct(cloud).positions;
    let search = Search::new(&positions)?;
    let nearest = search.nearest();
    let spacing = spacing(&positions, &nearest);
    let laid = Spacings { search: &search, positions: &positions, spacing: &spacing };
    found(&Points { laid, nearest: &nearest, noise }, sought)
}

/// As [`cloud_creases`], of points whose neighbours are known.
///
/// # Errors
/// As [`cloud_creases`].
pub fn found(points: &Points<'_>, sought: &Sought) -> Result<Vec<Vec<DVec3>>> {
    let all = 0..points.laid.positions.len() as u32;
    let sharp = libm::cos(sought.degrees.to_radians());
    let chains = chains(points, all.into_par_iter(), WEAK_SHARE * sought.degrees)?;
    let mut lines: Vec<Line> = chains.iter().filter_map(|chain| Line::of(chain, sharp)).collect();
    let joined = corners::join(&mut lines, &|place| points.foot(place).is_some())?;
    let lengths = if points.are_clear() { CLEAR_LENGTHS } else { LENGTHS };
    let mut lines = worth_it(lines, &joined, sought.shortest, lengths);
    if points.are_clear() {
        faces::sharpen(&mut lines, points);
    }
    lines.extend(arms::between_ends(&lines, points, sharp)?);
    Ok(lines.into_iter().map(Line::whole).collect())
}

/// A piece of a crease.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Model units.
    pub ends: [DVec3; 2],
    /// Whether the two half planes leave nothing of the points beside the crease to explain. Beside a crest narrower
    /// than the points lie apart they leave some: where its sides would meet is not where it is.
    pub exact: bool,
}

/// Pieces of creases, however short, at which the surface turns by more than an angle (degrees), as far as some of the
/// points show them, which are numbered ascending.
///
/// # Errors
/// As [`cloud_creases`].
pub fn traces(points: &Points<'_>, shown_by: &[u32], degrees: f64) -> Result<Vec<Piece>> {
    let chains = chains(points, shown_by.par_iter().copied(), degrees)?;
    Ok(chains.iter().flat_map(pieces).collect())
}

fn pieces(chain: &Chain) -> Vec<Piece> {
    let exact = samples::are_exact(&chain.samples);
    let places = Line::along(chain).whole();
    places.windows(2).map(|side| Piece { ends: [side[0], side[1]], exact }).collect()
}

/// Samples of creases in the order in which they follow each other.
fn chains(
    points: &Points<'_>,
    shown_by: impl IndexedParallelIterator<Item = u32>,
    degrees: f64,
) -> Result<Vec<Chain>> {
    links::chains(&ridge::ridge(points.samples(shown_by, libm::cos(degrees.to_radians())))?)
}

/// The lines that are long enough for what they meet, those that go on over gaps as one.
fn worth_it(lines: Vec<Line>, joined: &Joined, shortest: f64, lengths: [f64; 3]) -> Vec<Line> {
    let mut sets = Sets::new(lines.len());
    let mut ends: Vec<([u64; 3], u32)> = Vec::new();
    for (n, line) in (0_u32..).zip(&lines) {
        ends.extend(line.places.iter().map(|place| (place.to_array().map(f64::to_bits), n)));
    }
    ends.sort_unstable();
    for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        sets.merge(pair[0].1, pair[1].1);
    }
    let (mut together, mut as_one) = (vec![0.0; lines.len()], vec![(0.0, 0); lines.len()]);
    for (n, line) in lines.iter().enumerate() {
        together[sets.root(n as u32) as usize] += line.length();
        let (length, loose) = &mut as_one[joined.run[n] as usize];
        *length += line.length();
        *loose += if line.closed { 0 } else { joined.met[n].iter().filter(|met| !**met).count() };
    }
    let mut is_long = |n: usize, line: &Line| {
        let (length, loose) = as_one[joined.run[n] as usize];
        together[sets.root(n as u32) as usize] >= shortest && length >= lengths[loose] * line.size
    };
    let keep: Vec<bool> = lines.iter().enumerate().map(|(n, line)| is_long(n, line)).collect();
    lines.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(line, _)| line).collect()
}
