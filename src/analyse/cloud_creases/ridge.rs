//! Samples of creases drawn together onto their line, and thinned out along it.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::samples::Sample;
use crate::analyse::nearest::Search;
use crate::error::Result;

/// Samples looked at around one; those of one crease within reach are about ten.
const LOOKED_AT: usize = 40;

/// A sample is drawn to those within this share of its size...
const REACH: f64 = 0.6;

/// ... that run its way (cosine of 25°)...
const ALIGNED: f64 = 0.906;

/// ... and whose sides face its way (cosine of 40°): not the groove beside a ridge.
const FACING: f64 = 0.766;

/// A sample with fewer others like it nearby is a chance.
const FEWEST: usize = 3;

/// Times that samples are drawn together.
const ROUNDS: usize = 2;

/// Samples kept lie apart by at least this share of their size: a spacing.
pub(super) const APART: f64 = 0.32;

/// Whether two samples may be of one crease, by their directions.
pub(super) fn alike(a: &Sample, b: &Sample) -> bool {
    are_aligned(a, b) && a.between.dot(b.between) >= FACING
}

/// Whether two samples run one way.
fn are_aligned(a: &Sample, b: &Sample) -> bool {
    a.along.dot(b.along).abs() >= ALIGNED
}

/// A search over the places of samples.
pub(super) fn search(samples: &[Sample]) -> Result<Search> {
    Search::new(&samples.iter().map(|sample| sample.place.as_vec3()).collect::<Vec<Vec3>>())
}

/// Samples on the middle of those around, about a spacing apart.
///
/// # Errors
/// As [`Search::new`].
pub(super) fn ridge(samples: Vec<Sample>) -> Result<Vec<Sample>> {
    let mut samples = beyond_doubt(samples)?;
    for round in 0..ROUNDS {
        if samples.is_empty() {
            return Ok(samples);
        }
        let search = search(&samples)?;
        let drawn = |sample: &Sample| drawn(sample, &samples, &search, round == 0);
        samples = samples.par_iter().filter_map(drawn).collect();
    }
    if samples.is_empty() { Ok(samples) } else { thinned(&samples) }
}

/// All but the doubtful ones within the neighbourhoods of which a sample beyond doubt runs another way: at a corner,
/// where they would draw others off the lines (without this, fandisk takes 9 % more bytes).
fn beyond_doubt(samples: Vec<Sample>) -> Result<Vec<Sample>> {
    let sure: Vec<Sample> = samples.iter().filter(|sample| !sample.doubtful).copied().collect();
    if sure.is_empty() {
        return Ok(samples);
    }
    let search = search(&sure)?;
    let at_corner = |sample: &Sample| {
        let around = search.around(sample.place.as_vec3(), LOOKED_AT).into_iter().map(|n| &sure[n as usize]);
        around
            .take_while(|other| other.place.distance(sample.place) < sample.size)
            .any(|other| !are_aligned(sample, other))
    };
    Ok(samples.into_par_iter().filter(|sample| !(sample.doubtful && at_corner(sample))).collect())
}

/// A sample moved across its line to the mean of those like it; none if there are few.
fn drawn(sample: &Sample, samples: &[Sample], search: &Search, few_go: bool) -> Option<Sample> {
    let reach = REACH * sample.size;
    let (mut across, mut along, mut between) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    let (mut turn, mut rounded, mut left, mut weights, mut count) = (0.0, 0.0, 0.0, 0.0, 0);
    for other in search.around(sample.place.as_vec3(), LOOKED_AT) {
        let other = &samples[other as usize];
        let way = other.place - sample.place;
        let off = way.length_squared() / (reach * reach);
        if off > 1.0 || !alike(sample, other) {
            continue;
        }
        // Falls to zero where the reach ends, so that nothing jumps.
        let weight = (1.0 - off) * (1.0 - off);
        across += weight * way.reject_from_normalized(sample.along);
        along += weight * other.along * sample.along.dot(other.along).signum();
        between += weight * other.between;
        turn += weight * other.turn;
        rounded += weight * other.rounded;
        left += weight * other.left;
        weights += weight;
        count += 1;
    }
    // It counts itself, so there are weights.
    let kept = count > FEWEST || !few_go;
    kept.then(|| Sample {
        place: sample.place + across / weights,
        along: along.normalize_or(sample.along),
        between: between.normalize_or(sample.between),
        turn: turn / weights,
        rounded: rounded / weights,
        left: left / weights,
        doubtful: sample.doubtful,
        size: sample.size,
    })
}

/// Samples that lie apart, of each crowd the first.
fn thinned(samples: &[Sample]) -> Result<Vec<Sample>> {
    let search = search(samples)?;
    let (mut taken, mut covered) = (Vec::new(), vec![false; samples.len()]);
    for (n, sample) in samples.iter().enumerate() {
        if covered[n] {
            continue;
        }
        taken.push(*sample);
        for other in search.around(sample.place.as_vec3(), LOOKED_AT) {
            let near = samples[other as usize].place.distance(sample.place) < APART * sample.size;
            covered[other as usize] |= near && alike(sample, &samples[other as usize]);
        }
        covered[n] = true;
    }
    Ok(taken)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn doubtful_samples_go_where_one_beyond_doubt_runs_another_way() {
        let sure = Sample {
            place: DVec3::ZERO,
            along: DVec3::X,
            between: DVec3::Z,
            turn: 0.0,
            rounded: 0.0,
            left: 0.0,
            doubtful: false,
            size: 1.0,
        };
        let doubtful = |along: DVec3, x: f64| Sample { place: x * DVec3::X, along, doubtful: true, ..sure };
        let (on, across, beyond) =
            (doubtful(DVec3::X, 0.5), doubtful(DVec3::Y, 0.5), doubtful(DVec3::Y, 1.5));
        assert_eq!(beyond_doubt(vec![across, sure, on, beyond]).unwrap(), [sure, on, beyond]);
        assert_eq!(beyond_doubt(vec![across, on]).unwrap(), [across, on]);
    }
}
