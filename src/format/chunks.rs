//! Which chunks there are, and how long each may be.

use super::entry::{CHUNK_REQUIRED, CHUNK_ZSTD, COLOR_ID, Entry, PARTNERS_ID, SPLATS_ID};
use super::fields::Fields;
use super::layout::Header;
use super::limits::Limits;
use super::partners;
use crate::error::{Error, Result};

/// A splat, and a clip curve, takes at most this many bytes.
///
/// A symbol costs at most 8 times 12 bits. A splat has 12 of them (kind, cell, two radii, two each of
/// normal and sagittas, turn, escape and two counts) and these extra bits: cell 98; place 3 x 24 and 24;
/// radii 2 x 9; normal 2 x 60; sagittas 2 x 41; turn 40; escape and counts 3 x 15: 207 bytes in all. A clip
/// curve has 9 (form, side, rank, grain and five numbers), and at most 50 extra bits for each but three of
/// them: 146 bytes.
const MOST_EACH: u64 = 208;

/// A byte holds at most this many splats, so that what is allocated for splats is in proportion to the
/// file: on the grids of [`super::encode`] each has at least two bare bits, of its place in a cell.
pub const MOST_IN_BYTE: u64 = 4;

/// A file holds at most this many chunks: each is compared with all before it.
const MOST_CHUNKS: usize = 255;

/// The largest decoded length that the counts in the header allow; `None` for an unknown id.
#[must_use]
pub fn most_bytes(id: [u8; 4], header: &Header) -> Option<u64> {
    let splats = u64::from(header.splats);
    match id {
        SPLATS_ID => Some(MOST_EACH * (splats + u64::from(header.straight) + u64::from(header.curved))),
        COLOR_ID => Some(3 * splats),
        PARTNERS_ID => Some(partners::MOST_BYTES * splats),
        _ => None,
    }
}

/// The chunks of a file in place: what stands before each, and its bytes.
pub struct Chunks<'a>(Vec<(Entry, &'a [u8])>);

impl<'a> Chunks<'a> {
    /// Finds the chunks in what lies between header and checksum, and checks all that needs no decoding.
    ///
    /// # Errors
    /// [`Error::Format`] for ids or lengths that the specification forbids.
    pub fn lay_out(header: &Header, body: &'a [u8], limits: &Limits) -> Result<Self> {
        let mut chunks: Vec<(Entry, &[u8])> = Vec::new();
        let mut fields = Fields(body);
        let mut decoded = 0;
        while !fields.0.is_empty() {
            let entry = Entry::read(&mut fields)?;
            let fault = |what: String| Err(Error::format(format!("chunk {}", entry.name()), what));
            if chunks.iter().any(|(other, _)| other.id == entry.id) {
                return fault("appears twice".into());
            }
            if chunks.len() == MOST_CHUNKS {
                return fault(format!("is one more than {MOST_CHUNKS}"));
            }
            let Some((bytes, after)) = fields.0.split_at_checked(entry.coded as usize) else {
                return fault(format!("needs {} bytes, {} are left", entry.coded, fields.0.len()));
            };
            fields.0 = after;
            if entry.id == SPLATS_ID && entry.flags & CHUNK_ZSTD != 0 {
                return fault("is coded by zstd, which makes it no shorter".into());
            }
            match most_bytes(entry.id, header) {
                Some(most) if u64::from(entry.raw) > most || entry.raw == 0 => {
                    return fault(format!("states {} bytes, 1 to {most} are possible", entry.raw));
                }
                None if entry.flags & CHUNK_REQUIRED != 0 => {
                    return fault("is unknown here but required; update this reader".into());
                }
                Some(_) => decoded += u64::from(entry.raw),
                None => {}
            }
            chunks.push((entry, bytes));
        }
        limits.check("decoded bytes", decoded, limits.decoded_bytes)?;
        Ok(Self(chunks))
    }

    /// What stands before each chunk, in the order of the file.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.0.iter().map(|(entry, _)| entry)
    }

    /// A chunk by its id.
    #[must_use]
    pub fn find(&self, id: [u8; 4]) -> Option<(Entry, &'a [u8])> {
        self.0.iter().find(|(entry, _)| entry.id == id).copied()
    }

    /// A chunk decoded; empty when it is absent.
    ///
    /// # Errors
    /// As [`super::codec::decode`].
    pub fn bytes(&self, id: [u8; 4]) -> Result<Vec<u8>> {
        self.find(id).map_or(Ok(Vec::new()), |(entry, coded)| super::codec::decode(&entry, coded))
    }
}
