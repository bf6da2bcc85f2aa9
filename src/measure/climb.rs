//! From the worst samples uphill to the largest distance.
//!
//! Samples by area miss the very top of a distance by some percent, since it is large over a
//! small place only. From the worst samples, far enough from each other, a pattern search
//! (Hooke and Jeeves 1961) goes on to the top beside each.

use glam::DVec3;
use rayon::prelude::*;

use super::spread::larger;

/// Places from which the search starts.
const STARTS: usize = 64;

/// The worst samples among which starts are chosen.
const WORST: usize = 4096;

/// Starts lie this many steps apart.
const APART: f64 = 3.0;

/// The search ends when its step has been halved so many times: a distance whose top is round
/// is then known to a thousandth of what the samples miss.
const HALVINGS: usize = 5;

/// Moves without which no search ends; a climb is as long as a few distances of samples.
const MOST_MOVES: usize = 40;

/// The numbers of the worst samples, the worst first, each some steps from those before.
pub(super) fn starts(samples: &[(DVec3, f64)], step: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    let worst = |a: &usize, b: &usize| samples[*b].1.total_cmp(&samples[*a].1).then(a.cmp(b));
    if order.len() > WORST {
        order.select_nth_unstable_by(WORST, worst);
        order.truncate(WORST);
    }
    order.sort_unstable_by(worst);
    let mut chosen: Vec<usize> = Vec::with_capacity(STARTS);
    for n in order {
        let apart = |other: &usize| samples[*other].0.distance(samples[n].0) >= APART * step;
        if chosen.len() < STARTS && chosen.iter().all(apart) {
            chosen.push(n);
        }
    }
    chosen
}

/// The largest value found uphill from any of some places, given with their values, and where; `None` of none.
///
/// `around` lists places about a step from one; `value` measures a place.
pub(super) fn highest<P: Copy + Send + Sync, I: Iterator<Item = P>>(
    from: &[(P, f64)],
    step: f64,
    around: impl Fn(P, f64) -> I + Sync,
    value: impl Fn(P) -> Option<f64> + Sync,
) -> Option<(P, f64)> {
    let tops = from.par_iter().map(|&(start, height)| {
        let (mut at, mut top, mut step, mut halvings) = (start, height, step, 0);
        for _ in 0..MOST_MOVES {
            let places = around(at, step).filter_map(|place| Some((place, value(place)?)));
            match places.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|found| found.1 > top) {
                Some(found) => (at, top) = found,
                None if halvings == HALVINGS => break,
                None => (step, halvings) = (0.5 * step, halvings + 1),
            }
        }
        (at, top)
    });
    tops.reduce_with(larger)
}

/// Steps towards the faces, edges and corners of a cube, of a length along each axis.
pub(super) fn around(at: DVec3, step: f64) -> impl Iterator<Item = DVec3> {
    let side = [-1.0, 0.0, 1.0];
    let all = side.into_iter().flat_map(move |x| side.into_iter().map(move |y| (x, y)));
    let all = all.flat_map(move |(x, y)| side.into_iter().map(move |z| DVec3::new(x, y, z)));
    all.filter(|way| *way != DVec3::ZERO).map(move |way| at + step * way)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn the_top_between_samples_is_found() {
        let top = DVec3::new(0.337, -0.213, 0.0);
        let value = |p: DVec3| Some(2.0 - (p - top).length_squared());
        let samples: Vec<(DVec3, f64)> = (0..400)
            .map(|n| DVec3::new(f64::from(n % 20) / 10.0 - 1.0, f64::from(n / 20) / 10.0 - 1.0, 0.0))
            .map(|p| (p, value(p).unwrap_or_default()))
            .collect();
        let chosen = starts(&samples, 0.1);
        assert!(chosen.len() > 10 && samples[chosen[0]].1 < 1.9995);
        let from: Vec<(DVec3, f64)> = chosen.iter().map(|&n| samples[n]).collect();
        let flat = |at, step| around(at, step).map(|p: DVec3| p.with_z(0.0));
        let (at, height) = highest(&from, 0.1, flat, value).unwrap();
        assert!(height > 2.0 - 1e-4 && value(at) == Some(height));
        let (_, height) = highest(&from, 0.1, |_, _| std::iter::empty(), value).unwrap();
        assert!(height < 1.9995, "without a step, no gain");
        assert_eq!(highest(&[], 0.1, flat, value), None);
    }
}
