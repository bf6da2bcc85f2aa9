//! What the head and the clip partners are made of: bytes, and whole numbers as varints.
//!
//! A varint takes as few bytes as it can: seven bits each, the least significant first, with bit 7
//! set in all but the last.

use crate::error::{Error, Result};

/// Bytes of the longest varint.
pub const LONGEST: usize = 5;

/// Varints are below this.
pub const VARINT_END: u64 = 1 << (7 * LONGEST);

/// Appends a varint below [`VARINT_END`].
pub fn push(bytes: &mut Vec<u8>, mut value: u64) {
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// The bytes from the first not yet read on. A caller says what errors are to call the place.
pub struct Fields<'a>(pub &'a [u8]);

impl Fields<'_> {
    /// The next bytes.
    ///
    /// # Errors
    /// [`Error::Format`] if there are not so many.
    pub fn take<const N: usize>(&mut self, place: &str) -> Result<[u8; N]> {
        let Some((first, rest)) = self.0.split_first_chunk::<N>() else {
            return Err(Error::format(place, "ends too early"));
        };
        self.0 = rest;
        Ok(*first)
    }

    /// The next varint, below [`VARINT_END`].
    ///
    /// # Errors
    /// [`Error::Format`] for one that is cut short, idle in its last byte, or too long.
    pub fn varint(&mut self, place: &str) -> Result<u64> {
        let mut value = 0;
        for n in 0..LONGEST {
            let [byte] = self.take(place)?;
            value |= u64::from(byte & 0x7f) << (7 * n);
            if byte & 0x80 == 0 {
                return if byte == 0 && n > 0 {
                    Err(Error::format(place, "has a number with idle bytes"))
                } else {
                    Ok(value)
                };
            }
        }
        Err(Error::format(place, format!("has a number of more than {LONGEST} bytes")))
    }

    /// The next varint, below `2^32`.
    ///
    /// # Errors
    /// As [`Self::varint`].
    pub fn word(&mut self, place: &str) -> Result<u32> {
        let number = self.varint(place)?;
        u32::try_from(number).map_err(|_| Error::format(place, format!("{number} has more than 32 bits")))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_and_have_one_spelling() {
        for value in [0, 1, 0x7f, 0x80, 0x3fff, 0x4000, u64::from(u32::MAX), VARINT_END - 1] {
            let mut bytes = Vec::new();
            push(&mut bytes, value);
            assert!(bytes.len() <= LONGEST);
            let mut fields = Fields(&bytes);
            assert_eq!((fields.varint("number").unwrap(), fields.0.len()), (value, 0));
            assert_eq!(Fields(&bytes).word("word").is_ok(), value <= u64::from(u32::MAX));
            for end in 0..bytes.len() {
                assert!(Fields(&bytes[..end]).varint("short").is_err());
            }
            if let Some(last) = bytes.last_mut() {
                *last |= 0x80;
            }
            bytes.push(0);
            assert!(Fields(&bytes).varint("idle").is_err());
        }
    }
}
