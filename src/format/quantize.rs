//! Rounds splats to the grids of the file, within a stated part of the error budget.
//!
//! What is promised, with `E` the error budget, for every splat that [`Quantizer::record`]
//! accepts:
//!
//! - **Height.** Let `X` be a point over the splat's domain at distance `d <= FIT_SHARE E`
//!   from it along `k`. Its distance along the rounded `k'` to the rounded quadric is at most
//!   `d + QUANTIZE_SHARE E` (`CLIPPED_QUANTIZE_SHARE` if clip curves are rounded with it).
//!   Nothing is left to chance: the bound of `bound` is worked out for each splat, and where it
//!   does not hold, all steps of that splat are halved (its *fineness*) until it does.
//! - **Domain.** Every such `X` on the quadric lies in the rounded ellipse, so that rounding
//!   opens no hole.
//! - **Clip.** Every point of a clip curve moves by at most `CLIP_QUANTIZE_SHARE E` in the
//!   plane of the splat (see `clip`).
//! - **Again.** What comes out of the file is rounded to itself.
//!
//! How the freedom is used. The centre of a quadric may lie anywhere on it, so it slides along
//! the surface to where two of its coordinates fall on a grid as coarse as a thirty-second of
//! the smaller radius; only the third, along the axis nearest to the normal, needs the fine
//! step of the height. Normal and turn have steps in proportion to the height they move at the
//! rim; curvatures are kept as sagittas, which are heights themselves. Radii are rounded up.
//! Where rounding all to the nearest breaks the bound, errors are set against each other
//! (`place`) before the fineness is raised.
//! The larger radius comes first, and the turn is taken within half a turn.

use glam::{DVec2, DVec3};

use super::accept::{check, quarter_turn, refused};
use super::bound::Moved;
use super::grid::{Grids, MAX_FINENESS, STEPS, Size, radius, size_above};
use super::octahedral;
use super::place::Nudge;
use super::record::Record;
use crate::error::Result;
use crate::model::splat::Splat;
use crate::tolerance::{CLIP_QUANTIZE_SHARE, CLIPPED_QUANTIZE_SHARE, QUANTIZE_SHARE};

/// A splat this close to its record, in units of its finest step, is the record itself.
const EXACT: f64 = 1.0 / 1024.0;

/// The rounded ellipse holds the domain up to this, which covers the arithmetic's rounding.
const INSIDE: f64 = 1e-12;

/// Rounds of growing the radii; each grows one by 2 to 3 percent, so 100 is tenfold.
const GROWTH_ROUNDS: usize = 100;

/// Beyond this many shares another way of rounding no longer helps; finer steps must.
const HOPELESS: f64 = 4.0;

/// The least fineness of a splat that is rounded together with its clip curves: their bound is
/// proved to the first order of the steps, and at a quarter of them the rest is small.
const CLIPPED_FINENESS: u8 = 2;

/// What came of one way of rounding.
enum Attempt {
    /// The bounds hold.
    Holds(Record),
    /// They do not: the larger error, in shares.
    Misses(f64),
}

/// Rounds splats of one asset.
#[derive(Clone, Copy, Debug)]
pub struct Quantizer {
    /// The grids in use.
    pub grids: Grids,
}

impl Quantizer {
    /// The quantiser for an error budget in model units, with the steps this version writes.
    #[must_use]
    pub fn new(max_error: f64) -> Self {
        Self { grids: Grids { budget: max_error, steps: STEPS, guesses: 0 } }
    }

    /// The splat that the file will give back for this one.
    ///
    /// A bake does best to snap its splats first and to fit clip curves on what it gets: curves
    /// of a snapped splat are only rounded, never carried to another plane or a larger border.
    ///
    /// # Errors
    /// As [`Self::record`].
    pub fn snap(&self, splat: &Splat) -> Result<Splat> {
        self.snap_within(splat, 0)
    }

    /// The same in steps of a fineness at least: each halves them once more, for a few bits.
    ///
    /// # Errors
    /// As [`Self::record`].
    pub fn snap_within(&self, splat: &Splat, fineness: u8) -> Result<Splat> {
        Ok(self.grids.splat(&self.recorded(splat, fineness)?))
    }

    /// The whole numbers of a splat.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] for a splat that is not finite, whose axes are not orthonormal, whose
    /// numbers leave the ranges of the file, or that is too steep to be held within the bound.
    pub fn record(&self, splat: &Splat) -> Result<Record> {
        self.recorded(splat, 0)
    }

    /// The same in steps of a fineness at least, but for what is on the grids already.
    fn recorded(&self, splat: &Splat, fineness: u8) -> Result<Record> {
        check(splat)?;
        let from = if splat.radii.x < splat.radii.y { quarter_turn(splat) } else { splat.clone() };
        if let Some(record) = self.exact(&from)? {
            return Ok(record);
        }
        let coarsest = if from.clips.is_empty() { fineness } else { fineness.max(CLIPPED_FINENESS) };
        for fineness in coarsest..=MAX_FINENESS {
            if let Some(record) = self.rounded(&from, fineness)? {
                // A rarer axis or fineness may have a plainer spelling.
                let plain = record.fineness == 0 && record.turn == 0;
                let spelled = if plain { None } else { self.exact(&self.grids.splat(&record))? };
                return Ok(spelled.unwrap_or(record));
            }
        }
        Err(refused(splat, "is too steep to be stored within the error budget; split it"))
    }

    /// The radius codes of an ellipse.
    fn sizes(&self, splat: &Splat) -> Result<[Size; 2]> {
        let code = |r: f64| {
            size_above(r / self.grids.budget)
                .ok_or_else(|| refused(splat, "has a radius above 2^27 error budgets; split it"))
        };
        Ok([code(splat.radii.x)?, code(splat.radii.y)?])
    }

    /// The record of a splat that is on the grids already.
    fn exact(&self, splat: &Splat) -> Result<Option<Record>> {
        let sizes = self.sizes(splat)?;
        for fineness in 0..=MAX_FINENESS {
            if !self.on_grid(splat.center, sizes[1], fineness) {
                continue;
            }
            let leaning = octahedral::dominant(splat.axes.z_axis);
            for axis in [leaning, (leaning + 1) % 3, (leaning + 2) % 3] {
                let placed = self.place(splat, sizes, fineness, axis, Nudge(0));
                let Some(mut record) = placed else { continue };
                if self.same(splat, &self.grids.splat(&record), fineness) {
                    record.clips = self.clips_as_they_are(splat, &record)?;
                    return Ok(Some(record));
                }
            }
        }
        Ok(None)
    }

    /// Whether a centre may be on the grid of a fineness.
    fn on_grid(&self, center: DVec3, small: Size, fineness: u8) -> bool {
        let off = |bits: u32| {
            let steps = center / self.grids.cell() * libm::ldexp(1.0, bits as i32);
            (steps - steps.round()).abs()
        };
        let coarse = off(self.grids.slide_bits(small, fineness));
        let fine = off(self.grids.height_bits(fineness));
        let on = coarse.to_array().iter().filter(|off| **off <= EXACT).count();
        on >= 2 && fine.max_element() <= EXACT
    }

    /// Whether two splats are one but for the rounding of arithmetic.
    fn same(&self, a: &Splat, b: &Splat, fineness: u8) -> bool {
        let step = self.grids.bend(fineness) * self.grids.budget * EXACT;
        let turned = (a.axes - b.axes).to_cols_array().iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        (a.center - b.center).abs().max_element() <= step
            && turned * b.radii.x <= step
            && ((a.curvature - b.curvature) * b.radii * b.radii).abs().max_element() <= step
            && (a.radii - b.radii).abs().max_element() <= step
    }

    /// The record of a splat at a fineness, rounded in the first way for which the bounds hold.
    fn rounded(&self, splat: &Splat, fineness: u8) -> Result<Option<Record>> {
        for nudge in 0..Nudge::WAYS {
            match self.rounded_by(splat, fineness, Nudge(nudge))? {
                Attempt::Holds(record) => return Ok(Some(record)),
                Attempt::Misses(shares) if shares > HOPELESS => return Ok(None),
                Attempt::Misses(_) => {}
            }
        }
        Ok(None)
    }

    /// The record of a splat at a fineness, rounded in one way, if the bounds hold for it.
    fn rounded_by(&self, splat: &Splat, fineness: u8, nudge: Nudge) -> Result<Attempt> {
        let mut from = splat.clone();
        let mut sizes = self.sizes(&from)?;
        // A disc stays one.
        let round = splat.radii.x - splat.radii.y <= splat.radii.x * INSIDE;
        for _ in 0..GROWTH_ROUNDS {
            let steps = self.grids.normal_steps(sizes[0], fineness);
            let leaning = octahedral::decode(octahedral::encode(from.axes.z_axis, steps), steps);
            let axis = octahedral::dominant(leaning);
            let Some(mut record) = self.place(&from, sizes, fineness, axis, nudge) else {
                return Ok(Attempt::Misses(f64::INFINITY));
            };
            if sizes[0] == sizes[1] && record.bend[0] < record.bend[1] {
                from = quarter_turn(&from);
                continue;
            }
            let moved = Moved::new(&from, &self.grids.splat(&record));
            let (reach, farthest) = moved.reach();
            if farthest > 1.0 + INSIDE {
                let reach = if round { DVec2::splat(reach.max_element()) } else { reach };
                sizes = grown(sizes, reach).ok_or_else(|| refused(splat, "outgrows the largest radius"))?;
                continue;
            }
            let shares = self.shares(&moved, !from.clips.is_empty());
            // Phrased so that a NaN does not hold.
            let holds = shares <= 1.0;
            if !holds {
                return Ok(Attempt::Misses(shares));
            }
            record.clips = self.clips_moved(&from, &moved, &record)?;
            return Ok(Attempt::Holds(record));
        }
        Ok(Attempt::Misses(f64::INFINITY))
    }

    /// How much of its shares of the budget a rounded splat takes: it holds up to 1.
    fn shares(&self, moved: &Moved, clipped: bool) -> f64 {
        let budget = self.grids.budget;
        let share = if clipped { CLIPPED_QUANTIZE_SHARE } else { QUANTIZE_SHARE };
        let height = moved.height(budget) / (share * budget);
        let clip = moved.bend_of_plane() / (budget * CLIP_QUANTIZE_SHARE - self.clip_rounding());
        if clipped { height.max(clip) } else { height }
    }
}

/// The next larger radius where the domain reaches farthest; the larger one stays first.
fn grown([large, small]: [Size; 2], reach: DVec2) -> Option<[Size; 2]> {
    let sizes = if reach.x > reach.y {
        [large + 1, small]
    } else if reach.x < reach.y {
        [large.max(small + 1), small + 1]
    } else {
        [large + 1, small + 1]
    };
    (sizes[0] < super::grid::RADIUS_CODES).then_some(sizes)
}

/// The largest radius not above `wanted` that the file holds without rounding, model units.
///
/// A bake that chooses radii with it loses nothing to their rounding. Zero when `wanted` is
/// below the smallest radius.
#[must_use]
pub fn radius_below(wanted: f64, max_error: f64) -> f64 {
    let ratio = wanted / max_error;
    match size_above(ratio) {
        Some(size) if radius(size) <= ratio * (1.0 + INSIDE) => radius(size) * max_error,
        Some(0) => 0.0,
        Some(size) => radius(size - 1) * max_error,
        None => radius(super::grid::RADIUS_CODES - 1) * max_error,
    }
}
