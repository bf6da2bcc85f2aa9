//! Sums up weighted samples.

use glam::DVec3;

use super::measures::{Angles, Distances};

/// Share of the weight that the 99th percentile does not pass.
const MOST: f64 = 0.99;

/// A sample: its value, and the area or length it stands for. Samples of no weight are looked at
/// for the largest value only.
pub(super) type Sample = (f64, f64);

/// Root mean square, 99th percentile (the least value that 99 % of the weight does not pass) and
/// largest; zeros without samples.
pub(super) fn distances(samples: &[Sample]) -> Distances {
    let total: f64 = samples.iter().map(|sample| sample.1).sum();
    let squares: f64 = samples.iter().map(|(value, weight)| weight * value * value).sum();
    let max = samples.iter().map(|sample| sample.0).fold(0.0, f64::max);
    if total <= 0.0 {
        return Distances { max, ..Distances::default() };
    }
    let mut sorted: Vec<Sample> = samples.iter().copied().filter(|sample| sample.1 > 0.0).collect();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut below = 0.0;
    let p99 = sorted.iter().find(|(_, weight)| {
        below += weight;
        below >= MOST * total
    });
    Distances { rms: (squares / total).sqrt(), p99: p99.map_or(max, |sample| sample.0), max, at: None }
}

/// The same of samples with their places, those of the largest found beside them uphill too: `at` is one of
/// them, in the units of the places.
pub(super) fn placed(samples: &[(DVec3, Sample)], top: Option<(DVec3, f64)>) -> Distances {
    let values: Vec<Sample> = samples.iter().map(|sample| sample.1).collect();
    let all = samples.iter().map(|&(at, (value, _))| (at, value)).chain(top);
    let found = distances(&values);
    all.reduce(larger).map_or(found, |(at, max)| Distances { max, at: Some(at.to_array()), ..found })
}

/// The larger of two values with their places; of equal ones the first.
pub(super) fn larger<P>(most: (P, f64), next: (P, f64)) -> (P, f64) {
    if next.1 > most.1 { next } else { most }
}

/// The same of angles in degrees.
pub(super) fn angles(samples: &[Sample]) -> Angles {
    let Distances { rms, p99, .. } = distances(samples);
    Angles { rms_deg: rms, p99_deg: p99 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_has_its_place() {
        let samples = [(DVec3::X, (2.0, 1.0)), (DVec3::Y, (3.0, 0.0)), (DVec3::Z, (3.0, 1.0))];
        let found = placed(&samples, None);
        assert_eq!((found.max, found.at), (3.0, Some([0.0, 1.0, 0.0])));
        let uphill = placed(&samples, Some((DVec3::ONE, 4.0)));
        assert_eq!((uphill.max, uphill.at, uphill.rms), (4.0, Some([1.0; 3]), found.rms));
        assert_eq!(placed(&[], None), Distances::default());
    }

    #[test]
    fn weights_count() {
        let mut samples: Vec<Sample> = (1..=100).map(|n| (f64::from(n), 1.0)).collect();
        samples.push((500.0, 0.0));
        let found = distances(&samples);
        assert!((found.p99 - 99.0).abs() < 1e-12 && (found.max - 500.0).abs() < 1e-12);
        assert!((found.rms - (338_350.0_f64 / 100.0).sqrt()).abs() < 1e-9);
        assert!((distances(&[(3.0, 1.0), (1.0, 3.0)]).rms - 3.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(distances(&[]), Distances::default());
    }
}
