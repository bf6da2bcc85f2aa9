//! From the bytes of a file to an asset.

use super::chunks::{Chunks, MOST_IN_BYTE};
use super::color;
use super::entry::{COLOR_ID, PARTNERS_ID, SPLATS_ID};
use super::layout::{HAS_CLIPS, HAS_COLORS, HAS_PARTNERS, HAS_QUADRICS, Header, read_header};
use super::limits::Limits;
use super::partners;
use super::predict::History;
use super::record::Record;
use super::tape::Reader;
use super::walk::walk;
use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::model::splat::Splat;

/// The asset in the bytes of a `.qsplat` file, version 3.
///
/// Every number of the result is finite and within the ranges of `format-spec.md`: radii are
/// positive, axes orthonormal to 1e-15, `rho` in `(0, 1]` for curved clips. The result is the
/// same to the last bit on every machine.
///
/// # Errors
/// [`Error::Format`] for bytes that the specification forbids, with the place and the fault;
/// [`Error::Limits`] before anything larger than the limits is allocated.
pub fn decode(bytes: &[u8], limits: &Limits) -> Result<Asset> {
    let (header, chunks) = open(bytes, limits)?;
    let mut splats = splats(&header, &chunks)?;
    let has_colors = header.optional & HAS_COLORS != 0;
    paint(&mut splats, &chunks, has_colors)?;
    link(&mut splats, &header, &chunks, limits)?;
    Ok(Asset {
        frame: header.frame,
        diagonal: header.diagonal,
        max_error: header.max_error,
        fit: header.accuracy(),
        has_colors,
        splats,
    })
}

/// Parses and checks all that needs no decoding.
pub(super) fn open<'a>(bytes: &'a [u8], limits: &Limits) -> Result<(Header, Chunks<'a>)> {
    limits.check("file bytes", bytes.len() as u64, limits.file_bytes)?;
    let (header, body) = read_header(bytes)?;
    header.check(limits)?;
    let chunks = Chunks::lay_out(&header, body, limits)?;
    Ok((header, chunks))
}

fn splats(header: &Header, chunks: &Chunks<'_>) -> Result<Vec<Splat>> {
    let bytes = chunks.bytes(SPLATS_ID)?;
    read_splats(header, &bytes, &mut Reader::new(&bytes))
}

/// The splats in the bytes of their chunk, read by a reader of these bytes.
pub(super) fn read_splats(header: &Header, bytes: &[u8], reader: &mut Reader<'_>) -> Result<Vec<Splat>> {
    // What follows allocates in proportion to the splats.
    if u64::from(header.splats) > MOST_IN_BYTE * bytes.len() as u64 {
        let what = format!("holds {} bytes, too few for {} splats", bytes.len(), header.splats);
        return Err(Error::format("chunk SPLT", what));
    }
    let grids = header.grids();
    let mut history = History::default();
    let mut found = Found::default();
    for _ in 0..header.splats {
        let mut record = Record::default();
        walk(&mut record, &history, &grids, reader)?;
        found.add(&record);
        history.push(record, &grids);
    }
    if header.splats > 0 {
        reader.finish()?;
    }
    found.check(header)?;
    Ok(history.into_splats())
}

/// Sets the colours.
fn paint(splats: &mut [Splat], chunks: &Chunks<'_>, has_colors: bool) -> Result<()> {
    let planes = chunks.bytes(COLOR_ID)?;
    let wanted = if has_colors { 3 * splats.len() } else { 0 };
    if planes.len() != wanted {
        return Err(Error::format("chunk COLR", format!("holds {} bytes instead of {wanted}", planes.len())));
    }
    let colors = color::join(&planes);
    for (n, splat) in splats.iter_mut().enumerate() {
        splat.color = colors.get(n).copied().unwrap_or([255; 3]);
    }
    Ok(())
}

/// Sets the clip partners.
fn link(splats: &mut [Splat], header: &Header, chunks: &Chunks<'_>, limits: &Limits) -> Result<()> {
    let bytes = chunks.bytes(PARTNERS_ID)?;
    if bytes.is_empty() == (header.optional & HAS_PARTNERS != 0) {
        return Err(Error::format("optional features", "differ from the chunk PART in the file"));
    }
    if bytes.is_empty() { Ok(()) } else { partners::join(&bytes, splats, header.max_error, limits) }
}

/// What the records turned out to hold, to be compared with what the header states.
#[derive(Default)]
struct Found {
    straight: u32,
    curved: u32,
    quadrics: bool,
}

impl Found {
    fn add(&mut self, record: &Record) {
        self.quadrics |= record.bend != [0; 2];
        for clip in &record.clips {
            *if clip.rho == 0 { &mut self.straight } else { &mut self.curved } += 1;
        }
    }

    fn check(&self, header: &Header) -> Result<()> {
        if (self.straight, self.curved) != (header.straight, header.curved) {
            return Err(Error::format("clip counts", "differ from the clip curves in the file"));
        }
        let clips = self.straight + self.curved > 0;
        let flag = |on: bool, bit: u32| if on { bit } else { 0 };
        let required = flag(self.quadrics, HAS_QUADRICS) | flag(clips, HAS_CLIPS);
        if header.required != required {
            return Err(Error::format("required features", "differ from what the file holds"));
        }
        Ok(())
    }
}
