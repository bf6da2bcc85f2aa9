//! What stands before the bytes of each chunk: which chunk it is, and how long.

use super::fields::{Fields, push};
use crate::error::{Error, Result};

/// Id of the chunk of splats.
pub const SPLATS_ID: [u8; 4] = *b"SPLT";
/// Id of the chunk of colours.
pub const COLOR_ID: [u8; 4] = *b"COLR";
/// Id of the chunk of clip partners.
pub const PARTNERS_ID: [u8; 4] = *b"PART";

/// The chunks of this version by their numbers, which count from 1; other chunks are spelt out.
const NUMBERED: [[u8; 4]; 3] = [SPLATS_ID, COLOR_ID, PARTNERS_ID];

/// Flag: a reader that does not know the chunk must refuse the file.
pub const CHUNK_REQUIRED: u8 = 1;
/// Flag: the bytes are a zstd frame without its four magic bytes.
pub const CHUNK_ZSTD: u8 = 2;
/// Bits of the tag that are flags; those above are the chunk's number.
const FLAG_BITS: u32 = 2;

/// What errors call it.
const PLACE: &str = "chunk";

/// What stands before a chunk's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Four printable characters.
    pub id: [u8; 4],
    /// [`CHUNK_REQUIRED`] and [`CHUNK_ZSTD`].
    pub flags: u8,
    /// Bytes when decoded.
    pub raw: u32,
    /// Bytes in the file.
    pub coded: u32,
}

impl Entry {
    /// The id as text.
    #[must_use]
    pub fn name(&self) -> String {
        self.id
            .iter()
            .map(|&byte| if byte.is_ascii_graphic() || byte == b' ' { byte as char } else { '?' })
            .collect()
    }

    /// Appends it to the bytes of a file.
    pub fn write(&self, out: &mut Vec<u8>) {
        let number = NUMBERED.iter().zip(1_u8..).find(|(id, _)| **id == self.id);
        out.push(self.flags | number.map_or(0, |(_, number)| number << FLAG_BITS));
        if number.is_none() {
            out.extend(self.id);
        }
        if self.flags & CHUNK_ZSTD != 0 {
            push(out, u64::from(self.raw));
        }
        push(out, u64::from(self.coded));
    }

    /// Takes it off the front of what is left of a file. Checks no length.
    ///
    /// # Errors
    /// [`Error::Format`] for a number that no chunk has, and for an id spelt out that has one.
    pub fn read(fields: &mut Fields<'_>) -> Result<Self> {
        let [tag] = fields.take(PLACE)?;
        let flags = tag & (CHUNK_REQUIRED | CHUNK_ZSTD);
        let id = match usize::from(tag >> FLAG_BITS).checked_sub(1) {
            None => spelt_out(fields)?,
            Some(at) => *NUMBERED.get(at).ok_or_else(|| {
                Error::format(PLACE, format!("has the number {}, unknown to this reader; update it", at + 1))
            })?,
        };
        let raw = if flags & CHUNK_ZSTD != 0 { Some(fields.word(PLACE)?) } else { None };
        let coded = fields.word(PLACE)?;
        Ok(Self { id, flags, raw: raw.unwrap_or(coded), coded })
    }
}

fn spelt_out(fields: &mut Fields<'_>) -> Result<[u8; 4]> {
    let id = fields.take(PLACE)?;
    if NUMBERED.contains(&id) {
        return Err(Error::format(PLACE, "has an id that is spelt out in place of its number"));
    }
    Ok(id)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn entries_come_back_in_the_bytes_of_the_specification() {
        for (id, flags, raw, bytes) in [
            (SPLATS_ID, 1, 300, &[0x05, 0xac, 0x02][..]),
            (PARTNERS_ID, 2, 1000, &[0x0e, 0xe8, 0x07, 0xac, 0x02]),
            (*b"NEW?", 0, 300, b"\x00NEW?\xac\x02"),
        ] {
            let entry = Entry { id, flags, raw, coded: 300 };
            let mut out = Vec::new();
            entry.write(&mut out);
            assert_eq!(out, bytes);
            assert_eq!(Entry::read(&mut Fields(&out)).unwrap(), entry);
        }
        for wrong in [&b"\x00SPLT\x01"[..], &[0x10, 1], &[0xfd, 1], &[0x05]] {
            assert!(Entry::read(&mut Fields(wrong)).is_err(), "{wrong:?}");
        }
    }
}
