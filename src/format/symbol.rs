//! A whole number as a *symbol*, which says about how large it is, and *extra bits*, which are
//! noise.

/// Numbers below this are symbols of their own.
const PLAIN: u128 = 8;

/// Bits of the largest number a symbol may stand for.
pub const WIDEST: u32 = 100;

/// Splits a number into its symbol and its extra bits: `(symbol, bits, count of bits)`.
///
/// From 8 on, a symbol is the number's length and its second bit: 8 for 8 to 11, 9 for 12 to
/// 15, 10 for 16 to 23, and so on.
#[must_use]
pub fn split(value: u128) -> (u8, u128, u32) {
    if value < PLAIN {
        return (value as u8, 0, 0);
    }
    let length = 128 - value.leading_zeros();
    let extra = length - 2;
    let second = (value >> extra) as u32 & 1;
    let symbol = 8 + 2 * (length - 4) + second;
    (symbol as u8, value & ((1 << extra) - 1), extra)
}

/// The least number of a symbol and its count of extra bits; `None` above [`WIDEST`].
#[must_use]
pub fn base(symbol: u8) -> Option<(u128, u32)> {
    let symbol = u32::from(symbol);
    if symbol < 8 {
        return Some((u128::from(symbol), 0));
    }
    let extra = (symbol - 8) / 2 + 2;
    let top = 2 + u128::from(symbol % 2);
    (extra + 2 <= WIDEST).then_some((top << extra, extra))
}

/// Signed to unsigned: 0, -1, 1, -2, 2 become 0, 1, 2, 3, 4.
#[must_use]
pub fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// Undoes [`zigzag`].
#[must_use]
pub fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_split_and_join() {
        let near_powers = (0..99).flat_map(|n| [(1_u128 << n) - 1, 1 << n, (1 << n) + 1, 3 << n >> 1]);
        for value in (0..5000).chain(near_powers) {
            let (symbol, extra, count) = split(value);
            assert_eq!(base(symbol), Some((value - extra, count)));
            assert!(extra < 1 << count);
        }
        assert_eq!([8, 11, 12, 15, 16, 23, 24].map(|v| split(v).0), [8, 8, 9, 9, 10, 10, 11]);
        assert_eq!(base(255), None);
        for value in [0, -1, 1, 77, -78, i64::MAX >> 2, i64::MIN >> 2] {
            assert_eq!(unzigzag(zigzag(value)), value);
        }
    }
}
