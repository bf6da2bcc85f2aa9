//! A file in memory, and the errors that point into it.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::Limits;
use crate::error::{Error, Result};

/// The bytes of one file with the limits in force.
pub(super) struct Source<'a> {
    pub path: &'a Path,
    pub bytes: Vec<u8>,
    pub limits: &'a Limits,
}

impl<'a> Source<'a> {
    /// Reads a file whole.
    pub fn open(path: &'a Path, limits: &'a Limits) -> Result<Self> {
        let bytes = read_file(path, limits.file_bytes)?;
        Ok(Self::of_bytes(path, bytes, limits))
    }

    /// Takes bytes that are in memory; text with a byte order mark becomes plain UTF-8.
    pub fn of_bytes(path: &'a Path, bytes: Vec<u8>, limits: &'a Limits) -> Self {
        Self { path, bytes: without_byte_order_mark(bytes), limits }
    }

    /// An error about the file as a whole.
    pub fn whole(&self, what: impl Into<String>) -> Error {
        Error::input(self.path, "file", what)
    }

    /// An error at a named place.
    pub fn at(&self, place: impl Into<String>, what: impl Into<String>) -> Error {
        Error::input(self.path, place, what)
    }

    /// An error at the text line that holds the byte `offset`.
    pub fn at_line(&self, offset: usize, what: impl Into<String>) -> Error {
        let before = &self.bytes[..offset.min(self.bytes.len())];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        self.at(format!("line {line}"), what)
    }

    /// Refuses more points than the limits allow.
    pub fn check_points(&self, points: u64) -> Result<()> {
        // Indices are 32 bits, and two values are kept free as marks.
        let limit = self.limits.points.min(u64::from(u32::MAX) - 2);
        self.check("points", points, limit)
    }

    /// Refuses more triangles than the limits allow.
    pub fn check_triangles(&self, triangles: u64) -> Result<()> {
        self.check("triangles", triangles, self.limits.triangles)
    }

    fn check(&self, unit: &str, value: u64, limit: u64) -> Result<()> {
        if value <= limit {
            return Ok(());
        }
        let what = format!(
            "holds {value} {unit}, over the limit of {limit}; thin the input out or raise \
             `Limits::{unit}`"
        );
        Err(Error::Limits { path: self.path.to_owned(), what })
    }
}

/// Reads a file of at most `limit` bytes.
pub(super) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let file = File::open(path).map_err(Error::io(path))?;
    let size = file.metadata().map_err(Error::io(path))?.len();
    let over = |size: u64| Error::Limits {
        path: path.to_owned(),
        what: format!("has {size} bytes or more, over the limit of {limit}; raise `Limits::file_bytes`"),
    };
    if size > limit {
        return Err(over(size));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0));
    // A pipe has no size, and a file may grow while it is read: the limit holds for what comes.
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(Error::io(path))?;
    if bytes.len() as u64 > limit {
        return Err(over(bytes.len() as u64));
    }
    Ok(bytes)
}

fn without_byte_order_mark(bytes: Vec<u8>) -> Vec<u8> {
    match bytes.as_slice() {
        [0xef, 0xbb, 0xbf, rest @ ..] => rest.to_vec(),
        [0xff, 0xfe, rest @ ..] => utf8_of(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf8_of(rest, u16::from_be_bytes),
        _ => bytes,
    }
}

fn utf8_of(bytes: &[u8], unit: impl Fn([u8; 2]) -> u16) -> Vec<u8> {
    let (pairs, _) = bytes.as_chunks::<2>();
    let units = pairs.iter().map(|&pair| unit(pair));
    let text: String = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn byte_order_marks_are_understood() {
        for bytes in [&b"\xef\xbb\xbfv 1"[..], b"\xff\xfev\0 \x001\0", b"\xfe\xff\0v\0 \x001"] {
            assert_eq!(without_byte_order_mark(bytes.to_vec()), b"v 1");
        }
        assert_eq!(without_byte_order_mark(b"\xff\xfe\x00".to_vec()), b"");
    }
}
