//! One chunk's bytes, coded and decoded.
//!
//! A coded chunk is a zstd frame (RFC 8878) without its first four bytes, which are the same
//! in all frames, or the bytes as they are where that is no longer.

use super::entry::{CHUNK_ZSTD, Entry};
use super::fields::LONGEST;
use crate::error::{Error, Result};

/// The four bytes that start every zstd frame.
pub const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// High enough that more buys less than a percent; chunks are small, so time is no matter.
const LEVEL: i32 = 19;

/// What stands before a chunk, and its bytes in the file.
pub type Coded = (Entry, Vec<u8>);

/// A chunk as zstd codes it.
///
/// # Errors
/// [`Error::Internal`] if zstd fails, [`Error::Usage`] for 4 GiB and more.
pub fn code(id: [u8; 4], required: u8, raw: &[u8]) -> Result<Coded> {
    let frame = zstd::bulk::compress(raw, LEVEL)
        .map_err(|error| Error::Internal(format!("zstd refused: {error}")))?;
    match frame.strip_prefix(&ZSTD_MAGIC) {
        // Its raw length is stated as well.
        Some(frame) if frame.len() + LONGEST < raw.len() => {
            entry(id, required | CHUNK_ZSTD, raw.len(), frame.to_vec())
        }
        _ => bare(id, required, raw.to_vec()),
    }
}

/// The same for bytes that zstd would make no fewer.
///
/// # Errors
/// [`Error::Usage`] for 4 GiB and more.
pub fn bare(id: [u8; 4], required: u8, raw: Vec<u8>) -> Result<Coded> {
    entry(id, required, raw.len(), raw)
}

fn entry(id: [u8; 4], flags: u8, raw: usize, coded: Vec<u8>) -> Result<Coded> {
    let length = |bytes: usize| {
        u32::try_from(bytes).map_err(|_| Error::Usage("a chunk passes 4 GiB; split the model".into()))
    };
    Ok((Entry { id, flags, raw: length(raw)?, coded: length(coded.len())? }, coded))
}

/// The chunk's bytes decoded: exactly `entry.raw` of them.
///
/// The caller has checked `entry.raw` against the limits; no more than that is allocated or decoded.
///
/// # Errors
/// [`Error::Format`] for a frame that is damaged or of another length.
pub fn decode(entry: &Entry, coded: &[u8]) -> Result<Vec<u8>> {
    if entry.flags & CHUNK_ZSTD == 0 {
        return Ok(coded.to_vec());
    }
    let place = || format!("chunk {}", entry.name());
    let raw = entry.raw as usize;
    let frame = [&ZSTD_MAGIC, coded].concat();
    let bytes = zstd::bulk::decompress(&frame, raw)
        .map_err(|error| Error::format(place(), format!("does not decode to {raw} bytes: {error}")))?;
    if bytes.len() != raw {
        return Err(Error::format(place(), format!("decodes to {} bytes instead of {raw}", bytes.len())));
    }
    Ok(bytes)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn chunks_come_back_by_the_shorter_way() {
        for (raw, flags) in [(vec![7; 1000], CHUNK_ZSTD), (vec![1, 2, 3], 0)] {
            let (entry, coded) = code(*b"TEST", 0, &raw).unwrap();
            assert_eq!((entry.flags, entry.coded as usize), (flags, coded.len()));
            assert_eq!(decode(&entry, &coded).unwrap(), raw);
        }
        let (entry, coded) = code(*b"TEST", 0, &[7; 1000]).unwrap();
        for wrong in [entry.raw - 1, entry.raw + 1, 0] {
            assert!(decode(&Entry { raw: wrong, ..entry }, &coded).is_err());
        }
    }
}
