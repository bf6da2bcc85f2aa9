//! What a file holds, and what of it takes how many bytes.

use super::chunks::{Chunks, most_bytes};
use super::entry::{CHUNK_REQUIRED, CHUNK_ZSTD, COLOR_ID, Entry, PARTNERS_ID, SPLATS_ID};
use super::layout::{HAS_COLORS, Header, VERSION};
use super::limits::Limits;
use super::read::{open, read_splats};
use super::tape::{PARTS, Reader};
use crate::error::Result;

/// A summary of a file.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FileInfo {
    /// Version of the format.
    pub version: u16,
    /// Feature bits a reader must know.
    pub required_features: u32,
    /// Feature bits a reader may ignore.
    pub optional_features: u32,
    /// Bytes of the whole file.
    pub bytes: u64,
    /// Bytes of the header, of what stands before each chunk, and of the checksum: all but the chunks'.
    pub head_bytes: u64,
    /// Splats.
    pub splats: u32,
    /// Straight clip curves.
    pub straight_clips: u32,
    /// Curved clip curves.
    pub curved_clips: u32,
    /// The chunks in the order of the file.
    pub chunks: Vec<ChunkInfo>,
    /// What the chunk of splats tells of, and what each takes of it.
    pub fields: Vec<FieldInfo>,
    /// What a file may hold and this one does not.
    pub absent: Vec<Absent>,
}

/// One chunk.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ChunkInfo {
    /// Its four characters.
    pub id: String,
    /// Whether this reader knows it.
    pub known: bool,
    /// Whether a reader that does not know it must refuse the file.
    pub required: bool,
    /// `zstd` or `none`.
    pub coder: String,
    /// Bytes after decoding.
    pub raw_bytes: u64,
    /// Bytes in the file.
    pub coded_bytes: u64,
}

/// A part of what is told of splats.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FieldInfo {
    /// Its name in `format-spec.md`, or `place`: bits that say where in a cell a centre lies.
    pub name: String,
    /// Bytes that it takes, to their fractions.
    pub bytes: f64,
}

/// Something optional that a file does without.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Absent {
    /// The chunk it would be in.
    pub id: String,
    /// What it is.
    pub what: String,
    /// Why it is not there.
    pub why: String,
}

/// What may be absent: where it would be, what it is, why it is not there.
const OPTIONAL: [([u8; 4], &str, &str); 3] = [
    (SPLATS_ID, "splats", "there are none"),
    (COLOR_ID, "colours", "the splats have none"),
    (PARTNERS_ID, "clip partners", "no splat is cut by another"),
];

/// Sums up a file; checks all but what is in optional chunks.
///
/// # Errors
/// As [`super::decode`].
pub fn inspect(bytes: &[u8], limits: &Limits) -> Result<FileInfo> {
    let (header, chunks) = open(bytes, limits)?;
    let name = |id: [u8; 4]| String::from_utf8_lossy(&id).into_owned();
    let chunk = |entry: &Entry| ChunkInfo {
        id: entry.name(),
        known: most_bytes(entry.id, &header).is_some(),
        required: entry.flags & CHUNK_REQUIRED != 0,
        coder: if entry.flags & CHUNK_ZSTD != 0 { "zstd" } else { "none" }.to_owned(),
        raw_bytes: u64::from(entry.raw),
        coded_bytes: u64::from(entry.coded),
    };
    let has_splats = header.splats > 0;
    let why = |id: [u8; 4], why: &str| {
        let painted = id == COLOR_ID && header.optional & HAS_COLORS != 0;
        if has_splats && !painted { why.to_owned() } else { "there are no splats".to_owned() }
    };
    let absent = OPTIONAL
        .iter()
        .filter(|(id, ..)| chunks.find(*id).is_none())
        .map(|(id, what, reason)| Absent { id: name(*id), what: (*what).to_owned(), why: why(*id, reason) })
        .collect();
    let coded: u64 = chunks.entries().map(|entry| u64::from(entry.coded)).sum();
    Ok(FileInfo {
        version: u16::from(VERSION),
        required_features: header.required,
        optional_features: header.optional,
        bytes: bytes.len() as u64,
        head_bytes: bytes.len() as u64 - coded,
        splats: header.splats,
        straight_clips: header.straight,
        curved_clips: header.curved,
        chunks: chunks.entries().map(chunk).collect(),
        fields: fields(&header, &chunks)?,
        absent,
    })
}

/// What each of [`PARTS`] takes, where it takes anything.
fn fields(header: &Header, chunks: &Chunks<'_>) -> Result<Vec<FieldInfo>> {
    let bytes = chunks.bytes(SPLATS_ID)?;
    let mut reader = Reader::counting(&bytes);
    read_splats(header, &bytes, &mut reader)?;
    let taken = PARTS.iter().zip(reader.spent()).filter(|(_, bits)| *bits > 0.0);
    Ok(taken.map(|(name, bits)| FieldInfo { name: (*name).into(), bytes: bits / 8.0 }).collect())
}
