//! The numbers of a file in the order in which a walk meets them: small symbols that are learnt, and bits
//! that nothing can foretell.
//!
//! Symbols of one field share a model.

use super::coder::{Decoder, Encoder, Model};
use super::symbol::{base, split, unzigzag, zigzag};
use crate::error::{Error, Result};

/// What a symbol tells of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
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
    /// Whether a clip curve follows another, and of which side of the line.
    Lead,
    /// Which one it follows.
    Rank,
    /// How coarse a clip curve's steps are.
    Grain,
    /// Which curves are corners.
    Corner,
    /// How far clip curves are from those they follow.
    Off,
    /// Ends of clip curves that follow none.
    Ends,
    /// Their control points.
    Ctrl,
    /// Their shapes.
    Rho,
}

/// How many fields there are.
const FIELDS: usize = 16;

/// The names of the fields in order, and of the places in cells, which take no symbols.
pub const PARTS: [&str; FIELDS + 1] = [
    "kind", "cell", "size", "shape", "norm", "bend", "spin", "more", "lead", "rank", "grain", "corner",
    "off", "ends", "ctrl", "rho", "place",
];

/// One walk over a record serves writing and reading: a writer takes the values, a reader
/// sets them.
pub trait Tape {
    /// Whether values are taken, so that it is to be chosen how they are told.
    fn is_writing(&self) -> bool;

    /// A kind, one byte.
    ///
    /// # Errors
    /// A reader: when the file has ended.
    fn kind(&mut self, value: &mut u8) -> Result<()>;

    /// A number of up to [`super::symbol::WIDEST`] bits.
    ///
    /// # Errors
    /// A reader: when the file has ended, or for a symbol that does not exist.
    fn wide(&mut self, field: Field, value: &mut u128) -> Result<()>;

    /// Bare bits, at most 64.
    ///
    /// # Errors
    /// A reader: when the file has ended.
    fn bits(&mut self, count: u32, value: &mut u64) -> Result<()>;

    /// A number that is at most `most`.
    ///
    /// # Errors
    /// As [`Self::wide`]; also for a number above `most`.
    fn number(&mut self, field: Field, value: &mut u64, most: u64) -> Result<()> {
        let mut wide = u128::from(*value);
        self.wide(field, &mut wide)?;
        if wide > u128::from(most) {
            return Err(Error::format(format!("field {field:?}"), format!("{wide} is above {most}")));
        }
        *value = wide as u64;
        Ok(())
    }

    /// A signed number, as its difference from a guess; it must lie in `-most..=most`.
    ///
    /// # Errors
    /// As [`Self::number`].
    fn near(&mut self, field: Field, value: &mut i64, guess: i64, most: u64) -> Result<()> {
        let mut difference = zigzag(*value - guess);
        self.number(field, &mut difference, u64::MAX >> 4)?;
        let result = guess + unzigzag(difference);
        if result.unsigned_abs() > most {
            return Err(Error::format(format!("field {field:?}"), format!("{result} is beyond {most}")));
        }
        *value = result;
        Ok(())
    }
}

/// The numbers of one file, written.
#[derive(Clone, Debug, Default)]
pub struct Writer {
    models: [Model; FIELDS],
    coder: Encoder,
}

impl Writer {
    /// The bytes.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        self.coder.finish()
    }
}

impl Tape for Writer {
    fn is_writing(&self) -> bool {
        true
    }

    fn kind(&mut self, value: &mut u8) -> Result<()> {
        self.coder.byte(&mut self.models[Field::Kind as usize], *value);
        Ok(())
    }

    fn wide(&mut self, field: Field, value: &mut u128) -> Result<()> {
        let (symbol, extra, count) = split(*value);
        self.coder.byte(&mut self.models[field as usize], symbol);
        self.coder.bits(count, extra);
        Ok(())
    }

    fn bits(&mut self, count: u32, value: &mut u64) -> Result<()> {
        self.coder.bits(count, u128::from(*value));
        Ok(())
    }
}

/// The numbers of one file, read.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    models: [Model; FIELDS],
    coder: Decoder<'a>,
    /// Bits spent on each of [`PARTS`], where they are counted.
    spent: Option<[f64; PARTS.len()]>,
}

impl<'a> Reader<'a> {
    /// Starts at the first byte.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { models: Default::default(), coder: Decoder::new(bytes), spent: None }
    }

    /// The same, and counts what each of [`PARTS`] takes.
    #[must_use]
    pub fn counting(bytes: &'a [u8]) -> Self {
        Self { spent: Some([0.0; PARTS.len()]), ..Self::new(bytes) }
    }

    /// Bits that each of [`PARTS`] took; zero where they are not counted.
    #[must_use]
    pub fn spent(&self) -> [f64; PARTS.len()] {
        self.spent.unwrap_or_default()
    }

    /// Reads what belongs to one of [`PARTS`].
    fn part<T>(&mut self, part: usize, read: impl FnOnce(&mut Self) -> Result<T>) -> Result<T> {
        let Some(before) = self.spent.map(|_| self.coder.spent()) else { return read(self) };
        let result = read(self);
        let after = self.coder.spent();
        if let Some(spent) = &mut self.spent {
            spent[part] += after - before;
        }
        result
    }

    fn symbol(&mut self, field: Field) -> Result<u8> {
        let symbol = self.coder.byte(&mut self.models[field as usize]);
        self.go_on(symbol)
    }

    fn take_bits(&mut self, count: u32) -> Result<u128> {
        let bits = self.coder.bits(count);
        self.go_on(bits)
    }

    /// What was read, unless the file had ended before.
    fn go_on<T>(&self, read: T) -> Result<T> {
        if self.coder.is_beyond() {
            return Err(Error::format("chunk SPLT", "ends too early; the file is damaged"));
        }
        Ok(read)
    }

    /// Refuses what is left over.
    ///
    /// # Errors
    /// [`Error::Format`].
    pub fn finish(&self) -> Result<()> {
        if self.coder.is_at_end() {
            Ok(())
        } else {
            Err(Error::format("chunk SPLT", "holds more than the splats need"))
        }
    }
}

impl Tape for Reader<'_> {
    fn is_writing(&self) -> bool {
        false
    }

    fn kind(&mut self, value: &mut u8) -> Result<()> {
        *value = self.part(Field::Kind as usize, |tape| tape.symbol(Field::Kind))?;
        Ok(())
    }

    fn wide(&mut self, field: Field, value: &mut u128) -> Result<()> {
        *value = self.part(field as usize, |tape| {
            let symbol = tape.symbol(field)?;
            let Some((least, extra)) = base(symbol) else {
                return Err(Error::format(format!("field {field:?}"), format!("has no symbol {symbol}")));
            };
            Ok(least + tape.take_bits(extra)?)
        })?;
        Ok(())
    }

    fn bits(&mut self, count: u32, value: &mut u64) -> Result<()> {
        *value = self.part(FIELDS, |tape| tape.take_bits(count))? as u64;
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
            writer.wide(Field::Cell, &mut (u128::from(n) << (n % 90))).unwrap();
            writer.bits(n as u32 % 30, &mut (n % (1 << (n % 30)))).unwrap();
            writer.near(Field::Bend, &mut (n as i64 - 100), 7, 200).unwrap();
        }
        let bytes = writer.finish();
        let mut reader = Reader::new(&bytes);
        for n in 0..200_u64 {
            assert!(reader.finish().is_err());
            let (mut wide, mut bare, mut near) = (0, 0, 0);
            reader.wide(Field::Cell, &mut wide).unwrap();
            reader.bits(n as u32 % 30, &mut bare).unwrap();
            reader.near(Field::Bend, &mut near, 7, 200).unwrap();
            assert_eq!((wide, bare, near), (u128::from(n) << (n % 90), n % (1 << (n % 30)), n as i64 - 100));
        }
        assert!(reader.clone().bits(8, &mut 0).is_err());
        reader.finish().unwrap();
    }
}
