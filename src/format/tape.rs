//! The streams of a file: small symbols that zstd codes well, and bits that nothing can code.
//!
//! Symbols of one field share a stream; the extra bits of all fields share one more, in the
//! order in which they are read.

use super::symbol::{base, split, unzigzag, zigzag};
use crate::error::{Error, Result};

/// The streams of symbols, in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Kinds of splats: one byte a splat.
    Kind,
    /// Differences of Morton codes.
    Cell,
    /// Codes of the larger radius.
    Size,
    /// Larger code less smaller.
    Shape,
    /// Normals.
    Norm,
    /// Sagittas.
    Bend,
    /// Turns of the frame.
    Spin,
    /// What is rarely needed: counts of clip curves, high fineness.
    More,
    /// Ends of clip curves.
    Ends,
    /// Control points of clip curves.
    Ctrl,
    /// Shapes of clip curves.
    Rho,
}

/// How many streams of symbols there are.
pub const STREAMS: usize = 11;

/// One walk over a record serves writing and reading: a writer takes the values, a reader
/// sets them.
pub trait Tape {
    /// One byte of the kind stream.
    ///
    /// # Errors
    /// A reader: when the stream has ended.
    fn kind(&mut self, value: &mut u8) -> Result<()>;

    /// A number of up to [`super::symbol::WIDEST`] bits.
    ///
    /// # Errors
    /// A reader: when a stream has ended, or for a symbol that does not exist.
    fn wide(&mut self, stream: Stream, value: &mut u128) -> Result<()>;

    /// Bare bits, at most 64.
    ///
    /// # Errors
    /// A reader: when the bits have ended.
    fn bits(&mut self, count: u32, value: &mut u64) -> Result<()>;

    /// A number that is at most `most`.
    ///
    /// # Errors
    /// As [`Self::wide`]; also for a number above `most`.
    fn number(&mut self, stream: Stream, value: &mut u64, most: u64) -> Result<()> {
        let mut wide = u128::from(*value);
        self.wide(stream, &mut wide)?;
        if wide > u128::from(most) {
            return Err(Error::format(format!("stream {stream:?}"), format!("{wide} is above {most}")));
        }
        *value = wide as u64;
        Ok(())
    }

    /// A signed number, as its difference from a guess; it must lie in `-most..=most`.
    ///
    /// # Errors
    /// As [`Self::number`].
    fn near(&mut self, stream: Stream, value: &mut i64, guess: i64, most: u64) -> Result<()> {
        let mut difference = zigzag(*value - guess);
        self.number(stream, &mut difference, u64::MAX >> 4)?;
        let result = guess + unzigzag(difference);
        if result.unsigned_abs() > most {
            return Err(Error::format(format!("stream {stream:?}"), format!("{result} is beyond {most}")));
        }
        *value = result;
        Ok(())
    }
}

/// The streams of one file, written.
#[derive(Clone, Debug, Default)]
pub struct Writer {
    /// Symbols by stream.
    pub symbols: [Vec<u8>; STREAMS],
    bits: Vec<u8>,
    /// Bits used of the last byte of `bits`; 0 when it is full.
    used: u32,
}

impl Writer {
    /// The streams and the extra bits; unused bits of the last byte are zero.
    #[must_use]
    pub fn finish(self) -> ([Vec<u8>; STREAMS], Vec<u8>) {
        (self.symbols, self.bits)
    }

    fn push_bits(&mut self, count: u32, value: u128) {
        for n in (0..count).rev() {
            if self.used == 0 {
                self.bits.push(0);
            }
            if let Some(last) = self.bits.last_mut() {
                *last |= ((value >> n & 1) as u8) << (7 - self.used);
            }
            self.used = (self.used + 1) % 8;
        }
    }
}

impl Tape for Writer {
    fn kind(&mut self, value: &mut u8) -> Result<()> {
        self.symbols[Stream::Kind as usize].push(*value);
        Ok(())
    }

    fn wide(&mut self, stream: Stream, value: &mut u128) -> Result<()> {
        let (symbol, extra, count) = split(*value);
        self.symbols[stream as usize].push(symbol);
        self.push_bits(count, extra);
        Ok(())
    }

    fn bits(&mut self, count: u32, value: &mut u64) -> Result<()> {
        self.push_bits(count, u128::from(*value));
        Ok(())
    }
}

/// The streams of one file, read.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    symbols: [&'a [u8]; STREAMS],
    bits: &'a [u8],
    /// Bits of `bits` already read.
    at: usize,
    /// The kind of every splat, where the file has no stream of them.
    common_kind: Option<u8>,
}

impl<'a> Reader<'a> {
    /// Starts at the beginning of every stream.
    #[must_use]
    pub fn new(symbols: [&'a [u8]; STREAMS], bits: &'a [u8], common_kind: Option<u8>) -> Self {
        Self { symbols, bits, at: 0, common_kind }
    }

    fn next(&mut self, stream: Stream) -> Result<u8> {
        let left = &mut self.symbols[stream as usize];
        let Some((&first, rest)) = left.split_first() else {
            return Err(Error::format(format!("stream {stream:?}"), "ends too early; the file is damaged"));
        };
        *left = rest;
        Ok(first)
    }

    fn take_bits(&mut self, count: u32) -> Result<u128> {
        if count as usize > 8 * self.bits.len() - self.at {
            return Err(Error::format("extra bits", "end too early; the file is damaged"));
        }
        let mut value = 0;
        for at in self.at..self.at + count as usize {
            value = value << 1 | u128::from(self.bits[at / 8] >> (7 - at % 8) & 1);
        }
        self.at += count as usize;
        Ok(value)
    }

    /// Refuses what is left over: symbols, whole bytes of bits, or padding that is not zero.
    ///
    /// # Errors
    /// [`Error::Format`].
    pub fn finish(mut self) -> Result<()> {
        if self.symbols.iter().any(|left| !left.is_empty()) {
            return Err(Error::format("streams", "hold more symbols than the splats need"));
        }
        let padding = 8 * self.bits.len() - self.at;
        if padding >= 8 || self.take_bits(padding as u32)? != 0 {
            return Err(Error::format("extra bits", "hold more than the splats need"));
        }
        Ok(())
    }
}

impl Tape for Reader<'_> {
    fn kind(&mut self, value: &mut u8) -> Result<()> {
        *value = match self.common_kind {
            Some(kind) => kind,
            None => self.next(Stream::Kind)?,
        };
        Ok(())
    }

    fn wide(&mut self, stream: Stream, value: &mut u128) -> Result<()> {
        let symbol = self.next(stream)?;
        let Some((least, extra)) = base(symbol) else {
            return Err(Error::format(format!("stream {stream:?}"), format!("has no symbol {symbol}")));
        };
        *value = least + self.take_bits(extra)?;
        Ok(())
    }

    fn bits(&mut self, count: u32, value: &mut u64) -> Result<()> {
        *value = self.take_bits(count)? as u64;
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_tape_comes_back_and_must_be_read_to_its_end() {
        let mut writer = Writer::default();
        for n in 0..200_u64 {
            writer.wide(Stream::Cell, &mut (u128::from(n) << (n % 90))).unwrap();
            writer.bits(n as u32 % 30, &mut (n % (1 << (n % 30)))).unwrap();
            writer.near(Stream::Bend, &mut (n as i64 - 100), 7, 200).unwrap();
        }
        let (symbols, bits) = writer.finish();
        let mut reader = Reader::new(symbols.each_ref().map(Vec::as_slice), &bits, None);
        for n in 0..200_u64 {
            assert!(reader.clone().finish().is_err());
            let (mut wide, mut bare, mut near) = (0, 0, 0);
            reader.wide(Stream::Cell, &mut wide).unwrap();
            reader.bits(n as u32 % 30, &mut bare).unwrap();
            reader.near(Stream::Bend, &mut near, 7, 200).unwrap();
            assert_eq!((wide, bare, near), (u128::from(n) << (n % 90), n % (1 << (n % 30)), n as i64 - 100));
        }
        assert!(reader.clone().kind(&mut 0).is_err());
        reader.finish().unwrap();
    }
}
