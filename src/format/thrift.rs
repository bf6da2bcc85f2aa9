//! Other clip curves than those fitted, as far as whoever fitted them says that they do: that meet those of the next
//! splats without a step, and cost less to tell.
//!
//! A line leaves a curve some room: within it, one that follows a curve told before takes a few bits, and
//! one in coarse steps takes fewer than one in fine steps.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::grid::{GRAINS, Grids, Size, rho_steps};
use super::lead::{Form, Guess};
use super::order;
use super::predict::History;
use super::quantize::Quantizer;
use super::record::{ClipRecord, Record};
use super::spelling::{Speller, Spelling};
use crate::error::Result;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::polyline::nearest_on;
use crate::model::splat::Splat;
use crate::model::trial::Trial;
use crate::tolerance::STEP_SHARE;

/// A curve that strays from the fitted one by more than this share of the budget is not tried: both are
/// to lie within one budget outside the line.
const FARTHEST: f64 = 0.9;

/// Places along a curve where it is compared with the fitted one, and sides of that.
const COMPARED: (usize, usize) = (12, 48);

/// Of curves that leave steps alike but for this share of the budget the cheapest is taken.
const LEVEL: f64 = 0.5 * STEP_SHARE;

/// At most so many curves are tried for one.
const TRIED: usize = 24;

/// Puts other clip curves in the place of those of splats that are on the file's grids, where these do: that leave
/// less of a step, or cost less.
///
/// # Errors
/// As [`super::encode`], for splats that cannot be stored.
pub fn save(splats: &mut [Splat], max_error: f64, trial: &mut dyn Trial) -> Result<()> {
    let quantizer = Quantizer::new(max_error);
    let records = splats.iter().map(|splat| quantizer.record(splat)).collect::<Result<Vec<_>>>()?;
    let (records, order) = order::sorted(records);
    let mut history = History::default();
    for (mut record, index) in records.into_iter().zip(order) {
        if !record.clips.is_empty() {
            trial.turn_to(index as usize);
            thrifty(&mut record, &history, &quantizer.grids, trial);
            splats[index as usize] = quantizer.grids.splat(&record);
        }
        history.push(record, &quantizer.grids);
    }
    Ok(())
}

/// Changes the clip curves of one record, one by one.
fn thrifty(record: &mut Record, history: &History, grids: &Grids, trial: &mut dyn Trial) {
    let speller = Speller::new(record, history, grids);
    let all: Vec<ClipCurve> = record.clips.iter().map(|clip| grids.clip_curve(clip, record.sizes)).collect();
    let steps = trial.steps(&all);
    let mut curves = Curves { all, steps, sizes: record.sizes, grids, trial };
    for (n, clip) in record.clips.iter_mut().enumerate() {
        *clip = curves.better(n, clip, &speller).unwrap_or(*clip);
    }
    let Curves { all, .. } = curves;
    trial.take(all);
    record.clips.sort_unstable();
}

/// The clip curves of a splat, on trial.
struct Curves<'a> {
    all: Vec<ClipCurve>,
    /// By how much the outline steps at their ends: what comes next is to step by no more.
    steps: f64,
    sizes: [Size; 2],
    grids: &'a Grids,
    trial: &'a mut dyn Trial,
}

impl Curves<'_> {
    /// The curves with another in the place of one.
    fn with(&self, n: usize, clip: &ClipRecord) -> Vec<ClipCurve> {
        let mut curves = self.all.clone();
        curves[n] = self.grids.clip_curve(clip, self.sizes);
        curves
    }

    /// Puts one curve in the place of another if it will do; whether it did.
    fn change(&mut self, n: usize, clip: &ClipRecord) -> bool {
        let curves = self.with(n, clip);
        let will_do = self.trial.will_do(&curves);
        if will_do {
            (self.steps, self.all) = (self.trial.steps(&curves), curves);
        }
        will_do
    }

    /// Of the curves beside one that will do, the cheapest of those that leave the least of a step; `None` if none leaves
    /// less of one, and none that leaves no more costs less.
    fn better(&mut self, n: usize, clip: &ClipRecord, speller: &Speller<'_>) -> Option<ClipRecord> {
        let (grids, sizes) = (self.grids, self.sizes);
        let sides = match Form::of(clip) {
            Form::Straight => 1,
            Form::Corner => 2,
            Form::Curved => COMPARED.1,
        };
        let fitted: Vec<DVec2> = grids.conic(clip, sizes).points(sides).collect();
        let near =
            |other: &ClipRecord| strays(&grids.conic(other, sizes), &fitted) <= FARTHEST * grids.budget;
        let mut offers = self.offers(n, clip, speller)?;
        offers.sort_by_key(|&(level, cost, _)| (level, cost));
        let offers = offers.into_iter().map(|(.., other)| other).filter(near);
        offers.take(TRIED).find(|other| self.change(n, other))
    }

    /// Curves that leave less of a step than one, or cost less and leave no more: how much, what they cost, and they
    /// themselves. `None` for numbers that no curve of a file has.
    fn offers(
        &self,
        n: usize,
        clip: &ClipRecord,
        speller: &Speller<'_>,
    ) -> Option<Vec<(u64, u32, ClipRecord)>> {
        let (now, is_even) = (speller.cost(&speller.cheapest(clip)?), self.steps <= 0.0);
        let told = others(clip, speller).into_iter().map(|(told, guess)| (speller.cost(&told), told, guess));
        let mut told: Vec<_> = told.filter(|(cost, ..)| *cost < now || !is_even).collect();
        told.sort_by_key(|(cost, ..)| *cost);
        let (mut offers, mut known) = (Vec::new(), BTreeSet::new());
        for (cost, told, guess) in told {
            let other = speller.meant_by(&told, guess).ok().filter(|other| known.insert(*other));
            offers.extend(other.and_then(|other| Some((self.level(n, &other, cost < now)?, cost, other))));
        }
        if !is_even {
            let border = self.grids.border_steps(self.sizes[0]);
            for other in beside(clip, border).filter(|other| known.insert(*other)) {
                let cost = || Some(speller.cost(&speller.cheapest(&other)?));
                let level = self.level(n, &other, false);
                offers.extend(level.and_then(|level| Some((level, cost()?, other))));
            }
        }
        Some(offers)
    }

    /// How much of a step a curve leaves in the place of another, in [`LEVEL`]s; `None` if not less, or more where no
    /// more will do.
    fn level(&self, n: usize, clip: &ClipRecord, no_more_will_do: bool) -> Option<u64> {
        let steps = self.trial.steps(&self.with(n, clip));
        let is_offer = steps < self.steps || (no_more_will_do && steps <= self.steps);
        is_offer.then(|| (steps / (LEVEL * self.grids.budget)).ceil() as u64)
    }
}

/// How many steps, each a tenth of the budget at most, an end of a curve is moved either way where the outline steps: by
/// more than fitted curves may miss their lines few would do,
const ENDS_MOVED: i64 = 3;

/// and its control point, across the chord.
const CONTROL_MOVED: i64 = 2;

/// Curves of the same form whose ends and whose control point lie beside those of one, those next to it first.
fn beside(clip: &ClipRecord, border: u64) -> impl Iterator<Item = ClipRecord> {
    let clip = *clip;
    let form = Form::of(&clip);
    let most = if form == Form::Curved { CONTROL_MOVED } else { 0 };
    let ends = || -ENDS_MOVED..=ENDS_MOVED;
    let moves = ends().flat_map(|start| ends().map(move |end| [start, end]));
    let mut moves: Vec<[i64; 3]> =
        moves.flat_map(|[start, end]| (-most..=most).map(move |across| [start, end, across])).collect();
    moves.sort_by_key(|moved| moved.iter().map(|steps| steps.abs()).sum::<i64>());
    moves.into_iter().skip(1).filter_map(move |[start, end, across]| {
        let sweep = clip.sweep as i64 + end - start;
        let start = (clip.start as i64 + start).rem_euclid(border as i64);
        let control = [clip.control[0], clip.control[1] + across];
        let share = clip.rho as f64 / rho_steps(clip.control).max(1) as f64;
        let rho = if across == 0 { clip.rho } else { (share * rho_steps(control) as f64).round() as u64 };
        let moved = ClipRecord { rho, start: start as u64, sweep: sweep as u64, control };
        ((1..border as i64).contains(&sweep) && Form::of(&moved) == form).then_some(moved)
    })
}

/// Ways to tell curves of the same form that lie no farther from one than steps are long, or that take
/// from another what that tells.
fn others(clip: &ClipRecord, speller: &Speller<'_>) -> Vec<(Spelling, Option<Guess>)> {
    let alone = std::iter::once((None, None));
    let led = speller.near(clip).into_iter().map(|(led, guess)| (Some(led), Some(guess)));
    let mut found = Vec::new();
    for (led, guess) in alone.chain(led) {
        for grain in 0..GRAINS {
            let near = speller.rounded(clip, led, guess, grain);
            found.extend(simpler(&near).map(|told| (told, guess)));
        }
    }
    found
}

/// A spelling, and others with zeros in the place of some of its numbers, which are not zero.
fn simpler(near: &Spelling) -> impl Iterator<Item = Spelling> {
    let near = *near;
    let ends = if near.led.is_some() { &ENDS[..] } else { &ENDS[..1] };
    ends.iter().flat_map(move |ends| {
        let rest = REST.iter().map(move |rest| (ends, rest));
        rest.filter_map(move |([start, end], [along, across, rho])| {
            let numbers = [near.ends[0], near.ends[1], near.control[0], near.control[1], near.rho];
            let kept = [start, end, along, across, rho];
            let new = numbers.iter().zip(kept).all(|(number, kept)| *kept || *number != 0);
            let [start, end, along, across, rho] =
                [0, 1, 2, 3, 4].map(|n| if *kept[n] { numbers[n] } else { 0 });
            new.then_some(Spelling { ends: [start, end], control: [along, across], rho, ..near })
        })
    })
}

/// Which ends keep their numbers,
const ENDS: [[bool; 2]; 4] = [[true, true], [false, true], [true, false], [false, false]];

/// and which of control point and shape do.
const REST: [[bool; 3]; 5] = [
    [true, true, true],
    [true, true, false],
    [false, true, true],
    [false, true, false],
    [false, false, false],
];

/// How far the farthest of some places of a curve lies from a polyline.
fn strays(curve: &Conic, line: &[DVec2]) -> f64 {
    let to_side = |p: DVec3, side: &[DVec2]| {
        nearest_on(side[0].extend(0.0), side[1].extend(0.0), p).distance_squared(p)
    };
    let distance =
        |p: DVec2| line.windows(2).map(|side| to_side(p.extend(0.0), side)).fold(f64::INFINITY, f64::min);
    curve.points(COMPARED.0).map(distance).fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::format::encode;
    use crate::format::planted::{Random, bumpy_asset, curve};
    use crate::model::asset::Asset;

    /// Lets curves lie off the fitted ones by so many budgets at most.
    struct Within {
        fitted: Vec<Splat>,
        at: usize,
        most: f64,
    }

    impl Trial for Within {
        fn turn_to(&mut self, splat: usize) {
            self.at = splat;
        }

        fn will_do(&mut self, clips: &[ClipCurve]) -> bool {
            let splat = &self.fitted[self.at];
            let lines: Vec<Vec<DVec2>> =
                splat.clips.iter().map(|clip| clip.conic(splat.radii).points(400).collect()).collect();
            clips.len() == lines.len()
                && clips
                    .iter()
                    .all(|clip| lines.iter().any(|line| strays(&clip.conic(splat.radii), line) <= self.most))
        }

        fn steps(&self, _: &[ClipCurve]) -> f64 {
            0.0
        }

        fn take(&mut self, _: Vec<ClipCurve>) {}
    }

    fn planted() -> Asset {
        let (mut asset, mut random) = (bumpy_asset(80, 25.0, 5), Random(8));
        for splat in &mut asset.splats {
            splat.clips = vec![curve(splat.radii, &mut random)];
        }
        crate::format::snap(&asset).unwrap()
    }

    #[test]
    fn files_are_smaller_for_curves_that_lie_as_near_as_they_must() {
        let asset = planted();
        let before = encode(&asset).unwrap().len();
        let mut after = Vec::new();
        for most in [0.0, 0.3, 0.8] {
            let mut splats = asset.splats.clone();
            let most = most * asset.max_error;
            let mut trial = Within { fitted: splats.clone(), at: 0, most };
            save(&mut splats, asset.max_error, &mut trial).unwrap();
            let saved = Asset { splats, ..asset.clone() };
            assert!((0..80).all(|n| {
                trial.turn_to(n);
                trial.will_do(&saved.splats[n].clips) || saved.splats[n].clips == asset.splats[n].clips
            }));
            after.push(encode(&saved).unwrap().len());
        }
        assert!(after[0] <= before && after[1] < before && after[2] < after[1], "{after:?} for {before}");
    }

    /// Says that the outline steps by as much as the first end lies from where it was to be, whatever else.
    struct Even {
        to: Vec<f64>,
        at: usize,
    }

    impl Trial for Even {
        fn turn_to(&mut self, splat: usize) {
            self.at = splat;
        }

        fn steps(&self, clips: &[ClipCurve]) -> f64 {
            (clips[0].alpha1 - self.to[self.at]).abs()
        }

        fn will_do(&mut self, _: &[ClipCurve]) -> bool {
            true
        }

        fn take(&mut self, _: Vec<ClipCurve>) {}
    }

    #[test]
    fn curves_leave_less_of_a_step_whatever_that_costs() {
        let asset = planted();
        let step = |splat: &Splat| 0.1 * asset.max_error / splat.radii.max_element();
        let to = |splat: &Splat| splat.clips.first().map_or(0.0, |clip| clip.alpha1 + step(splat));
        let mut trial = Even { to: asset.splats.iter().map(to).collect(), at: 0 };
        let mut splats = asset.splats.clone();
        save(&mut splats, asset.max_error, &mut trial).unwrap();
        let mut nearer = 0;
        for (n, (splat, before)) in splats.iter().zip(&asset.splats).enumerate() {
            trial.turn_to(n);
            if !splat.clips.is_empty() {
                assert!(trial.steps(&splat.clips) <= trial.steps(&before.clips) + 1e-12, "splat {n}");
                nearer += usize::from(trial.steps(&splat.clips) < 0.6 * step(before));
            }
        }
        assert!(nearer > 60, "{nearer} of 80");
    }
}
