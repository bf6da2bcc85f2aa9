//! What lines do where splats are cut along them: how often each case comes up that no single conic follows,
//! so that it takes several, or smaller splats.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::candidates::Regions;
use super::cover::Cover;
use super::grow::Grower;
use super::outline::Outline;
use super::settle::Candidate;
use crate::analyse::surface::{NONE, Surface};
use crate::fit::clip::Clips;
use crate::fit::ellipse::{Run, runs};
use crate::fit::offset::turns_sharply;
use crate::model::polyline::nearest_on;

/// Splats by what the lines and borders do that run through their ellipses, and places by what meets there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EdgeCases {
    /// Splats through which more than one line runs.
    pub several_lines: u64,
    /// Splats through which a line runs that bends both ways, by more than it may be missed by.
    pub inflections: u64,
    /// Splats with a corner of a line, of more than 15 degrees.
    pub corners: u64,
    /// Those of them with a corner of which an arm is curved.
    pub curved_arms: u64,
    /// Splats in which a closed line lies whole.
    pub loops: u64,
    /// Splats that are cut by more than one curve.
    pub several_curves: u64,
    /// Places inside the surface where a line ends.
    pub line_ends: u64,
    /// Places where more than two lines or borders meet, by how many.
    pub meetings: Vec<Meeting>,
}

/// Places where as many lines or borders meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Meeting {
    /// How many meet, 3 or more.
    pub lines: u64,
    /// How many such places there are.
    pub places: u64,
}

/// What the runs of lines through one splat do.
#[derive(Clone, Copy, Default)]
struct Within {
    several_lines: bool,
    inflection: bool,
    corner: bool,
    curved_arm: bool,
    looped: bool,
    several_curves: bool,
}

impl Cover {
    /// Counts the cases of the chosen splats, last resorts aside, which are cut to one piece.
    #[must_use]
    pub fn edge_cases(&self, grower: &Grower, regions: &Regions) -> EdgeCases {
        let splats = self.chosen.par_iter().map(|&index| within(&self.candidates[index], grower, regions));
        let splats: Vec<Within> = splats.collect();
        let count = |is: fn(&Within) -> bool| splats.iter().filter(|within| is(within)).count() as u64;
        EdgeCases {
            several_lines: count(|within| within.several_lines),
            inflections: count(|within| within.inflection),
            corners: count(|within| within.corner),
            curved_arms: count(|within| within.curved_arm),
            loops: count(|within| within.looped),
            several_curves: count(|within| within.several_curves),
            ..meetings(grower.surface)
        }
    }
}

/// Line ends, and places where more than two lines meet.
fn meetings(surface: &Surface) -> EdgeCases {
    let sides = (0..surface.points.len() as u32).flat_map(|from| {
        let to = surface.border_next[from as usize];
        let is_line = to != NONE && !surface.is_carried(from);
        let place = |point: u32| surface.places[point as usize];
        is_line.then(|| [(place(from), place(to)), (place(to), place(from))]).into_iter().flatten()
    });
    let mut sides: Vec<(u32, u32)> = sides.collect();
    sides.par_sort_unstable();
    sides.dedup();
    let mut cases = EdgeCases::default();
    let mut places = BTreeMap::<u64, u64>::new();
    for lines in sides.chunk_by(|a, b| a.0 == b.0) {
        match lines.len() {
            1 => cases.line_ends += 1,
            2 => {}
            many => *places.entry(many as u64).or_default() += 1,
        }
    }
    cases.meetings = places.into_iter().map(|(lines, places)| Meeting { lines, places }).collect();
    cases
}

fn within(candidate: &Candidate, grower: &Grower, regions: &Regions) -> Within {
    let (splat, tolerance) = (&candidate.splat, &grower.budget.clip);
    let Some(outlines) = regions.with(|region| candidate.outlines(grower, region)) else {
        return Within::default();
    };
    let several_curves = splat.clips.len() > 1 && tolerance.clips != Clips::Partners;
    Within { several_curves, ..cases_of(&outlines, splat.radii, tolerance.edge) }
}

/// What lines do inside an ellipse; bends of less than `tolerance` are none.
fn cases_of(outlines: &[Outline], radii: DVec2, tolerance: f64) -> Within {
    let all: Vec<Run> = outlines
        .iter()
        .filter_map(|outline| runs(&outline.points, outline.closed, radii))
        .flatten()
        .collect();
    let mut within = Within { several_lines: all.len() > 1, ..Within::default() };
    for run in &all {
        within.looped |= run.closed;
        let arms = arms(run);
        let cornered = arms.len() > 1;
        within.corner |= cornered;
        for arm in &arms {
            let [left, right] = bends(arm);
            within.curved_arm |= cornered && left.max(right) > tolerance;
            within.inflection |= left.min(right) > tolerance;
        }
    }
    within
}

/// A run in parts, from corner to corner.
fn arms(run: &Run) -> Vec<Vec<DVec2>> {
    let mut points = run.points.clone();
    if run.closed {
        points.extend_from_within(..1);
    }
    let mut arms = vec![points[..1].to_vec()];
    for (n, &point) in points.iter().enumerate().skip(1) {
        let last = arms.len() - 1;
        arms[last].push(point);
        if let Some(&after) = points.get(n + 1) {
            let [before, after] = [point - points[n - 1], after - point].map(DVec2::normalize_or_zero);
            if turns_sharply(before, after) {
                arms.push(vec![point]);
            }
        }
    }
    arms
}

/// How far a polyline bends to the left and to the right of its chord.
fn bends(arm: &[DVec2]) -> [f64; 2] {
    let (Some(&from), Some(&to)) = (arm.first(), arm.last()) else { return [0.0; 2] };
    let mut bends = [0.0_f64; 2];
    for &point in arm {
        let off = nearest_on(from.extend(0.0), to.extend(0.0), point.extend(0.0)).truncate().distance(point);
        let side = usize::from((to - from).perp_dot(point - from) < 0.0);
        bends[side] = bends[side].max(off);
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADII: DVec2 = DVec2::new(2.0, 1.0);

    fn line(points: &[(f64, f64)], closed: bool) -> Outline {
        let points: Vec<DVec2> = points.iter().copied().map(DVec2::from).collect();
        Outline { heights: vec![0.0; points.len()], points, closed, ends: false }
    }

    fn of(outlines: &[Outline]) -> [bool; 5] {
        let within = cases_of(outlines, RADII, 0.01);
        [within.several_lines, within.inflection, within.corner, within.curved_arm, within.looped]
    }

    #[test]
    fn each_case_is_told_from_the_others() {
        let straight = line(&[(-3.0, 0.1), (0.0, 0.1), (3.0, 0.1)], false);
        assert_eq!(of(std::slice::from_ref(&straight)), [false; 5]);
        let beyond = line(&[(-3.0, 2.0), (3.0, 2.0)], false);
        assert_eq!(of(&[straight.clone(), beyond]), [false; 5]);
        let other = line(&[(3.0, -0.5), (-3.0, -0.5)], false);
        assert_eq!(of(&[straight, other]), [true, false, false, false, false]);
        let wave: Vec<(f64, f64)> =
            (-30..=30).map(|n| f64::from(n) / 10.0).map(|x| (x, 0.2 * libm::sin(2.0 * x))).collect();
        assert_eq!(of(&[line(&wave, false)]), [false, true, false, false, false]);
        let corner = line(&[(-3.0, 0.0), (0.0, 0.0), (1.0, -2.0)], false);
        assert_eq!(of(&[corner]), [false, false, true, false, false]);
        let arm = (0..=20).map(|n| f64::from(n) / 10.0).map(|x| (x, -x - 0.2 * x * x));
        let curved: Vec<(f64, f64)> = std::iter::once((-3.0, 0.0)).chain(arm).collect();
        assert_eq!(of(&[line(&curved, false)]), [false, false, true, true, false]);
        let round: Vec<(f64, f64)> = (0..60)
            .map(|n| f64::from(n) * std::f64::consts::TAU / 60.0)
            .map(|turn| (0.3 * libm::cos(turn), 0.3 * libm::sin(turn)))
            .collect();
        assert!(of(&[line(&round, true)])[4]);
    }
}
