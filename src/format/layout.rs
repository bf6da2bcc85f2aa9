//! The raw layer: the header, byte by byte as `format-spec.md` prints it, and the checksum.

use glam::DVec3;

use super::fields::{Fields, VARINT_END, push};
use super::symbol::{unzigzag, zigzag};
use crate::error::{Error, Result};
use crate::model::frame::Frame;

/// The first four bytes. The high bit reveals a transfer as text.
pub const MAGIC: [u8; 4] = *b"\x89QSP";

/// The version this crate writes and reads: the byte after the magic.
pub const VERSION: u8 = 3;

/// What versions 1 and 2 had there: their magic went on with a line end.
const LINE_END: u8 = b'\r';

/// Bytes of the checksum, the last of the file.
pub const CHECK_BYTES: usize = 4;

/// Required feature: there are quadrics.
pub const HAS_QUADRICS: u32 = 1;
/// Required feature: there are clip curves.
pub const HAS_CLIPS: u32 = 2;
/// Every required feature this version knows.
pub const KNOWN_REQUIRED: u32 = HAS_QUADRICS | HAS_CLIPS;
/// Optional feature: there are colours.
pub const HAS_COLORS: u32 = 1;
/// Optional feature: there are clip partners.
pub const HAS_PARTNERS: u32 = 2;

/// Form: the guesses.
const GUESSES: u8 = 3;
/// Form: the steps are stated.
const OWN_STEPS: u8 = 4;
/// Form: the origin is three numbers of 64 bits, not of whole steps.
const FREE_ORIGIN: u8 = 8;
/// Form: diagonal and error budget have 64 bits, not 32.
const LONG_LENGTHS: u8 = 16;
/// Every bit of the form this version knows.
const KNOWN_FORM: u8 = GUESSES | OWN_STEPS | FREE_ORIGIN | LONG_LENGTHS;

/// The header, field by field.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Features a reader must know.
    pub required: u32,
    /// Features a reader may ignore.
    pub optional: u32,
    /// What is guessed from the nearest splat: 1 the sagittas, 2 the turn.
    pub guesses: u8,
    /// Splats.
    pub splats: u32,
    /// Straight clip curves over all splats.
    pub straight: u32,
    /// Curved clip curves over all splats.
    pub curved: u32,
    /// `cell, height, slide, tilt, bend, spin, clip`; `None` for those of the version.
    pub steps: Option<[u8; 7]>,
    /// The frame.
    pub frame: Frame,
    /// Diagonal, model units.
    pub diagonal: f64,
    /// Error budget, model units.
    pub max_error: f64,
    /// Achieved `rms, p99, max`, in parts of `max_error` as [`super::header`] counts them.
    pub fit: [u32; 3],
}

/// The header's bytes.
#[must_use]
pub fn write_header(header: &Header) -> Vec<u8> {
    let lengths = [header.diagonal, header.max_error];
    let (origin, short) = (steps_of(&header.frame), short(lengths));
    let flag = |on: bool, bit: u8| if on { bit } else { 0 };
    let form = header.guesses
        | flag(header.steps.is_some(), OWN_STEPS)
        | flag(origin.is_none(), FREE_ORIGIN)
        | flag(short.is_none(), LONG_LENGTHS);
    let mut out = [MAGIC.as_slice(), &[VERSION]].concat();
    push(&mut out, u64::from(header.required));
    push(&mut out, u64::from(header.optional));
    out.push(form);
    for count in [header.splats, header.straight, header.curved] {
        push(&mut out, u64::from(count));
    }
    out.extend(header.steps.iter().flatten());
    push(&mut out, zigzag(i64::from(header.frame.exponent)));
    match origin {
        Some(steps) => steps.into_iter().for_each(|number| push(&mut out, zigzag(number))),
        None => out.extend(header.frame.origin.to_array().into_iter().flat_map(f64::to_le_bytes)),
    }
    match short {
        Some(short) => out.extend(short.into_iter().flat_map(f32::to_le_bytes)),
        None => out.extend(lengths.into_iter().flat_map(f64::to_le_bytes)),
    }
    for parts in header.fit {
        push(&mut out, u64::from(parts));
    }
    out
}

/// A frame's origin in whole steps; `None` if it is not, or too far off for a number.
fn steps_of(frame: &Frame) -> Option<[i64; 3]> {
    let steps = (frame.origin / frame.step()).round();
    let near = steps.abs().max_element() < (VARINT_END / 2) as f64;
    (near && steps * frame.step() == frame.origin).then(|| steps.to_array().map(|step| step as i64))
}

/// Lengths in 32 bits; `None` if that changes one.
fn short(lengths: [f64; 2]) -> Option<[f32; 2]> {
    let short = lengths.map(|length| length as f32);
    let exact = short.map(|length| f64::from(length).to_bits()) == lengths.map(f64::to_bits);
    exact.then_some(short)
}

/// Ends a file: appends the checksum of all its bytes.
pub fn seal(file: &mut Vec<u8>) {
    let check = crc32fast::hash(file);
    file.extend(check.to_le_bytes());
}

/// Checks magic, version and checksum of a file, and parses its header; also gives what lies between
/// header and checksum. Checks no meaning.
///
/// # Errors
/// [`Error::Format`].
pub fn read_header(file: &[u8]) -> Result<(Header, &[u8])> {
    let mut fields = Fields(unsealed(file)?);
    let header = read_fields(&mut fields)?;
    Ok((header, fields.0))
}

/// What lies between version and checksum.
fn unsealed(file: &[u8]) -> Result<&[u8]> {
    let Some(&version) = file.strip_prefix(&MAGIC).and_then(<[u8]>::first) else {
        return Err(Error::format("magic", "the first bytes are not those of a .qsplat file"));
    };
    if version != VERSION {
        let (version, remedy) = match version {
            LINE_END => ("1 or 2".to_owned(), "bake the file anew"),
            0..VERSION => (version.to_string(), "bake the file anew"),
            _ => (version.to_string(), "update it"),
        };
        let what = format!("{version}, but this reader knows {VERSION}; {remedy}");
        return Err(Error::format("version", what));
    }
    file.split_last_chunk::<CHECK_BYTES>()
        .filter(|(said, check)| crc32fast::hash(said).to_le_bytes() == **check)
        .and_then(|(said, _)| said.get(MAGIC.len() + 1..))
        .ok_or_else(|| Error::format("checksum", "does not match; the file is damaged or cut short"))
}

fn read_fields(fields: &mut Fields<'_>) -> Result<Header> {
    let required = fields.word("required features")?;
    let optional = fields.word("optional features")?;
    let [form] = fields.take("form")?;
    if form & !KNOWN_FORM != 0 {
        return Err(Error::format("form", format!("{form:#04x} is unknown to this reader; update it")));
    }
    let splats = fields.word("splat count")?;
    let straight = fields.word("straight clip count")?;
    let curved = fields.word("curved clip count")?;
    let steps = if form & OWN_STEPS != 0 { Some(fields.take("steps")?) } else { None };
    let exponent = unzigzag(u64::from(fields.word("exponent")?)) as i32;
    let frame = read_frame(fields, exponent, form & FREE_ORIGIN != 0)?;
    let mut length = |name| read_length(fields, name, form & LONG_LENGTHS != 0);
    let (diagonal, max_error) = (length("diagonal")?, length("max error")?);
    let fit = [fields.word("fit rms")?, fields.word("fit p99")?, fields.word("fit max")?];
    Ok(Header {
        required,
        optional,
        guesses: form & GUESSES,
        splats,
        straight,
        curved,
        steps,
        frame,
        diagonal,
        max_error,
        fit,
    })
}

/// The frame of this exponent; its origin follows, free or in whole steps.
fn read_frame(fields: &mut Fields<'_>, exponent: i32, free: bool) -> Result<Frame> {
    let frame = Frame { origin: DVec3::ZERO, exponent };
    let mut origin = [0.0; 3];
    for x in &mut origin {
        *x = if free {
            f64::from_le_bytes(fields.take("origin")?)
        } else {
            unzigzag(fields.varint("origin")?) as f64 * frame.step()
        };
    }
    Ok(Frame { origin: origin.into(), ..frame })
}

fn read_length(fields: &mut Fields<'_>, name: &str, long: bool) -> Result<f64> {
    Ok(if long {
        f64::from_le_bytes(fields.take(name)?)
    } else {
        f64::from(f32::from_le_bytes(fields.take(name)?))
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A header whose every field is of the short form.
    fn header() -> Header {
        Header {
            required: 1,
            optional: 2,
            guesses: 3,
            splats: 300,
            straight: 4,
            curved: 5,
            steps: None,
            frame: Frame { origin: DVec3::new(1.5, -2.5, 1e6), exponent: 3 },
            diagonal: 12.0,
            max_error: 13.0,
            fit: [14, 1500, 16],
        }
    }

    fn whole(header: &Header) -> Vec<u8> {
        let mut file = write_header(header);
        seal(&mut file);
        file
    }

    #[test]
    fn headers_come_back_short_or_long() {
        let short = header();
        let steps = Header { steps: Some([1, 2, 3, 4, 5, 6, 7]), ..header() };
        let far = Header { frame: Frame { exponent: -50, ..header().frame }, ..header() };
        let off = Header { frame: Frame { origin: DVec3::splat(0.1), exponent: 0 }, ..header() };
        let long = Header { max_error: 0.1, ..header() };
        for (header, more) in [(short, 0), (steps, 7), (far, 24 - 8), (off, 24 - 8), (long, 8)] {
            let file = whole(&header);
            assert_eq!(file.len(), 33 + CHECK_BYTES + more, "{header:?}");
            assert_eq!(read_header(&file).unwrap(), (header, &[][..]));
        }
    }

    #[test]
    fn other_versions_say_what_helps() {
        for (version, words) in [(b'\r', "1 or 2"), (2, "bake the file anew"), (4, "update"), (255, "update")]
        {
            let mut file = whole(&header());
            file[MAGIC.len()] = version;
            let message = read_header(&file).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
