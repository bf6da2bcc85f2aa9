//! The raw layer: header and table of chunks, byte by byte as `format-spec.md` prints them.

use crate::error::{Error, Result};

/// The first eight bytes. The high bit and the line ends reveal a transfer as text.
pub const MAGIC: [u8; 8] = *b"\x89QSP\r\n\x1a\n";

/// The version this crate writes and reads.
pub const VERSION: u16 = 2;

/// Bytes of the header.
pub const HEADER_BYTES: usize = 96;

/// Bytes of one entry of the table of chunks.
pub const ENTRY_BYTES: usize = 17;

/// Bytes of the checksum after the table.
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

/// Chunk flag: a reader that does not know the chunk must refuse the file.
pub const CHUNK_REQUIRED: u8 = 1;
/// Chunk flag: the bytes are a zstd frame without its four magic bytes.
pub const CHUNK_ZSTD: u8 = 2;

/// The header, field by field.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Features a reader must know.
    pub required: u32,
    /// Features a reader may ignore.
    pub optional: u32,
    /// Splats.
    pub splats: u32,
    /// Straight clip curves over all splats.
    pub straight: u32,
    /// Curved clip curves over all splats.
    pub curved: u32,
    /// Entries of the table of chunks.
    pub chunks: u8,
    /// Kept for later: 0.
    pub reserved: u8,
    /// `cell, height, slide, tilt, bend, spin, clip`.
    pub steps: [u8; 7],
    /// What is guessed from the nearest splat: 1 the sagittas, 2 the turn.
    pub guesses: u8,
    /// The frame's exponent.
    pub exponent: i32,
    /// The frame's origin, input units.
    pub origin: [f64; 3],
    /// Diagonal, model units.
    pub diagonal: f64,
    /// Error budget, model units.
    pub max_error: f64,
    /// Achieved `rms, p99, max`, parts of `max_error`.
    pub fit: [f32; 3],
}

/// One entry of the table of chunks.
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
    /// CRC-32 of the bytes in the file.
    pub check: u32,
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
}

/// Header, table and checksum.
#[must_use]
pub fn write_head(header: &Header, table: &[Entry]) -> Vec<u8> {
    let mut out = Vec::with_capacity(HEADER_BYTES + table.len() * ENTRY_BYTES + CHECK_BYTES);
    out.extend(MAGIC);
    out.extend(VERSION.to_le_bytes());
    out.push(header.chunks);
    out.push(header.reserved);
    for word in [header.required, header.optional, header.splats, header.straight, header.curved] {
        out.extend(word.to_le_bytes());
    }
    out.extend(header.steps);
    out.push(header.guesses);
    out.extend(header.exponent.to_le_bytes());
    for value in header.origin.iter().chain([&header.diagonal, &header.max_error]) {
        out.extend(value.to_le_bytes());
    }
    for part in header.fit {
        out.extend(part.to_le_bytes());
    }
    for entry in table {
        out.extend(entry.id);
        out.push(entry.flags);
        for word in [entry.raw, entry.coded, entry.check] {
            out.extend(word.to_le_bytes());
        }
    }
    let check = crc32fast::hash(&out);
    out.extend(check.to_le_bytes());
    out
}

/// Takes fields off the front of a byte string.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&mut self, name: &str) -> Result<[u8; N]> {
        let Some((first, rest)) = self.0.split_first_chunk::<N>() else {
            return Err(Error::format(name, "the file ends here; it was cut short"));
        };
        self.0 = rest;
        Ok(*first)
    }

    fn word(&mut self, name: &str) -> Result<u32> {
        Ok(u32::from_le_bytes(self.take(name)?))
    }

    fn float(&mut self, name: &str) -> Result<f64> {
        Ok(f64::from_le_bytes(self.take(name)?))
    }

    fn part(&mut self, name: &str) -> Result<f32> {
        Ok(f32::from_le_bytes(self.take(name)?))
    }
}

/// Parses header and table; also gives the offset of the first chunk.
///
/// Checks magic, version and checksum, but no meaning.
///
/// # Errors
/// [`Error::Format`].
pub fn read_head(bytes: &[u8]) -> Result<(Header, Vec<Entry>, usize)> {
    let mut fields = Fields(bytes);
    if fields.take::<8>("magic")? != MAGIC {
        return Err(Error::format("magic", "the first 8 bytes are not those of a .qsplat file"));
    }
    let version = u16::from_le_bytes(fields.take("version")?);
    if version != VERSION {
        let remedy = if version > VERSION { "update it" } else { "bake the file anew" };
        return Err(Error::format(
            "version",
            format!("{version}, but this reader knows {VERSION}; {remedy}"),
        ));
    }
    let [chunks, reserved] = fields.take("chunk count")?;
    let header = read_fields(&mut fields, chunks, reserved)?;
    let table = (0..chunks).map(|n| read_entry(&mut fields, n)).collect::<Result<Vec<_>>>()?;
    let end = bytes.len() - fields.0.len();
    let stated = fields.word("header checksum")?;
    if crc32fast::hash(&bytes[..end]) != stated {
        return Err(Error::format("header checksum", "does not match; the file is damaged"));
    }
    Ok((header, table, end + CHECK_BYTES))
}

/// The header after its first twelve bytes.
fn read_fields(fields: &mut Fields<'_>, chunks: u8, reserved: u8) -> Result<Header> {
    let required = fields.word("required features")?;
    let optional = fields.word("optional features")?;
    let splats = fields.word("splat count")?;
    let straight = fields.word("straight clip count")?;
    let curved = fields.word("curved clip count")?;
    let steps = fields.take("steps")?;
    let [guesses] = fields.take("guesses")?;
    let exponent = i32::from_le_bytes(fields.take("exponent")?);
    let mut float = |name| fields.float(name);
    let origin = [float("origin")?, float("origin")?, float("origin")?];
    let (diagonal, max_error) = (float("diagonal")?, float("max error")?);
    let mut part = |name| fields.part(name);
    let fit = [part("fit rms")?, part("fit p99")?, part("fit max")?];
    Ok(Header {
        required,
        optional,
        splats,
        straight,
        curved,
        chunks,
        reserved,
        steps,
        guesses,
        exponent,
        origin,
        diagonal,
        max_error,
        fit,
    })
}

fn read_entry(fields: &mut Fields<'_>, number: u8) -> Result<Entry> {
    let place = format!("chunk table, entry {number}");
    let id = fields.take(&place)?;
    let [flags] = fields.take(&place)?;
    let (raw, coded, check) = (fields.word(&place)?, fields.word(&place)?, fields.word(&place)?);
    Ok(Entry { id, flags, raw, coded, check })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_sizes_are_those_of_the_specification() {
        let header = Header {
            required: 1,
            optional: 2,
            splats: 3,
            straight: 4,
            curved: 5,
            chunks: 2,
            reserved: 6,
            steps: [1, 2, 3, 4, 5, 6, 7],
            guesses: 3,
            exponent: -8,
            origin: [9.0, 10.0, 11.0],
            diagonal: 12.0,
            max_error: 13.0,
            fit: [14.0, 15.0, 16.0],
        };
        let entry = Entry { id: *b"ABCD", flags: 3, raw: 17, coded: 18, check: 19 };
        let bytes = write_head(&header, &[entry, entry]);
        assert_eq!(bytes.len(), HEADER_BYTES + 2 * ENTRY_BYTES + CHECK_BYTES);
        assert_eq!(read_head(&bytes).unwrap(), (header, vec![entry, entry], bytes.len()));
    }
}
