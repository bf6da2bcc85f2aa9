//! What the header says: made from an asset, and checked before it is believed.

use glam::DVec3;

use super::grid::{GUESS_BEND, GUESS_SPIN, Grids, Steps};
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

/// Refuses numbers that no header may state, in words that name the field.
fn fault(frame: &Frame, diagonal: f64, max_error: f64, fit: &[f32; 3]) -> Option<(&'static str, String)> {
    // Every condition is phrased so that a NaN fails it.
    if !frame.origin.is_finite() {
        return Some(("origin", format!("{} is not finite", frame.origin)));
    }
    if frame.exponent.unsigned_abs() > EXPONENT_LIMIT.unsigned_abs() {
        return Some(("exponent", format!("{} is not within {EXPONENT_LIMIT}", frame.exponent)));
    }
    if !(1.0 / DIAGONAL_RANGE..=DIAGONAL_RANGE).contains(&diagonal) {
        return Some(("diagonal", format!("{diagonal} is not within 2^-60 to 2^60")));
    }
    if !(LEAST_BUDGET * diagonal..=MOST_BUDGET * diagonal).contains(&max_error) {
        return Some(("max error", format!("{max_error} is not within 2^-24 to 16 diagonals of {diagonal}")));
    }
    let bad = fit.iter().find(|part| !(0.0..=f32::MAX).contains(*part))?;
    Some(("fit", format!("is {bad} of the budget, not a finite part")))
}

/// The achieved error in parts of the budget. No more digits are kept than mean something; one within the
/// budget stays within it.
fn parts(asset: &Asset) -> [f32; 3] {
    [asset.fit.rms, asset.fit.p99, asset.fit.max].map(|error| (error / asset.max_error) as f32)
}

/// The achieved error as a file gives it back.
#[must_use]
pub fn snapped_fit(asset: &Asset) -> Accuracy {
    accuracy(parts(asset), asset.max_error)
}

fn accuracy(parts: [f32; 3], max_error: f64) -> Accuracy {
    let [rms, p99, max] = parts.map(|part| f64::from(part) * max_error);
    Accuracy { rms, p99, max }
}

/// Refuses an asset whose header no file can hold.
///
/// # Errors
/// [`Error::Usage`].
pub fn check_asset(asset: &Asset) -> Result<()> {
    match fault(&asset.frame, asset.diagonal, asset.max_error, &parts(asset)) {
        Some((field, why)) => Err(Error::Usage(format!("cannot store the asset: {field} {why}"))),
        None => Ok(()),
    }
}

/// The header of an asset's file.
///
/// # Errors
/// [`Error::Usage`] for more splats or clips than 32 bits count.
pub fn header_of(asset: &Asset, grids: &Grids, records: &[Record], chunks: usize) -> Result<Header> {
    let count = |n: usize| {
        u32::try_from(n)
            .map_err(|_| Error::Usage(format!("cannot store {n} splats or clips in one file; split it")))
    };
    let clips = || records.iter().flat_map(|record| &record.clips);
    let (straight, curved) = (clips().filter(|c| c.rho == 0).count(), clips().filter(|c| c.rho != 0).count());
    let quadrics = records.iter().any(|record| record.bend != [0; 2]);
    let partnered = asset.splats.iter().any(|splat| !splat.partners.is_empty());
    let steps = grids.steps;
    let flag = |on: bool, bit: u32| if on { bit } else { 0 };
    Ok(Header {
        required: flag(quadrics, HAS_QUADRICS) | flag(straight + curved > 0, HAS_CLIPS),
        optional: flag(asset.has_colors, HAS_COLORS) | flag(partnered, HAS_PARTNERS),
        splats: count(records.len())?,
        straight: count(straight)?,
        curved: count(curved)?,
        chunks: chunks as u8,
        reserved: 0,
        steps: [steps.cell, steps.height, steps.slide, steps.tilt, steps.bend, steps.spin, steps.clip],
        guesses: grids.guesses,
        exponent: asset.frame.exponent,
        origin: asset.frame.origin.to_array(),
        diagonal: asset.diagonal,
        max_error: asset.max_error,
        fit: parts(asset),
    })
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
        if self.reserved != 0 {
            return Err(Error::format("reserved byte", format!("is {}, not 0", self.reserved)));
        }
        if let Some((field, why)) = fault(&self.frame(), self.diagonal, self.max_error, &self.fit) {
            return Err(Error::format(field, why));
        }
        self.grids().steps.check()?;
        if self.guesses & !(GUESS_BEND | GUESS_SPIN) != 0 {
            return Err(Error::format("guesses", format!("{:#04x} is unknown to this reader", self.guesses)));
        }
        limits.check("splats", u64::from(self.splats), limits.splats)?;
        limits.check("clip curves", u64::from(self.straight) + u64::from(self.curved), limits.clips)
    }

    /// The frame.
    #[must_use]
    pub fn frame(&self) -> Frame {
        Frame { origin: DVec3::from_array(self.origin), exponent: self.exponent }
    }

    /// The grids.
    #[must_use]
    pub fn grids(&self) -> Grids {
        let [cell, height, slide, tilt, bend, spin, clip] = self.steps;
        Grids {
            budget: self.max_error,
            steps: Steps { cell, height, slide, tilt, bend, spin, clip },
            guesses: self.guesses,
        }
    }

    /// The achieved error.
    #[must_use]
    pub fn accuracy(&self) -> Accuracy {
        accuracy(self.fit, self.max_error)
    }
}
