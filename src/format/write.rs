//! From an asset to the bytes of a file.

use rayon::prelude::*;

use super::chunks::{BITS_ID, COLOR_ID, PARTNERS_ID, STREAM_IDS};
use super::codec;
use super::color;
use super::grid::{GUESS_BEND, GUESS_SPIN, Grids};
use super::header::{check_asset, header_of};
use super::layout::{CHUNK_REQUIRED, Entry, write_head};
use super::limits::Limits;
use super::order;
use super::partners;
use super::predict::History;
use super::quantize::Quantizer;
use super::record::Record;
use super::tape::{Stream, Writer};
use super::walk::{kind, walk};
use crate::error::Result;
use crate::model::asset::Asset;
use crate::model::splat::Splat;

/// A chunk: its entry in the table, and its bytes in the file.
type Coded = (Entry, Vec<u8>);

/// The colour of splats without colours.
const WHITE: [u8; 3] = [255; 3];

/// The bytes of a `.qsplat` file, version 1.
///
/// The splats are rounded to the file's grids (see [`super::quantize`] for what that may move)
/// and put into the file's own order, so a set of splats gives the same bytes in whatever
/// order it comes. What [`super::decode`] makes of the bytes encodes to the same bytes.
///
/// # Errors
/// [`crate::Error::Usage`] for an asset that no file can hold: numbers that are not finite or out of
/// the ranges in `format-spec.md`, or a splat too steep for the error budget.
pub fn encode(asset: &Asset) -> Result<Vec<u8>> {
    check_asset(asset)?;
    let quantizer = Quantizer::new(asset.max_error);
    let records = asset.splats.par_iter().map(|splat| record(&quantizer, splat, asset.has_colors));
    let (records, order) = order::sorted(records.collect::<Result<Vec<_>>>()?);
    let (grids, mut chunks) = fewest(&quantizer.grids, &records, asset.has_colors)?;
    let partners = partners::split(&asset.splats, &order)?;
    if !partners.is_empty() {
        chunks.push(codec::code(PARTNERS_ID, 0, &partners)?);
    }
    let header = header_of(asset, &grids, &records, chunks.len())?;
    let table: Vec<Entry> = chunks.iter().map(|(entry, _)| *entry).collect();
    let mut out = write_head(&header, &table);
    for (_, bytes) in &chunks {
        out.extend(bytes);
    }
    Ok(out)
}

/// The splats of an asset as the file will give them back, in the file's order.
///
/// # Errors
/// As [`encode`].
pub fn snap(asset: &Asset) -> Result<Asset> {
    check_asset(asset)?;
    let quantizer = Quantizer::new(asset.max_error);
    let records = asset.splats.par_iter().map(|splat| record(&quantizer, splat, asset.has_colors));
    let (records, order) = order::sorted(records.collect::<Result<Vec<_>>>()?);
    let mut splats: Vec<Splat> = records.iter().map(|record| quantizer.grids.splat(record)).collect();
    let partners = partners::split(&asset.splats, &order)?;
    if !partners.is_empty() {
        partners::join(&partners, &mut splats, asset.max_error, &Limits::default())?;
    }
    Ok(Asset { splats, ..asset.clone() })
}

fn record(quantizer: &Quantizer, splat: &Splat, has_colors: bool) -> Result<Record> {
    let mut record = quantizer.record(splat)?;
    if !has_colors {
        record.color = WHITE;
    }
    Ok(record)
}

/// Splats on which the ways of guessing are compared.
const COMPARED: usize = 8192;

/// The chunks, and the grids with whichever guesses gave the fewest bytes on the first splats.
fn fewest(grids: &Grids, records: &[Record], has_colors: bool) -> Result<(Grids, Vec<Coded>)> {
    let first = &records[..records.len().min(COMPARED)];
    let tried = (0..=GUESS_BEND | GUESS_SPIN).into_par_iter().map(|guesses| {
        let chunks = chunks(&Grids { guesses, ..*grids }, first, false)?;
        Ok((chunks.iter().map(|(_, bytes)| bytes.len()).sum::<usize>(), guesses))
    });
    let best = tried.collect::<Result<Vec<_>>>()?.into_iter().min();
    let grids = Grids { guesses: best.map_or(0, |(_, guesses)| guesses), ..*grids };
    Ok((grids, chunks(&grids, records, has_colors)?))
}

/// Every chunk that is not empty, coded, in the order of the file.
fn chunks(grids: &Grids, records: &[Record], has_colors: bool) -> Result<Vec<Coded>> {
    let mut writer = Writer::default();
    let mut history = History::default();
    for record in records {
        let mut record = record.clone();
        walk(&mut record, &history, grids, &mut writer)?;
        let splat = grids.splat(&record);
        history.push(record, splat);
    }
    let (mut symbols, bits) = writer.finish();
    if common_kind(records).is_some() {
        symbols[Stream::Kind as usize].clear();
    }
    let colors = if has_colors { color::split(records) } else { Vec::new() };
    let mut chunks = Vec::new();
    for (id, required, raw) in STREAM_IDS
        .into_iter()
        .zip(&symbols)
        .map(|(id, raw)| (id, CHUNK_REQUIRED, raw))
        .chain([(BITS_ID, CHUNK_REQUIRED, &bits), (COLOR_ID, 0, &colors)])
    {
        if !raw.is_empty() {
            chunks.push(codec::code(id, required, raw)?);
        }
    }
    Ok(chunks)
}

/// The kind that all records have, if they have one.
pub(super) fn common_kind(records: &[Record]) -> Option<u8> {
    let first = kind(records.first()?);
    records.iter().all(|record| kind(record) == first).then_some(first)
}
