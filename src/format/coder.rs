//! Adaptive binary range coding: a bit costs as much as it is unlikely.
//!
//! A string of bits is a place in a range of numbers; each bit keeps a part of the range, as wide as the bit
//! is likely (Martin 1979, "Range encoding: an algorithm for removing redundancy from a digitised
//! message"). How likely is learnt from the bits before it in the same context, so that nothing has to be
//! stored beside the bits: files are small, and tables of their statistics would cost as much as they save.
//! Whole numbers alone are used, so that every decoder gets the same bits.

/// The range is kept at least this wide: after each bit, bytes that are settled leave it.
const LEAST_RANGE: u32 = 1 << 24;

/// Bits of a probability.
const SHARE_BITS: u32 = 12;

/// After so many bits, older ones are forgotten at the rate at which new ones come. Twice and half as many
/// give files a tenth of a percent larger.
const MEMORY: u8 = 62;

/// Bytes that a decoder reads ahead, less the one that an encoder ends with.
const READ_PAST: usize = 3;

/// How likely a bit is 0 in one context.
#[derive(Clone, Copy, Debug)]
struct Odds {
    /// Of 65536.
    zero: u16,
    /// Bits learnt from, at most [`MEMORY`].
    seen: u8,
}

impl Odds {
    const EVEN: Self = Self { zero: 1 << 15, seen: 0 };

    /// The part of a range that a 0 keeps.
    fn bound(self, range: u32) -> u32 {
        let most = (1 << SHARE_BITS) - 1;
        (range >> SHARE_BITS) * u32::from(self.zero >> (16 - SHARE_BITS)).clamp(1, most)
    }

    /// Moves towards a bit: from few bits to the estimate of Krichevsky and Trofimov (1981), of `n` bits
    /// `(zeros + 1/2) / (n + 1)`, and by a fixed part once there are [`MEMORY`] of them.
    fn learn(&mut self, bit: bool) {
        let weight = u16::from(self.seen) + 2;
        if bit {
            self.zero -= self.zero / weight;
        } else {
            self.zero += (u16::MAX - self.zero) / weight;
        }
        self.seen = (self.seen + 1).min(MEMORY);
    }
}

/// What is known of the bytes of one field: a tree of the [`Odds`] of their bits, the highest first.
#[derive(Clone, Debug)]
pub struct Model([Odds; 256]);

impl Default for Model {
    fn default() -> Self {
        Self([Odds::EVEN; 256])
    }
}

/// Writes bits.
#[derive(Clone, Debug)]
pub struct Encoder {
    low: u32,
    range: u32,
    bytes: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self { low: 0, range: u32::MAX, bytes: Vec::new() }
    }
}

impl Encoder {
    /// Writes a byte.
    pub fn byte(&mut self, model: &mut Model, byte: u8) {
        let mut node = 1;
        for n in (0..8).rev() {
            let bit = byte >> n & 1 == 1;
            let odds = &mut model.0[node];
            let bound = odds.bound(self.range);
            odds.learn(bit);
            if bit {
                self.raise(bound);
                self.range -= bound;
            } else {
                self.range = bound;
            }
            self.settle();
            node = 2 * node + usize::from(bit);
        }
    }

    /// Writes the lowest bits of a number, the highest of them first, each as likely 0 as 1.
    pub fn bits(&mut self, count: u32, value: u128) {
        for n in (0..count).rev() {
            self.range >>= 1;
            if value >> n & 1 == 1 {
                self.raise(self.range);
            }
            self.settle();
        }
    }

    fn raise(&mut self, by: u32) {
        let (low, carry) = self.low.overflowing_add(by);
        self.low = low;
        if carry {
            for byte in self.bytes.iter_mut().rev() {
                *byte = byte.wrapping_add(1);
                if *byte > 0 {
                    break;
                }
            }
        }
    }

    fn settle(&mut self) {
        while self.range < LEAST_RANGE {
            self.shift();
            self.range <<= 8;
        }
    }

    fn shift(&mut self) {
        self.bytes.push((self.low >> 24) as u8);
        self.low <<= 8;
    }

    /// The bytes: the last is the only one needed to name a place in the range, since zeros follow it.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.raise(self.low.wrapping_neg() & (LEAST_RANGE - 1));
        self.shift();
        self.bytes
    }
}

/// Reads what an [`Encoder`] wrote. Beyond the end there are zeros.
#[derive(Clone, Debug)]
pub struct Decoder<'a> {
    bytes: &'a [u8],
    /// Bytes read, also beyond the end.
    at: usize,
    /// How far above the range's low end the place is.
    above: u32,
    range: u32,
}

impl<'a> Decoder<'a> {
    /// Starts at the first byte.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { bytes, at: 0, above: 0, range: u32::MAX };
        (0..4).for_each(|_| decoder.shift());
        decoder
    }

    /// Reads a byte.
    pub fn byte(&mut self, model: &mut Model) -> u8 {
        let mut node = 1;
        for _ in 0..8 {
            let odds = &mut model.0[node];
            let bound = odds.bound(self.range);
            let bit = self.above >= bound;
            odds.learn(bit);
            if bit {
                self.above -= bound;
                self.range -= bound;
            } else {
                self.range = bound;
            }
            self.settle();
            node = 2 * node + usize::from(bit);
        }
        // The tree's 256 leaves are the bytes.
        (node & 0xff) as u8
    }

    /// Reads as many bits.
    pub fn bits(&mut self, count: u32) -> u128 {
        let mut value = 0;
        for _ in 0..count {
            self.range >>= 1;
            let bit = self.above >= self.range;
            if bit {
                self.above -= self.range;
            }
            self.settle();
            value = value << 1 | u128::from(bit);
        }
        value
    }

    /// Bits that what was read so far takes, to their fractions.
    #[must_use]
    pub fn spent(&self) -> f64 {
        // At first four bytes are read ahead, and the range is all of them.
        8.0 * self.at as f64 - libm::log2(f64::from(self.range))
    }

    /// Whether more was read than there is.
    #[must_use]
    pub fn is_beyond(&self) -> bool {
        self.at > self.bytes.len() + READ_PAST
    }

    /// Whether all was read.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        self.at == self.bytes.len() + READ_PAST
    }

    fn settle(&mut self) {
        while self.range < LEAST_RANGE {
            self.shift();
            self.range <<= 8;
        }
    }

    fn shift(&mut self) {
        let next = self.bytes.get(self.at).copied().unwrap_or_default();
        self.above = self.above << 8 | u32::from(next);
        self.at += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::planted::Random;

    /// Bytes of which most are small, with bits of every count between them; also bits that carry far.
    fn coded(seed: u64, count: usize) -> (Vec<(u8, u32, u128)>, Vec<u8>) {
        let mut random = Random(seed);
        let value = |_| {
            let bits = random.bits();
            let byte = (bits as u8) >> (bits >> 8 & 7);
            let count = (bits >> 16) as u32 % 99;
            let ones = bits >> 24 & 1 == 1;
            let plain = (u128::from(bits) * 0x1_0001_0001) & ((1 << count) - 1);
            (byte, count, if ones { (1 << count) - 1 } else { plain })
        };
        let values: Vec<(u8, u32, u128)> = (0..count).map(value).collect();
        let (mut model, mut encoder) = (Model::default(), Encoder::default());
        for &(byte, count, bits) in &values {
            encoder.byte(&mut model, byte);
            encoder.bits(count, bits);
        }
        (values, encoder.finish())
    }

    #[test]
    fn what_is_written_is_read_to_the_last_byte_and_no_farther() {
        for seed in 0..200 {
            let (values, bytes) = coded(seed, seed as usize % 60);
            let (mut model, mut decoder) = (Model::default(), Decoder::new(&bytes));
            for (byte, count, bits) in values {
                assert!(!decoder.is_beyond());
                assert_eq!((decoder.byte(&mut model), decoder.bits(count)), (byte, bits));
            }
            assert!(decoder.is_at_end() && !decoder.is_beyond());
            decoder.bits(8);
            assert!(decoder.is_beyond());
        }
    }

    #[test]
    fn bytes_cost_about_their_entropy() {
        let mut random = Random(3);
        let (mut model, mut encoder) = (Model::default(), Encoder::default());
        let count = 20_000;
        let mut counts = [0_u32; 256];
        for _ in 0..count {
            let byte = (random.bits() as u8 & 7).min(random.bits() as u8 & 31);
            counts[usize::from(byte)] += 1;
            encoder.byte(&mut model, byte);
        }
        let total = f64::from(count);
        let share = counts.iter().filter(|&&n| n > 0).map(|&n| f64::from(n) / total);
        let entropy = share.map(|p| -p * p.log2()).sum::<f64>() * total / 8.0;
        let spent = encoder.finish().len() as f64;
        assert!(spent > entropy && spent < 1.03 * entropy, "{spent} for {entropy}");
    }

    #[test]
    fn what_never_changes_costs_next_to_nothing() {
        let (mut model, mut encoder) = (Model::default(), Encoder::default());
        (0..10_000).for_each(|_| encoder.byte(&mut model, 0xa5));
        assert!(encoder.finish().len() < 32);
    }
}
