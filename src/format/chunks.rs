//! Which chunks there are, and how long each may be.

use super::layout::{CHUNK_REQUIRED, CHUNK_ZSTD, Entry, Header};
use super::limits::Limits;
use super::partners;
use crate::error::{Error, Result};

/// Id of the chunk of splats.
pub const SPLATS_ID: [u8; 4] = *b"SPLT";

/// Id of the chunk of colours.
pub const COLOR_ID: [u8; 4] = *b"COLR";

/// Id of the chunk of clip partners.
pub const PARTNERS_ID: [u8; 4] = *b"PART";

/// A splat, and a clip curve, takes at most this many bytes.
///
/// A symbol costs at most 8 times 12 bits. A splat has 12 of them (kind, cell, two radii, two each of
/// normal and sagittas, turn, escape and two counts) and these extra bits: cell 98; place 3 x 24 and 24;
/// radii 2 x 9; normal 2 x 60; sagittas 2 x 41; turn 40; escape and counts 3 x 15: 207 bytes in all. A clip
/// curve has 5, and 201 bits: 86 bytes.
const MOST_EACH: u64 = 208;

/// A byte holds at most this many splats, so that what is allocated for splats is in proportion to the
/// file: on the grids of [`super::encode`] each has at least two bare bits, of its place in a cell.
pub const MOST_IN_BYTE: u64 = 4;

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

/// The chunks of a file in place: each known entry with its bytes.
pub struct Chunks<'a>(Vec<(Entry, &'a [u8])>);

impl<'a> Chunks<'a> {
    /// Lays the table over the rest of the file and checks all that needs no decoding.
    ///
    /// # Errors
    /// [`Error::Format`] for flags, ids or lengths that the specification forbids.
    pub fn lay_out(header: &Header, table: &[Entry], mut rest: &'a [u8], limits: &Limits) -> Result<Self> {
        let mut chunks: Vec<(Entry, &[u8])> = Vec::with_capacity(table.len());
        let mut decoded = 0;
        for entry in table {
            let place = || format!("chunk {}", entry.name());
            if chunks.iter().any(|(other, _)| other.id == entry.id) {
                return Err(Error::format(place(), "appears twice"));
            }
            if entry.flags & !(CHUNK_REQUIRED | CHUNK_ZSTD) != 0 {
                return Err(Error::format(place(), format!("has unknown flags {:#04x}", entry.flags)));
            }
            let Some((bytes, after)) = rest.split_at_checked(entry.coded as usize) else {
                return Err(Error::format(
                    place(),
                    format!("needs {} bytes, {} are left", entry.coded, rest.len()),
                ));
            };
            rest = after;
            if crc32fast::hash(bytes) != entry.check {
                return Err(Error::format(place(), "its checksum does not match; the file is damaged"));
            }
            if entry.id == SPLATS_ID && entry.flags & CHUNK_ZSTD != 0 {
                return Err(Error::format(place(), "is coded by zstd, which makes it no shorter"));
            }
            match most_bytes(entry.id, header) {
                Some(most) if u64::from(entry.raw) > most || entry.raw == 0 => {
                    return Err(Error::format(
                        place(),
                        format!("states {} bytes, 1 to {most} are possible", entry.raw),
                    ));
                }
                None if entry.flags & CHUNK_REQUIRED != 0 => {
                    return Err(Error::format(place(), "is unknown here but required; update this reader"));
                }
                Some(_) => decoded += u64::from(entry.raw),
                None => {}
            }
            chunks.push((*entry, bytes));
        }
        if !rest.is_empty() {
            return Err(Error::format("end of file", format!("{} bytes follow the last chunk", rest.len())));
        }
        limits.check("decoded bytes", decoded, limits.decoded_bytes)?;
        Ok(Self(chunks))
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
