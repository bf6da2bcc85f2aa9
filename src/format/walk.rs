//! The numbers of a record in the order in which the file holds them.
//!
//! One function serves writing and reading, see [`Tape`].

use super::clip_walk::clips;
use super::grid::{GUESS_BEND, GUESS_SPIN, Grids, MAX_FINENESS, RADIUS_CODES};
use super::octahedral;
use super::order::{MORTON_END, cell, morton};
use super::predict::{History, bend_near, normal_near, spin_near};
use super::record::Record;
use super::tape::{Field, Tape};
use crate::error::{Error, Result};
use crate::model::splat::Splat;

/// Kind bit: not flat.
pub const QUADRIC: u8 = 1;
/// Kind bit: the radii differ.
pub const LONG: u8 = 2;
/// Kind bits 2 and 3: no clip curve, one straight, one curved, or counts in the field `More`.
pub const CLIP_SHIFT: u8 = 2;
/// Kind bits 4 and 5: the fineness; 3 means 3 and what the field `More` adds.
pub const FINENESS_SHIFT: u8 = 4;
/// Kind bits 6 and 7: the turn of the fine axis, 0 to 2.
pub const TURN_SHIFT: u8 = 6;

/// The fineness from which on the field `More` holds the rest.
const FINENESS_ESCAPE: u8 = 3;

/// Sagittas are at most this many steps.
pub const MAX_BEND: u64 = 1 << 40;

/// The kind byte of a record.
#[must_use]
pub fn kind(record: &Record) -> u8 {
    let clip = match record.clips.as_slice() {
        [] => 0,
        [one] if one.rho == 0 => 1,
        [_] => 2,
        _ => 3,
    };
    let flag = |on: bool, bit: u8| if on { bit } else { 0 };
    let (quadric, long) = (record.bend != [0; 2], record.sizes[0] != record.sizes[1]);
    let fineness = record.fineness.min(FINENESS_ESCAPE);
    flag(quadric, QUADRIC)
        | flag(long, LONG)
        | (clip << CLIP_SHIFT)
        | (fineness << FINENESS_SHIFT)
        | (record.turn << TURN_SHIFT)
}

/// Carries one record over a tape, after all those of `history`.
///
/// # Errors
/// [`Error::Format`] for anything the specification forbids.
pub fn walk(record: &mut Record, history: &History, grids: &Grids, tape: &mut impl Tape) -> Result<()> {
    let mut kind = kind(record);
    tape.kind(&mut kind)?;
    mode(record, kind, tape)?;
    in_order(record, history, tape)?;
    let near = history.nearest(grids.cell_corner(record));
    sizes(record, near.map(|n| history.record(n)), kind, tape)?;
    let slide = grids.slide_bits(record.sizes[1], record.fineness);
    for low in &mut record.low {
        tape.bits(slide, low)?;
    }
    tape.bits(grids.height_bits(record.fineness) - slide, &mut record.rise)?;
    let near = near.map(|n| history.splat(n));
    normal(record, near, grids, tape)?;
    bend(record, near, kind, grids, tape)?;
    spin(record, near, grids, tape)?;
    clips(record, kind, history, grids, tape)
}

/// The kind's fineness and turn.
fn mode(record: &mut Record, kind: u8, tape: &mut impl Tape) -> Result<()> {
    let stated = kind >> FINENESS_SHIFT & 3;
    if stated == FINENESS_ESCAPE {
        let mut more = u64::from(record.fineness.saturating_sub(stated));
        tape.number(Field::More, &mut more, u64::from(MAX_FINENESS - stated))?;
        record.fineness = stated + more as u8;
    } else {
        record.fineness = stated;
    }
    record.turn = kind >> TURN_SHIFT;
    if record.turn > 2 {
        return Err(Error::format("field Kind", format!("kind {kind:#04x} turns the axis by 3")));
    }
    Ok(())
}

/// The cell, as a step along the Morton curve.
fn in_order(record: &mut Record, history: &History, tape: &mut impl Tape) -> Result<()> {
    let before = history.last().map_or(0, |last| morton(last.cell));
    let mut step = morton(record.cell).saturating_sub(before);
    tape.wide(Field::Cell, &mut step)?;
    if before + step >= MORTON_END {
        return Err(Error::format("field Cell", "leads out of the space of cells"));
    }
    record.cell = cell(before + step);
    Ok(())
}

/// The radii.
fn sizes(record: &mut Record, near: Option<&Record>, kind: u8, tape: &mut impl Tape) -> Result<()> {
    let mut large = i64::from(record.sizes[0]);
    tape.near(
        Field::Size,
        &mut large,
        near.map_or(0, |n| i64::from(n.sizes[0])),
        u64::from(RADIUS_CODES - 1),
    )?;
    if large < 0 {
        return Err(Error::format("field Size", "has a negative radius"));
    }
    let mut less = 0;
    if kind & LONG != 0 {
        if large == 0 {
            return Err(Error::format("field Size", "has a long splat of the least radius"));
        }
        less = u64::from(record.sizes[0].saturating_sub(record.sizes[1])).saturating_sub(1);
        tape.number(Field::Shape, &mut less, large as u64 - 1)?;
        less += 1;
    }
    record.sizes = [large as u16, (large - less as i64) as u16];
    Ok(())
}

/// The normal, from the normal field of the nearest splat.
fn normal(record: &mut Record, near: Option<&Splat>, grids: &Grids, tape: &mut impl Tape) -> Result<()> {
    let steps = grids.normal_steps(record.sizes[0], record.fineness);
    let place = grids.coarse_center(record);
    let guess = near.map_or([0, 0], |near| octahedral::guess(normal_near(near, place), steps));
    for (value, guess) in record.normal.iter_mut().zip(guess) {
        tape.near(Field::Norm, value, guess, steps)?;
    }
    Ok(())
}

/// The sagittas of a quadric.
fn bend(
    record: &mut Record,
    near: Option<&Splat>,
    kind: u8,
    grids: &Grids,
    tape: &mut impl Tape,
) -> Result<()> {
    if kind & QUADRIC == 0 {
        return Ok(());
    }
    let guess = match near {
        Some(near) if grids.guesses & GUESS_BEND != 0 => {
            bend_near(near, grids.radii(record.sizes), grids.bend(record.fineness) * grids.budget)
        }
        _ => [0, 0],
    };
    for (value, guess) in record.bend.iter_mut().zip(guess) {
        tape.near(Field::Bend, value, guess, MAX_BEND)?;
    }
    if record.bend == [0; 2] {
        return Err(Error::format("field Bend", "has a quadric without curvature"));
    }
    Ok(())
}

/// The turn of the frame: its least difference from the guess, either way around.
fn spin(record: &mut Record, near: Option<&Splat>, grids: &Grids, tape: &mut impl Tape) -> Result<()> {
    let bits = grids.spin_bits(record.sizes, record.bend, record.fineness);
    if bits == 0 {
        return Ok(());
    }
    let (count, half) = (1_i64 << bits, 1_i64 << (bits - 1));
    let guess = match near {
        Some(near) if grids.guesses & GUESS_SPIN != 0 => spin_near(near, grids.normal(record), bits) as i64,
        _ => 0,
    };
    let mut off = (record.spin as i64 - guess + half).rem_euclid(count) - half;
    tape.near(Field::Spin, &mut off, 0, half as u64)?;
    if off == half {
        return Err(Error::format("field Spin", format!("{off} is not below {half}")));
    }
    record.spin = (guess + off).rem_euclid(count) as u64;
    Ok(())
}
