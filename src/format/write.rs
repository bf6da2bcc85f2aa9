//! From an asset to the bytes of a file.

use rayon::prelude::*;

use super::codec::{self, Coded};
use super::color;
use super::entry::{CHUNK_REQUIRED, COLOR_ID, PARTNERS_ID, SPLATS_ID};
use super::grid::{GUESS_BEND, GUESS_SPIN, Grids};
use super::header::{check_asset, header_of, snapped_fit};
use super::layout::{seal, write_header};
use super::limits::Limits;
use super::order;
use super::partners;
use super::predict::History;
use super::quantize::Quantizer;
use super::record::Record;
use super::tape::Writer;
use super::walk::walk;
use crate::error::Result;
use crate::model::asset::Asset;
use crate::model::splat::Splat;

/// The colour of splats without colours.
const WHITE: [u8; 3] = [255; 3];

/// The bytes of a `.qsplat` file, version 3.
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
    let mut out = write_header(&header_of(asset, &grids, &records)?);
    for (entry, bytes) in &chunks {
        entry.write(&mut out);
        out.extend(bytes);
    }
    seal(&mut out);
    Ok(out)
}

/// An asset as the file will give it back, its splats in the file's order.
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
    Ok(Asset { splats, fit: snapped_fit(asset)?, ..asset.clone() })
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
        let bytes = splats(&Grids { guesses, ..*grids }, first)?;
        Ok((bytes.len(), guesses))
    });
    let best = tried.collect::<Result<Vec<_>>>()?.into_iter().min();
    let grids = Grids { guesses: best.map_or(0, |(_, guesses)| guesses), ..*grids };
    Ok((grids, chunks(&grids, records, has_colors)?))
}

/// Every chunk that is not empty, coded, in the order of the file.
fn chunks(grids: &Grids, records: &[Record], has_colors: bool) -> Result<Vec<Coded>> {
    let mut chunks = Vec::new();
    if !records.is_empty() {
        chunks.push(codec::bare(SPLATS_ID, CHUNK_REQUIRED, splats(grids, records)?)?);
        if has_colors {
            chunks.push(codec::code(COLOR_ID, 0, &color::split(records))?);
        }
    }
    Ok(chunks)
}

/// The bytes of the chunk of splats.
fn splats(grids: &Grids, records: &[Record]) -> Result<Vec<u8>> {
    let mut writer = Writer::default();
    let mut history = History::default();
    for record in records {
        let mut record = record.clone();
        walk(&mut record, &history, grids, &mut writer)?;
        history.push(record, grids);
    }
    Ok(writer.finish())
}
