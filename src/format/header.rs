//! What the header says: made from an asset, and checked before it is believed.

use super::grid::{Grids, STEPS, Steps};
use super::layout::{HAS_CLIPS, HAS_COLORS, HAS_PARTNERS, HAS_QUADRICS, Header, KNOWN_REQUIRED};
use super::limits::Limits;
use super::record::Record;
use crate::error::{Error, Result};
use crate::model::asset::{Accuracy, Asset};
use crate::model::frame::{EXPONENT_LIMIT, Frame};

/// The error budget over the diagonal is at least this: positions keep 24 bits and more.
pub const LEAST_BUDGET: f64 = 1.0 / (1 << 24) as f64;

/// The error budget over the diagonal is at most this.
pub const MOST_BUDGET: f64 = 16.0;

/// The diagonal is between the reciprocal of this and this: a model fills its frame, so that
/// only a wrong number lies outside, and no product of a few lengths can overflow.
pub const DIAGONAL_RANGE: f64 = (1_u64 << 60) as f64;

/// The achieved error is told in so many parts of the budget.
const PARTS: f64 = 8192.0;

/// Refuses numbers that no header may state, in words that name the field.
fn fault(frame: &Frame, diagonal: f64, max_error: f64) -> Option<(&'static str, String)> {
    // Every condition is phrased so that a NaN fails it. The origin's steps depend on the exponent.
    if frame.exponent.unsigned_abs() > EXPONENT_LIMIT.unsigned_abs() {
        return Some(("exponent", format!("{} is not within {EXPONENT_LIMIT}", frame.exponent)));
    }
    if !frame.origin.is_finite() {
        return Some(("origin", format!("{} is not finite", frame.origin)));
    }
    if !(1.0 / DIAGONAL_RANGE..=DIAGONAL_RANGE).contains(&diagonal) {
        return Some(("diagonal", format!("{diagonal} is not within 2^-60 to 2^60")));
    }
    if !(LEAST_BUDGET * diagonal..=MOST_BUDGET * diagonal).contains(&max_error) {
        return Some(("max error", format!("{max_error} is not within 2^-24 to 16 diagonals of {diagonal}")));
    }
    None
}

fn refused(field: &str, why: &str) -> Error {
    Error::Usage(format!("cannot store the asset: {field} {why}"))
}

/// What a number of parts says.
fn error_of(parts: u32, max_error: f64) -> f64 {
    f64::from(parts) / PARTS * max_error
}

/// The least number of parts that does not understate an error; one within the budget stays within it.
fn parts_of(error: f64, max_error: f64) -> Result<u32> {
    let near = error / max_error * PARTS;
    if !(0.0..f64::from(u32::MAX)).contains(&near) {
        return Err(refused("fit", &format!("{error} is not within 0 to 2^19 budgets of {max_error}")));
    }
    // The quotient is off by a rounding, so that the number may be one to either side.
    let least = (near as u32).saturating_sub(1);
    Ok((least..u32::MAX).find(|&parts| error_of(parts, max_error) >= error).unwrap_or(u32::MAX))
}

/// The parts that an asset's file states.
fn fit_parts(asset: &Asset) -> Result<[u32; 3]> {
    let parts = |error: f64| parts_of(error, asset.max_error);
    Ok([parts(asset.fit.rms)?, parts(asset.fit.p99)?, parts(asset.fit.max)?])
}

/// The achieved error as a file gives it back.
///
/// # Errors
/// As [`check_asset`].
pub fn snapped_fit(asset: &Asset) -> Result<Accuracy> {
    Ok(accuracy(fit_parts(asset)?, asset.max_error))
}

fn accuracy(parts: [u32; 3], max_error: f64) -> Accuracy {
    let [rms, p99, max] = parts.map(|parts| error_of(parts, max_error));
    Accuracy { rms, p99, max }
}

/// Refuses an asset whose header no file can hold.
///
/// # Errors
/// [`Error::Usage`].
pub fn check_asset(asset: &Asset) -> Result<()> {
    match fault(&asset.frame, asset.diagonal, asset.max_error) {
        Some((field, why)) => Err(refused(field, &why)),
        None => fit_parts(asset).map(drop),
    }
}

/// The header of an asset's file.
///
/// # Errors
/// As [`check_asset`]; [`Error::Usage`] for more splats or clips than 32 bits count.
pub fn header_of(asset: &Asset, grids: &Grids, records: &[Record]) -> Result<Header> {
    let count = |n: usize| {
        u32::try_from(n)
            .map_err(|_| Error::Usage(format!("cannot store {n} splats or clips in one file; split it")))
    };
    let clips = || records.iter().flat_map(|record| &record.clips);
    let (straight, curved) = (clips().filter(|c| c.rho == 0).count(), clips().filter(|c| c.rho != 0).count());
    let quadrics = records.iter().any(|record| record.bend != [0; 2]);
    let partnered = asset.splats.iter().any(|splat| !splat.partners.is_empty());
    let flag = |on: bool, bit: u32| if on { bit } else { 0 };
    Ok(Header {
        required: flag(quadrics, HAS_QUADRICS) | flag(straight + curved > 0, HAS_CLIPS),
        optional: flag(asset.has_colors, HAS_COLORS) | flag(partnered, HAS_PARTNERS),
        guesses: grids.guesses,
        splats: count(records.len())?,
        straight: count(straight)?,
        curved: count(curved)?,
        steps: (grids.steps != STEPS).then(|| listed(&grids.steps)),
        frame: asset.frame,
        diagonal: asset.diagonal,
        max_error: asset.max_error,
        fit: fit_parts(asset)?,
    })
}

/// The steps in the order of the file.
fn listed(steps: &Steps) -> [u8; 7] {
    let Steps { cell, height, slide, tilt, bend, spin, clip } = *steps;
    [cell, height, slide, tilt, bend, spin, clip]
}

impl Header {
    /// Refuses a header that is out of range or beyond the limits.
    ///
    /// # Errors
    /// [`Error::Format`], [`Error::Limits`].
    pub fn check(&self, limits: &Limits) -> Result<()> {
        let unknown = self.required & !KNOWN_REQUIRED;
        if unknown != 0 {
            let what = format!("{unknown:#010x} are unknown to this reader; update it");
            return Err(Error::format("required features", what));
        }
        if let Some((field, why)) = fault(&self.frame, self.diagonal, self.max_error) {
            return Err(Error::format(field, why));
        }
        self.grids().steps.check()?;
        limits.check("splats", u64::from(self.splats), limits.splats)?;
        limits.check("clip curves", u64::from(self.straight) + u64::from(self.curved), limits.clips)
    }

    /// The grids.
    #[must_use]
    pub fn grids(&self) -> Grids {
        let steps = self.steps.map_or(STEPS, |[cell, height, slide, tilt, bend, spin, clip]| Steps {
            cell,
            height,
            slide,
            tilt,
            bend,
            spin,
            clip,
        });
        Grids { budget: self.max_error, steps, guesses: self.guesses }
    }

    /// The achieved error.
    #[must_use]
    pub fn accuracy(&self) -> Accuracy {
        accuracy(self.fit, self.max_error)
    }
}
