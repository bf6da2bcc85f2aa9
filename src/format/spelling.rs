//! How a clip curve is told: by itself, or by how far it is from one that it follows.

use std::cell::{OnceCell, RefCell};

use super::grid::{CONTROL_LIMIT, GRAINS, Grids, rho_steps, unit};
use super::lead::{Form, Guess, Lead, guess};
use super::predict::History;
use super::record::{ClipRecord, Record};
use super::symbol::zigzag;
use crate::error::{Error, Result};
use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;

/// An encoder looks for the curve that one follows among so many that pass nearest to its splat.
const LOOKED_AT: u64 = 32;

/// A curve whose ends lie more than so many budgets from where another's would is told no shorter by that.
const FARTHEST: f64 = 24.0;

/// Which curve one follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Led {
    /// Whether that is one of the other side of the line.
    pub across: bool,
    /// How many that cross the splat, taken so, pass nearer to its centre.
    pub rank: u64,
}

/// The numbers of one clip curve as the file holds them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spelling {
    /// The curve it follows, if it does.
    pub led: Option<Led>,
    /// The numbers below count in [`unit`]s of this.
    pub grain: u8,
    /// What it is.
    pub form: Form,
    /// `P1` and `P3`: their differences from the guess, or `start` and `sweep` less one unit.
    pub ends: [i64; 2],
    /// `P2`: its difference from the guess, or from the chord's middle.
    pub control: [i64; 2],
    /// The shape: its difference from the guess, or from that of a circle.
    pub rho: i64,
}

impl Spelling {
    /// About how many bits it takes: enough to weigh one against another.
    fn cost(&self, border: u64) -> u32 {
        let length = |number: u64| 64 - number.leading_zeros();
        let near = |off: i64| 1 + 2 * length(zigzag(off));
        let far = |off: i64| 3 + length(zigzag(off));
        let ends = match self.led {
            None => 4 + 2 * length(border / unit(self.grain)),
            Some(led) => 2 + 2 * length(led.rank) + self.ends.map(near).iter().sum::<u32>(),
        };
        let control = if self.led.is_none() { self.control.map(far) } else { self.control.map(near) };
        let grain = u32::from(self.grain);
        match self.form {
            Form::Straight => grain + ends,
            Form::Corner => grain + ends + control.iter().sum::<u32>(),
            Form::Curved => grain + ends + control.iter().sum::<u32>() + near(self.rho),
        }
    }
}

/// Tells the clip curves of one splat.
pub struct Speller<'a> {
    grids: &'a Grids,
    history: &'a History,
    sizes: [u16; 2],
    /// Without its clip curves.
    splat: Splat,
    leads: OnceCell<Vec<&'a Lead>>,
    /// For each form and side, what is known of the curves before it that cross the splat.
    crossings: RefCell<[Crossings; 6]>,
}

/// The curves before it that cross a splat, the nearest first, as far as they were looked for.
#[derive(Clone, Debug, Default)]
struct Crossings {
    found: Vec<Crossing>,
    looked_at: usize,
}

/// A curve before it that crosses a splat.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// In the splat's plane.
    conic: Conic,
    /// What it makes one that follows it, once that was asked: many are that follow the same.
    guess: Option<Option<Guess>>,
}

impl<'a> Speller<'a> {
    /// For a record, whose clip curves do not matter, after those of `history`.
    #[must_use]
    pub fn new(record: &Record, history: &'a History, grids: &'a Grids) -> Self {
        let splat = grids.splat(&Record { clips: Vec::new(), ..record.clone() });
        Self {
            grids,
            history,
            sizes: record.sizes,
            splat,
            leads: OnceCell::new(),
            crossings: RefCell::default(),
        }
    }

    fn leads(&self) -> &[&'a Lead] {
        self.leads.get_or_init(|| self.history.leads(self.splat.center))
    }

    /// The curve that a spelling stands for.
    ///
    /// # Errors
    /// [`Error::Format`] for numbers that the specification forbids.
    pub fn meant(&self, told: &Spelling) -> Result<ClipRecord> {
        let guess = match told.led {
            None => None,
            Some(led) => Some(self.guess(led, told.form).ok_or_else(|| {
                Error::format("field Rank", format!("no {} curves before it cross the splat", led.rank + 1))
            })?),
        };
        self.meant_by(told, guess)
    }

    /// The same where the guess is known.
    ///
    /// # Errors
    /// As [`Self::meant`].
    pub fn meant_by(&self, told: &Spelling, guess: Option<Guess>) -> Result<ClipRecord> {
        let mut clip = self.with_ends(told, guess)?;
        if told.form == Form::Straight {
            return Ok(clip);
        }
        let unit = unit(told.grain) as i64;
        let near = guess.map_or([0; 2], |guess| guess.control);
        clip.control = [0, 1].map(|n| near[n] + told.control[n] * unit);
        let steps = rho_steps(clip.control);
        if clip.control.iter().any(|steps| steps.unsigned_abs() > CONTROL_LIMIT) || steps == 0 {
            let what = format!("{:?} is out of range or the chord's middle", clip.control);
            return Err(Error::format("field Ctrl", what));
        }
        clip.rho = steps;
        if told.form == Form::Curved {
            let rho = self.rho_guess(&clip, guess) + told.rho * unit;
            if rho < 1 || rho >= steps as i64 {
                return Err(Error::format("field Rho", format!("{rho} of {steps} steps is no conic")));
            }
            clip.rho = rho as u64;
        }
        Ok(clip)
    }

    /// The chord that a spelling stands for.
    fn with_ends(&self, told: &Spelling, guess: Option<Guess>) -> Result<ClipRecord> {
        let (border, unit) = (self.grids.border_steps(self.sizes[0]) as i64, unit(told.grain) as i64);
        let [start, end] = match guess {
            None => {
                let [start, sweep] = [told.ends[0] * unit, (told.ends[1] + 1) * unit];
                if start >= border || sweep >= border {
                    return Err(Error::format("field Ends", "leads beyond a whole turn"));
                }
                [start, start + sweep]
            }
            Some(guess) => {
                let step = |guess: u64, off: i64| (guess as i64 + off * unit).rem_euclid(border);
                [step(guess.start, told.ends[0]), step(guess.end, told.ends[1])]
            }
        };
        match (end - start).rem_euclid(border) {
            0 => Err(Error::format("field Ends", "has a curve that spans nothing")),
            sweep => Ok(ClipRecord { start: start as u64, sweep: sweep as u64, ..ClipRecord::default() }),
        }
    }

    /// The guess for the steps of `rho` once ends and control point are known.
    fn rho_guess(&self, clip: &ClipRecord, guess: Option<Guess>) -> i64 {
        let rho = guess.map_or_else(|| self.circle(clip), |guess| guess.rho);
        (rho * rho_steps(clip.control) as f64 + 0.5).floor() as i64
    }

    /// The shape of the circle through the ends whose tangents there meet as high over the chord.
    fn circle(&self, clip: &ClipRecord) -> f64 {
        let [p1, p3] = self.grids.ends(clip, self.sizes);
        let chord = p3 - p1;
        let half = 0.5 * (chord.x * chord.x + chord.y * chord.y).sqrt();
        let height = clip.control[1] as f64 * self.grids.clip();
        let weight = half / (half * half + height * height).sqrt();
        weight / (1.0 + weight)
    }

    fn guess(&self, led: Led, form: Form) -> Option<Guess> {
        self.with_crossing(led, form, |Crossing { conic, guess: known }| {
            *known.get_or_insert_with(|| guess(conic, self.sizes, self.grids))
        })?
    }

    /// Asks a curve before it that crosses the splat, as it does if it is of this form; `None` if there is none.
    fn with_crossing<T>(&self, led: Led, form: Form, ask: impl FnOnce(&mut Crossing) -> T) -> Option<T> {
        let rank = usize::try_from(led.rank).ok()?;
        let kind = 2 * form as usize + usize::from(led.across);
        let known = &mut self.crossings.borrow_mut()[kind];
        let mut rest = self.leads()[known.looked_at..].iter();
        while known.found.len() <= rank {
            let crossing = rest.next()?.crossing(&self.splat, form, led.across, self.grids.budget);
            known.looked_at += 1;
            known.found.extend(crossing.map(|conic| Crossing { conic, guess: None }));
        }
        Some(ask(&mut known.found[rank]))
    }

    /// The cheapest spelling of a curve; `None` for numbers that no curve of a file has.
    #[must_use]
    pub fn cheapest(&self, clip: &ClipRecord) -> Option<Spelling> {
        let led = self.near(clip).into_iter().map(|(led, guess)| (Some(led), Some(guess)));
        let told = std::iter::once((None, None)).chain(led);
        told.filter_map(|(led, guess)| self.spelled(clip, led, guess)).min_by_key(|told| self.cost(told))
    }

    /// About how many bits a spelling takes.
    #[must_use]
    pub fn cost(&self, told: &Spelling) -> u32 {
        told.cost(self.grids.border_steps(self.sizes[0]))
    }

    /// Curves that one may follow whose ends there are near its own, and what they make it.
    #[must_use]
    pub fn near(&self, clip: &ClipRecord) -> Vec<(Led, Guess)> {
        let [p1, p3] = self.grids.ends(clip, self.sizes);
        let most = FARTHEST * self.grids.budget;
        let form = Form::of(clip);
        let mut near = Vec::new();
        for across in [false, true] {
            let ranked = (0..LOOKED_AT).map(|rank| Led { across, rank });
            let is_near = |conic: &Conic| conic.p1.distance(p1) <= most && conic.p3.distance(p3) <= most;
            let asked = ranked
                .map_while(|led| Some((led, self.with_crossing(led, form, |one| is_near(&one.conic))?)));
            let found = asked.filter(|&(_, is_near)| is_near);
            near.extend(found.filter_map(|(led, _)| Some((led, self.guess(led, form)?))));
        }
        near
    }

    /// A curve told by a guess, or by itself, in the coarsest steps that reach it.
    fn spelled(&self, clip: &ClipRecord, led: Option<Led>, guess: Option<Guess>) -> Option<Spelling> {
        let most = common_zeros(clip, guess);
        let grains = (0..GRAINS).filter(|&grain| unit(grain).trailing_zeros() <= most);
        let mut rounded = grains.map(|grain| self.rounded(clip, led, guess, grain));
        rounded.find(|told| self.meant_by(told, guess).is_ok_and(|meant| meant == *clip))
    }

    /// What is nearest to a curve of all that a guess, or none, and steps of a grain tell.
    #[must_use]
    pub fn rounded(&self, clip: &ClipRecord, led: Option<Led>, guess: Option<Guess>, grain: u8) -> Spelling {
        let (border, unit) = (self.grids.border_steps(self.sizes[0]) as i64, unit(grain) as i64);
        let form = Form::of(clip);
        let [start, sweep] = [clip.start as i64, clip.sweep as i64];
        let nearest = |off: i64| nearest(off, unit);
        let around = |off: i64| nearest((off + border / 2).rem_euclid(border) - border / 2);
        let ends = match guess {
            None => {
                let from = nearest(start);
                [from.rem_euclid(border / unit), nearest(start + sweep) - from - 1]
            }
            Some(guess) => [around(start - guess.start as i64), around(start + sweep - guess.end as i64)],
        };
        let mut told = Spelling { led, grain, form, ends, control: [0; 2], rho: 0 };
        if form != Form::Straight {
            let near = guess.map_or([0; 2], |guess| guess.control);
            told.control = [0, 1].map(|n| nearest(clip.control[n] - near[n]));
        }
        if form == Form::Curved {
            told.rho = self.shape_off(clip, &told, guess);
        }
        told
    }

    /// By how many units the shape of a curve is off the guess for a spelling's ends and control point.
    fn shape_off(&self, clip: &ClipRecord, told: &Spelling, guess: Option<Guess>) -> i64 {
        let Ok(corner) = self.meant_by(&Spelling { form: Form::Corner, ..*told }, guess) else { return 0 };
        let rho = clip.rho as f64 / rho_steps(clip.control) as f64 * rho_steps(corner.control) as f64;
        nearest((rho + 0.5).floor() as i64 - self.rho_guess(&corner, guess), unit(told.grain) as i64)
    }
}

/// How often all that a curve's ends and its control point are off a guess, or from nothing, can be halved: in units
/// of more steps than that gives they are not told.
fn common_zeros(clip: &ClipRecord, guess: Option<Guess>) -> u32 {
    let [start, sweep] = [clip.start as i64, clip.sweep as i64];
    let [ends, near] = match guess {
        None => [[start, sweep], [0; 2]],
        Some(guess) => [[start - guess.start as i64, start + sweep - guess.end as i64], guess.control],
    };
    let control = if clip.rho == 0 { [0; 2] } else { [0, 1].map(|n| clip.control[n] - near[n]) };
    (ends[0] | ends[1] | control[0] | control[1]).trailing_zeros()
}

/// The nearest number of units.
fn nearest(off: i64, unit: i64) -> i64 {
    (2 * off + unit).div_euclid(2 * unit)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::format::planted::{Random, bumpy_asset, curve};
    use crate::format::quantize::Quantizer;

    #[test]
    fn every_curve_is_told_by_itself_and_by_others() {
        let asset = bumpy_asset(60, 25.0, 9);
        let quantizer = Quantizer::new(asset.max_error);
        let (mut random, mut history) = (Random(4), History::default());
        let mut led = 0;
        for mut splat in asset.splats {
            splat.clips = (0..2).map(|_| curve(splat.radii, &mut random)).collect();
            let record = quantizer.record(&splat).unwrap();
            let speller = Speller::new(&record, &history, &quantizer.grids);
            for clip in &record.clips {
                assert_eq!(speller.meant(&speller.cheapest(clip).unwrap()).unwrap(), *clip);
                for (found, guess) in speller.near(clip) {
                    let told = speller.spelled(clip, Some(found), Some(guess)).unwrap();
                    assert_eq!(speller.meant(&told).unwrap(), *clip);
                    led += 1;
                }
            }
            history.push(record, &quantizer.grids);
        }
        assert!(led > 20, "{led}");
    }

    #[test]
    fn a_curve_that_is_another_s_costs_next_to_nothing() {
        let mut asset = bumpy_asset(1, 25.0, 9);
        let quantizer = Quantizer::new(asset.max_error);
        let splat = &mut asset.splats[0];
        splat.clips = vec![curve(splat.radii, &mut Random(1))];
        let record = quantizer.record(splat).unwrap();
        let mut history = History::default();
        history.push(record.clone(), &quantizer.grids);
        let speller = Speller::new(&record, &history, &quantizer.grids);
        let told = speller.cheapest(&record.clips[0]).unwrap();
        assert_eq!(told.led, Some(Led { across: false, rank: 0 }));
        assert!(speller.cost(&told) < 12, "{told:?}");
        let beyond = Spelling { led: Some(Led { across: false, rank: 1 }), ..told };
        assert!(speller.meant(&beyond).is_err());
    }
}
