//! Sine and cosine of a fraction of a turn, with the same bits from every decoder.
//!
//! The decoder predicts from splats it has decoded, so two decoders must agree in the last
//! bit. Only `+ - * /` are used, which IEEE 754 fixes; a platform's `sin` is not fixed.

/// An eighth of a turn in radians, `pi / 4`.
const EIGHTH: f64 = std::f64::consts::FRAC_PI_4;

/// Sine and cosine of `number / count` of a full turn; `number < count < 2^60`.
///
/// The angle is reduced to the first eighth of a turn in whole numbers. There the Taylor
/// series to the 15th and 16th order leave an error below 5e-17.
#[must_use]
pub fn sin_cos(number: u64, count: u64) -> (f64, f64) {
    let eighths = 8 * number;
    let (octant, rest) = (eighths / count, eighths % count);
    let part = if octant % 2 == 0 { rest } else { count - rest };
    let x = part as f64 / count as f64 * EIGHTH;
    let (sin, cos) = (sine(x), cosine(x));
    match octant {
        0 => (sin, cos),
        1 => (cos, sin),
        2 => (cos, -sin),
        3 => (sin, -cos),
        4 => (-sin, -cos),
        5 => (-cos, -sin),
        6 => (-cos, sin),
        _ => (-sin, cos),
    }
}

/// `x - x³/3! + ... - x¹⁵/15!`, nested.
fn sine(x: f64) -> f64 {
    let square = x * x;
    x * [210.0, 156.0, 110.0, 72.0, 42.0, 20.0, 6.0].iter().fold(1.0, |sum, k| 1.0 - square * sum / k)
}

/// `1 - x²/2! + ... + x¹⁶/16!`, nested.
fn cosine(x: f64) -> f64 {
    let square = x * x;
    [240.0, 182.0, 132.0, 90.0, 56.0, 30.0, 12.0, 2.0].iter().fold(1.0, |sum, k| 1.0 - square * sum / k)
}

#[cfg(test)]
#[allow(clippy::print_stdout, clippy::float_cmp)]
mod tests {
    use super::sin_cos;

    #[test]
    fn agrees_with_libm_to_the_last_bits() {
        let mut worst = 0.0_f64;
        for count in [1, 2, 3, 8, 100, 4096, 99_991] {
            for number in (0..count).step_by(1 + count as usize / 5000) {
                let angle = std::f64::consts::TAU * number as f64 / count as f64;
                let (sin, cos) = sin_cos(number, count);
                worst = worst.max((sin - libm::sin(angle)).abs()).max((cos - libm::cos(angle)).abs());
                assert!((sin * sin + cos * cos - 1.0).abs() < 4e-16);
            }
        }
        // The reference angle itself is off by up to 1.6e-15 near a full turn.
        println!("worst difference {worst:e}");
        assert!(worst < 2e-15);
    }

    #[test]
    fn quarter_turns_are_exact() {
        for (number, sin, cos) in [(0, 0.0, 1.0), (1, 1.0, 0.0), (2, 0.0, -1.0), (3, -1.0, 0.0)] {
            assert_eq!(sin_cos(number, 4), (sin, cos));
        }
    }
}
