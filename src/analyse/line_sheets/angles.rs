//! The ways, seen along a line, into which sheets of a surface go from it: where the angles of points crowd.

use std::f64::consts::TAU;

/// Angles farther apart than this (25°) belong to different sheets.
pub const SEPARATE: f64 = 0.436;

/// Votes count as of one angle within this (10°).
const WITHIN: f64 = 0.175;

/// An angle that has less than this share of the votes of one nearby is that of strays. Of two sheets 60°
/// apart whose votes scatter by 10° the angle between has a twentieth.
const STRAYS: f64 = 0.25;

/// Angles are nearby within this (45°).
const NEARBY: f64 = 0.785;

/// Over no more than this (15°) two sheets may lie apart, too, if where the gap is an angle has less than that share
/// of the votes of some on both sides, nearby...
const NARROWEST: f64 = 0.262;

/// ... and those have at least so many: where all point alike to all sides, no gap is as wide by chance.
const CROWD: usize = 8;

/// Angles spread over more than this (100°) are no sheet but a blob, or a surface that
/// the line floats above.
const SPREAD: f64 = 1.745;

/// Fewer votes than this are no sheet.
const FEWEST: usize = 3;

/// An angle, radians, and the point that has it.
pub type Vote = (f64, u32);

/// The points of each sheet, in the order of their angle, of votes sorted by that.
pub fn sheets(votes: &[Vote]) -> Vec<Vec<u32>> {
    let gathered = Circle::of(votes).gathered();
    Circle::of(&gathered).clusters()
}

/// Votes sorted by angle, the first of which follows the last.
struct Circle<'a> {
    votes: &'a [Vote],
    /// How many votes are within [`WITHIN`] of each, itself among them.
    crowd: Vec<usize>,
}

impl<'a> Circle<'a> {
    fn of(votes: &'a [Vote]) -> Self {
        let mut circle = Self { votes, crowd: Vec::new() };
        circle.crowd = (0..votes.len()).map(|n| circle.around(n, WITHIN).count()).collect();
        circle
    }

    /// Those whose way many point: beside them a few are strays of the noise, which would join two sheets.
    fn gathered(&self) -> Vec<Vote> {
        let is_stray = |n: usize| {
            let most = self.around(n, NEARBY).map(|other| self.crowd[other]).max().unwrap_or_default();
            (self.crowd[n] as f64) < STRAYS * most as f64
        };
        (0..self.votes.len()).filter(|&n| !is_stray(n)).map(|n| self.votes[n]).collect()
    }

    /// Those within `reach` of one, itself among them.
    fn around(&self, n: usize, reach: f64) -> impl Iterator<Item = usize> + '_ {
        let near = move |&other: &usize| self.apart(n, other) <= reach;
        let (after, before) = (self.from(n).take_while(near), self.back_from(n).skip(1).take_while(near));
        // Where all are near, the walks both ways meet.
        after.chain(before).take(self.votes.len())
    }

    /// One and all that follow.
    fn from(&self, n: usize) -> impl Iterator<Item = usize> + use<> {
        let count = self.votes.len();
        (0..count).map(move |step| (n + step) % count)
    }

    /// One and all before it.
    fn back_from(&self, n: usize) -> impl Iterator<Item = usize> + use<> {
        let count = self.votes.len();
        (0..count).map(move |step| (n + count - step) % count)
    }

    /// The angle between two, the lesser way.
    fn apart(&self, a: usize, b: usize) -> f64 {
        let apart = (self.votes[a].0 - self.votes[b].0).abs();
        apart.min(TAU - apart)
    }

    /// How far the next one is from one of them.
    fn gap(&self, n: usize) -> f64 {
        let count = self.votes.len();
        let step = self.votes[(n + 1) % count].0 - self.votes[n].0;
        if n + 1 == count { step + TAU } else { step }
    }

    /// Whether few point between one of them and the next, and many on both sides of that.
    fn is_valley(&self, n: usize) -> bool {
        let half = 0.5 * self.gap(n);
        if 2.0 * half <= NARROWEST {
            return false;
        }
        let next = (n + 1) % self.votes.len();
        let [before, after] = [self.side(self.back_from(n), half), self.side(self.from(next), half)];
        let least = before.1.min(after.1);
        least >= CROWD && ((before.0 + after.0) as f64) < STRAYS * least as f64
    }

    /// Of those on one side of a place, the first so far off, how many are within [`WITHIN`] of that, and the largest
    /// crowd nearby.
    fn side(&self, mut of: impl Iterator<Item = usize>, first_off: f64) -> (usize, usize) {
        let Some(first) = of.next() else { return (0, 0) };
        let all = std::iter::once(first).chain(of).map(|n| (n, first_off + self.apart(first, n)));
        all.take_while(|&(_, off)| off <= NEARBY).fold((0, 0), |(near, most), (n, off)| {
            (near + usize::from(off <= WITHIN), most.max(self.crowd[n]))
        })
    }

    /// Splits them where two neighbours lie far apart, or few between two crowds.
    fn clusters(&self) -> Vec<Vec<u32>> {
        let count = self.votes.len();
        let breaks: Vec<usize> =
            (0..count).filter(|&n| self.gap(n) > SEPARATE || self.is_valley(n)).collect();
        let mut found = Vec::new();
        for (k, &end) in breaks.iter().enumerate() {
            // From behind the break before this one, round the circle, to this one.
            let start = breaks[(k + breaks.len() - 1) % breaks.len()] + 1;
            let length = (end + count - start) % count + 1;
            let spread: f64 = (0..length - 1).map(|n| self.gap((start + n) % count)).sum();
            if length >= FEWEST && spread <= SPREAD {
                found.push((0..length).map(|n| self.votes[(start + n) % count].1).collect());
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::planted::{normal, random};

    /// So many votes in each of some directions, degrees, that scatter.
    fn votes(directions: &[f64], each: u64, scatter: f64) -> Vec<Vote> {
        let all = (0..directions.len() as u64 * each).map(|n| {
            let way = directions[n as usize % directions.len()] + scatter * normal(n);
            ((way.to_radians() + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU, n as u32)
        });
        let mut all: Vec<Vote> = all.collect();
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    #[test]
    fn sheets_that_noise_leaves_no_wide_gap_between_are_two() {
        for turn in (0..360).step_by(10).map(f64::from) {
            let found = sheets(&votes(&[turn - 26.0, turn + 26.0], 40, 8.5));
            assert_eq!(found.len(), 2, "around {turn}°");
            let of_first = |points: &[u32]| points.iter().filter(|&&point| point % 2 == 0).count();
            let mixed = |points: &Vec<u32>| of_first(points).min(points.len() - of_first(points));
            assert!(found.iter().all(|points| mixed(points) <= 2 && points.len() >= 35), "around {turn}°");
        }
    }

    #[test]
    fn one_sheet_and_what_goes_all_around_are_not_split() {
        for scatter in [0.0, 1.0, 4.0, 8.0] {
            for each in [4, 12, 40, 160] {
                assert_eq!(sheets(&votes(&[170.0], each, scatter)).len(), 1, "{each} within {scatter}°");
            }
        }
        for count in [48, 192, 768] {
            let mut all: Vec<Vote> = (0..count).map(|n| (0.5 * TAU * random(n), n as u32)).collect();
            all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!(sheets(&all), Vec::<Vec<u32>>::new(), "of {count} all around");
        }
    }
}
