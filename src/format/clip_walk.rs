//! The clip curves of a record in the order in which the file holds them.
//!
//! A curve is told by itself, or by how far it is from one before it that it follows: see
//! [`super::lead`]. Either way in steps of the coarsest grain that reaches it.

use super::grid::{GRAINS, Grids};
use super::lead::Form;
use super::predict::History;
use super::record::{ClipRecord, Record};
use super::spelling::{Led, Speller, Spelling};
use super::tape::{Field, Tape};
use super::walk::CLIP_SHIFT;
use crate::error::{Error, Result};

/// A splat has at most this many straight and this many curved clips.
pub const MAX_CLIPS: u64 = 1 << 16;

/// A difference between border steps is below this: the largest ellipse has fewer around it.
const MOST_OFF: u64 = 1 << 50;

/// Carries the clip curves of a record, straight ones first.
///
/// # Errors
/// [`Error::Format`] for anything the specification forbids.
pub fn clips(
    record: &mut Record,
    kind: u8,
    history: &History,
    grids: &Grids,
    tape: &mut impl Tape,
) -> Result<()> {
    let [straight, curved] = counts(record, kind, tape)?;
    if straight + curved == 0 {
        return Ok(());
    }
    let mut written = std::mem::take(&mut record.clips).into_iter();
    let speller = Speller::new(record, history, grids);
    let mut clips = Vec::new();
    for n in 0..straight + curved {
        let mut clip = written.next().unwrap_or_default();
        one_clip(&mut clip, n >= straight, &speller, tape)?;
        clips.push(clip);
    }
    record.clips = clips;
    Ok(())
}

/// How many straight and curved ones there are.
fn counts(record: &Record, kind: u8, tape: &mut impl Tape) -> Result<[u64; 2]> {
    let straight = record.clips.iter().filter(|clip| clip.rho == 0).count() as u64;
    let mut counts = [straight, record.clips.len() as u64 - straight];
    match kind >> CLIP_SHIFT & 3 {
        0 => return Ok([0, 0]),
        1 => return Ok([1, 0]),
        2 => return Ok([0, 1]),
        _ => {}
    }
    for count in &mut counts {
        tape.number(Field::More, count, MAX_CLIPS)?;
    }
    if counts[0] + counts[1] < 2 {
        return Err(Error::format("field More", "counts clip curves that the kind can state"));
    }
    Ok(counts)
}

/// One clip curve.
fn one_clip(clip: &mut ClipRecord, curved: bool, speller: &Speller<'_>, tape: &mut impl Tape) -> Result<()> {
    let blank = Form::of(&ClipRecord::default());
    let none = Spelling { led: None, grain: 0, form: blank, ends: [0; 2], control: [0; 2], rho: 0 };
    let mut told = none;
    if tape.is_writing() {
        let cheapest = speller.cheapest(clip);
        told = cheapest.ok_or_else(|| Error::Internal(format!("no numbers tell the clip curve {clip:?}")))?;
    }
    spelling(&mut told, curved, tape)?;
    *clip = speller.meant(&told)?;
    Ok(())
}

/// The numbers of one clip curve.
fn spelling(told: &mut Spelling, curved: bool, tape: &mut impl Tape) -> Result<()> {
    told.form = form(told.form, curved, tape)?;
    told.led = led(told.led, tape)?;
    let mut grain = u64::from(told.grain);
    tape.number(Field::Grain, &mut grain, u64::from(GRAINS - 1))?;
    told.grain = grain as u8;
    let alone = told.led.is_none();
    for end in &mut told.ends {
        if alone {
            let mut steps = *end as u64;
            tape.number(Field::Ends, &mut steps, MOST_OFF)?;
            *end = steps as i64;
        } else {
            tape.near(Field::Off, end, 0, MOST_OFF)?;
        }
    }
    if told.form == Form::Straight {
        return Ok(());
    }
    for steps in &mut told.control {
        tape.near(if alone { Field::Ctrl } else { Field::Off }, steps, 0, MOST_OFF)?;
    }
    if told.form == Form::Curved {
        tape.near(if alone { Field::Rho } else { Field::Off }, &mut told.rho, 0, MOST_OFF)?;
    }
    Ok(())
}

/// Whether it is a chord, a conic or a corner.
fn form(form: Form, curved: bool, tape: &mut impl Tape) -> Result<Form> {
    if !curved {
        return Ok(Form::Straight);
    }
    let mut corner = u64::from(form == Form::Corner);
    tape.number(Field::Corner, &mut corner, 1)?;
    Ok(if corner == 1 { Form::Corner } else { Form::Curved })
}

/// Which curve it follows.
fn led(led: Option<Led>, tape: &mut impl Tape) -> Result<Option<Led>> {
    let mut side = led.map_or(0, |led| 1 + u64::from(led.across));
    tape.number(Field::Lead, &mut side, 2)?;
    if side == 0 {
        return Ok(None);
    }
    let mut rank = led.map_or(0, |led| led.rank);
    tape.number(Field::Rank, &mut rank, MOST_OFF)?;
    Ok(Some(Led { across: side == 2, rank }))
}
