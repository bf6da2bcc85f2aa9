//! Clip curves that cost less to tell than those fitted, as far as whoever fitted them says that they do.
//!
//! A line leaves a curve some room: within it, one that follows a curve told before takes a few bits, and
//! one in coarse steps takes fewer than one in fine steps.

use glam::{DVec2, DVec3};

use super::grid::{GRAINS, Grids, Size};
use super::lead::Guess;
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

/// A curve that strays from the fitted one by more than this share of the budget is not tried: both are
/// to lie within one budget outside the line.
const FARTHEST: f64 = 0.9;

/// Places along a curve where it is compared with the fitted one, and sides of that.
const COMPARED: (usize, usize) = (12, 48);

/// At most so many curves are tried for one.
const TRIED: usize = 24;

/// Puts cheaper clip curves in the place of those of splats that are on the file's grids, where they do.
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
    let mut curves: Vec<ClipCurve> =
        record.clips.iter().map(|clip| grids.clip_curve(clip, record.sizes)).collect();
    for n in 0..curves.len() {
        let fitted = curves[n];
        let mut will_do = |clip: &ClipRecord| {
            curves[n] = grids.clip_curve(clip, record.sizes);
            trial.will_do(&curves)
        };
        match cheaper(&record.clips[n], record.sizes, &speller, grids, &mut will_do) {
            Some(clip) => record.clips[n] = clip,
            None => curves[n] = fitted,
        }
    }
    record.clips.sort_unstable();
}

/// The cheapest of the curves that cost less than one, lie near it and will do; `None` if none is found.
fn cheaper(
    clip: &ClipRecord,
    sizes: [Size; 2],
    speller: &Speller<'_>,
    grids: &Grids,
    will_do: &mut dyn FnMut(&ClipRecord) -> bool,
) -> Option<ClipRecord> {
    let now = speller.cost(&speller.cheapest(clip)?);
    let fitted: Vec<DVec2> = grids.conic(clip, sizes).points(COMPARED.1).collect();
    let near = |other: &ClipRecord| strays(&grids.conic(other, sizes), &fitted) <= FARTHEST * grids.budget;
    let told = others(clip, speller).into_iter().map(|(told, guess)| (speller.cost(&told), told, guess));
    let mut told: Vec<_> = told.filter(|(cost, ..)| *cost < now).collect();
    told.sort_by_key(|(cost, ..)| *cost);
    let mut known = Vec::new();
    let meant = told.iter().filter_map(|(_, told, guess)| speller.meant_by(told, *guess).ok());
    let mut new = meant.filter(|other| {
        !known.contains(other) && {
            known.push(*other);
            near(other)
        }
    });
    new.by_ref().take(TRIED).find(|other| will_do(other))
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
}
