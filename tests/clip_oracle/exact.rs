//! The clip test without rounding, on integers of any length.
//!
//! A 64-bit float is an integer times a power of two. All coordinates of a case are brought to
//! one power, which no predicate minds, and then only sums and products are needed.

use glam::DVec2;
use qsplat::model::clip_curve::Conic;

/// A signed integer of any length: little-endian digits in base 2³², and its sign.
#[derive(Clone, Debug, PartialEq)]
struct Integer {
    negative: bool,
    digits: Vec<u32>,
}

impl Integer {
    /// `mantissa * 2^shift`.
    fn new(mantissa: i64, shift: u32) -> Self {
        let mut digits = vec![0; (shift / 32) as usize];
        let mut rest = u128::from(mantissa.unsigned_abs()) << (shift % 32);
        while rest > 0 {
            digits.push(rest as u32);
            rest >>= 32;
        }
        Self { negative: mantissa < 0, digits }.trimmed()
    }

    fn trimmed(mut self) -> Self {
        while self.digits.last() == Some(&0) {
            self.digits.pop();
        }
        self.negative &= !self.digits.is_empty();
        self
    }

    /// -1, 0 or 1.
    fn sign(&self) -> i32 {
        if self.digits.is_empty() { 0 } else { 1 - 2 * i32::from(self.negative) }
    }

    fn negated(&self) -> Self {
        Self { negative: !self.negative, digits: self.digits.clone() }.trimmed()
    }

    fn plus(&self, other: &Self) -> Self {
        let length = self.digits.len().max(other.digits.len()) + 1;
        // Two's complement of both, added; then back.
        let (a, b) = (self.complement(length), other.complement(length));
        let mut carry = 0_u64;
        let mut digits: Vec<u32> = a
            .iter()
            .zip(&b)
            .map(|(&a, &b)| {
                let sum = u64::from(a) + u64::from(b) + carry;
                carry = sum >> 32;
                sum as u32
            })
            .collect();
        let negative = digits.last().is_some_and(|top| top >> 31 == 1);
        if negative {
            digits = Self { negative, digits }.complement(length);
        }
        Self { negative, digits }.trimmed()
    }

    /// The digits of the number in two's complement.
    fn complement(&self, length: usize) -> Vec<u32> {
        let mut digits = self.digits.clone();
        digits.resize(length, 0);
        if self.negative {
            let mut carry = true;
            for digit in &mut digits {
                let (sum, over) = (!*digit).overflowing_add(u32::from(carry));
                (*digit, carry) = (sum, over);
            }
        }
        digits
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }

    fn times(&self, other: &Self) -> Self {
        let mut digits = vec![0_u32; self.digits.len() + other.digits.len()];
        for (i, &a) in self.digits.iter().enumerate() {
            let mut carry = 0_u64;
            for (j, &b) in other.digits.iter().enumerate() {
                let sum = u64::from(a) * u64::from(b) + u64::from(digits[i + j]) + carry;
                digits[i + j] = sum as u32;
                carry = sum >> 32;
            }
            digits[i + other.digits.len()] = carry as u32;
        }
        Self { negative: self.negative != other.negative, digits }.trimmed()
    }
}

/// A finite float as `mantissa * 2^exponent`; 0 has no exponent to speak of.
fn parts(x: f64) -> (i64, i32) {
    let (fraction, exponent) = libm::frexp(x);
    (libm::ldexp(fraction, 53) as i64, exponent - 53)
}

/// Floats as integers times one power of two that all share.
fn shared<const N: usize>(floats: [f64; N]) -> [Integer; N] {
    let least = floats.iter().filter(|x| **x != 0.0).map(|x| parts(*x).1).min().unwrap_or(0);
    floats.map(|x| match parts(x) {
        (0, _) => Integer::new(0, 0),
        (mantissa, exponent) => Integer::new(mantissa, (exponent - least) as u32),
    })
}

/// Twice the signed area of a triangle.
fn turn(a: &[Integer; 2], b: &[Integer; 2], c: &[Integer; 2]) -> Integer {
    let (bx, by) = (b[0].minus(&a[0]), b[1].minus(&a[1]));
    let (cx, cy) = (c[0].minus(&a[0]), c[1].minus(&a[1]));
    bx.times(&cy).minus(&by.times(&cx))
}

/// Whether a point lies to the right of the curve, decided without rounding.
///
/// In barycentric coordinates `(x, y, z)` over `P1, P2, P3` the conic of weight `w` is
/// `y² = 4 w² x z` (Farin, NURBS, 4.3), its bulge the part of the triangle where
/// `y² < 4 w² x z`; with `w = rho/(1-rho)` both sides are taken times `(1-rho)²`.
pub fn cuts(conic: &Conic, q: DVec2) -> bool {
    let [p1, p2, p3, q] = {
        let [a, b, c, d, e, f, g, h] =
            shared([conic.p1.x, conic.p1.y, conic.p2.x, conic.p2.y, conic.p3.x, conic.p3.y, q.x, q.y]);
        [[a, b], [c, d], [e, f], [g, h]]
    };
    let [rho, one] = shared([conic.rho, 1.0]);
    let left_of_chord = turn(&p1, &p3, &q).sign() >= 0;
    let area = turn(&p1, &p2, &p3);
    if conic.rho == 0.0 || area.sign() == 0 {
        return !left_of_chord;
    }
    let oriented = |x: Integer| if area.sign() < 0 { x.negated() } else { x };
    let x = oriented(turn(&q, &p2, &p3));
    let y = oriented(turn(&q, &p3, &p1));
    let z = oriented(turn(&q, &p1, &p2));
    let within = x.sign() > 0 && y.sign() > 0 && z.sign() > 0;
    let rest = one.minus(&rho);
    let straight = rest.times(&rest).times(&y.times(&y));
    let four = Integer::new(4, 0);
    let curved = four.times(&rho.times(&rho)).times(&x.times(&z));
    let inner = y.sign() <= 0 || within && straight.minus(&curved).sign() < 0;
    // A curve that turns left at P2 has the inner region on its left.
    if area.sign() > 0 { !inner } else { inner }
}

#[test]
fn integers_add_and_multiply() {
    let mut state = 3_i64;
    for _ in 0..2000 {
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> (state & 31)
        };
        let (a, b) = (draw(), draw());
        let whole = |x: i128| {
            let (high, low) = ((x >> 62) as i64, (x & ((1 << 62) - 1)) as i64);
            Integer::new(high, 62).plus(&Integer::new(low, 0))
        };
        let (x, y) = (Integer::new(a, 0), Integer::new(b, 0));
        assert_eq!(x.plus(&y), whole(i128::from(a) + i128::from(b)));
        assert_eq!(x.minus(&y), whole(i128::from(a) - i128::from(b)));
        assert_eq!(x.times(&y), whole(i128::from(a) * i128::from(b)));
    }
    assert_eq!(Integer::new(1, 100).minus(&Integer::new(1, 100)).sign(), 0);
}
