//! Steps in the outline of a surface, where the clip curve of one splat ends beside that of the next
//! ([`curve_ends`](crate::model::curve_ends)).

use glam::DVec2;

use crate::analyse::surface::Rows;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::curve_ends::{End, beyond, ends, over, step};
use crate::model::neighbours::neighbours_up_to;
use crate::model::splat::Splat;
use crate::tolerance::STEP_SHARE;

/// Splats whose clip curves end beside those of others, of which one is at hand.
pub(super) struct Steps {
    splats: Vec<Cut>,
    /// For each splat those that it may meet.
    near: Rows,
    max_error: f64,
    at: usize,
    /// The ends of others' curves that lie over the splat at hand.
    ends: Vec<Over>,
}

/// A splat and its curves, worked out.
struct Cut {
    splat: Splat,
    conics: Vec<Conic>,
}

/// An end of another splat's curve over the splat at hand.
struct Over {
    /// In the plane of the splat at hand.
    uv: DVec2,
    /// By how much the outline steps there if the splat at hand is left out.
    step: f64,
}

/// Splats may meet so many others on average: in heaps of more, which no surface makes, the work for every curve grows
/// with the square of that.
const CROWDED: usize = 500;

impl Steps {
    /// Those of splats under a bound; `None` where these lie in heaps.
    pub(super) fn new(splats: &[Splat], max_error: f64) -> Option<Self> {
        let most = CROWDED * splats.len() / 2;
        let pairs = neighbours_up_to(splats, most)?.into_iter().flat_map(|[a, b]| [(a, b), (b, a)]).collect();
        let near = Rows::from_pairs(splats.len(), pairs);
        let splats = splats.iter().cloned().map(Cut::new).collect();
        Some(Self { splats, near, max_error, at: 0, ends: Vec::new() })
    }

    /// What follows is about this splat.
    pub(super) fn turn_to(&mut self, index: usize) {
        let others = self.near.row(index as u32);
        let of = |&other: &u32| {
            let Cut { splat, conics } = &self.splats[other as usize];
            ends(splat, conics).map(move |end| (other, end))
        };
        let over = |(other, end): (u32, End)| {
            let uv = over(&self.splats[index].splat, &end, self.max_error)?;
            Some(Over { uv, step: self.step(other, Some(index), &end) })
        };
        (self.ends, self.at) = (others.iter().flat_map(of).filter_map(over).collect(), index);
    }

    /// By how much the outline would step, in sum, at the ends of the curves of the splat at hand and at those of
    /// others over it, if these were its curves: what goes beyond [`STEP_SHARE`] of the bound.
    pub(super) fn sum(&self, clips: &[ClipCurve]) -> f64 {
        let Cut { splat, .. } = &self.splats[self.at];
        let conics: Vec<Conic> = clips.iter().map(|clip| clip.conic(splat.radii)).collect();
        let own = ends(splat, &conics).map(|end| self.step(self.at as u32, None, &end));
        let others = self.ends.iter().map(|end| end.step.min(beyond(&conics, end.uv)));
        own.chain(others).map(|step| (step - STEP_SHARE * self.max_error).max(0.0)).sum()
    }

    /// The splat at hand is cut by these from now on.
    pub(super) fn take(&mut self, clips: Vec<ClipCurve>) {
        self.splats[self.at] = Cut::new(Splat { clips, ..self.splats[self.at].splat.clone() });
    }

    /// By how much the outline steps at the end of one splat's curve: how far inside it the outermost of the
    /// neighbours' curves passes there; a whole bound where no neighbour is.
    fn step(&self, splat: u32, left_out: Option<usize>, end: &End) -> f64 {
        let others = self.near.row(splat).iter().map(|&other| other as usize);
        let others = others.filter(|&other| Some(other) != left_out).map(|other| &self.splats[other]);
        let others = others.map(|Cut { splat, conics }| (splat, conics.as_slice()));
        step(end, others, self.max_error).map_or(self.max_error, |step| step.min(self.max_error))
    }
}

impl Cut {
    fn new(splat: Splat) -> Self {
        let conics = splat.conics();
        Self { splat, conics }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::f64::consts::PI;

    use glam::DVec3;

    use super::*;
    use crate::sample::cover::tests::candidate;

    const BOUND: f64 = 0.1;

    /// What an end beside nothing counts.
    const ALONE: f64 = 1.0 - STEP_SHARE;

    /// A disc of radius 1 around a place of the x axis, cut by a chord along y = 0.1, so many bounds farther out at
    /// its left end and at its right.
    fn disc(x: f64, [left, right]: [f64; 2]) -> Splat {
        let mut splat = candidate(&[]).splat;
        (splat.center, splat.radii) = (x * DVec3::X, DVec2::ONE);
        let angle = |out: f64| libm::asin(0.1 + out * BOUND);
        splat.clips = vec![ClipCurve::chord(angle(right), PI - angle(left))];
        assert!(!splat.covers(0.9 * DVec2::Y) && splat.covers(-0.9 * DVec2::Y));
        splat
    }

    /// The sums of splats with the curves they have, in bounds.
    fn sums(splats: &[Splat]) -> Vec<f64> {
        let mut steps = Steps::new(splats, BOUND).unwrap();
        let sum = |index: usize| {
            steps.turn_to(index);
            steps.sum(&splats[index].clips) / BOUND
        };
        (0..splats.len()).map(sum).collect()
    }

    #[test]
    fn curves_step_where_the_farther_out_ends_and_not_where_they_cross() {
        let near = |found: &[f64], sum: f64| found.iter().all(|found| (found - sum).abs() < 1e-6);
        let level = sums(&[disc(0.0, [0.0; 2]), disc(1.0, [0.0; 2])]);
        assert!(near(&level, ALONE), "one line: {level:?}");
        let apart = sums(&[disc(0.0, [0.0; 2]), disc(1.0, [0.5; 2])]);
        assert!(near(&apart, ALONE + 0.5 - STEP_SHARE), "{apart:?}");
        let crossing = sums(&[disc(0.0, [0.4, 0.0]), disc(1.0, [0.0, 0.4])]);
        assert!(near(&crossing, ALONE), "{crossing:?}");
    }

    #[test]
    fn splats_in_heaps_are_let_be() {
        let heap = |count: usize| Steps::new(&vec![disc(0.0, [0.0; 2]); count], BOUND);
        assert!(heap(CROWDED + 1).is_some() && heap(CROWDED + 2).is_none());
    }

    #[test]
    fn what_is_taken_counts_for_the_next() {
        let splats = [disc(0.0, [0.0; 2]), disc(1.0, [0.5; 2])];
        let mut steps = Steps::new(&splats, BOUND).unwrap();
        let level = disc(1.0, [0.0; 2]).clips;
        steps.turn_to(1);
        let after = steps.sum(&level);
        assert!(after < steps.sum(&splats[1].clips));
        steps.take(level);
        steps.turn_to(0);
        assert!((steps.sum(&splats[0].clips) - after).abs() < 1e-9);
    }

    #[test]
    fn an_end_that_another_curve_of_the_splat_cuts_away_is_none() {
        let mut corner = disc(0.0, [0.0; 2]);
        assert!((sums(&[corner.clone()])[0] - 2.0 * ALONE).abs() < 1e-9);
        // What lies to the right goes too, and with it one end of either.
        corner.clips.push(ClipCurve::chord(-1.5, 1.5));
        assert!((sums(&[corner])[0] - 2.0 * ALONE).abs() < 1e-9);
    }
}
