//! The slope of a line through points on two logarithmic axes.

/// The exponent `s` of `y = c x^s` through `(x, y)` pairs, by least squares of `log y`.
///
/// Pairs that have no logarithm are left aside; `None` where fewer than two different `x` remain.
#[must_use]
pub fn log_log_slope(pairs: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = pairs
        .iter()
        .filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
        .map(|&(x, y)| (libm::log(x), libm::log(y)))
        .collect();
    let count = logs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|log| log.0), mean(|log| log.1));
    let spread: f64 = logs.iter().map(|log| (log.0 - x) * (log.0 - x)).sum();
    let together: f64 = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum();
    (spread > LEAST_SPREAD).then(|| together / spread)
}

/// Sums of squared deviations of logarithms below this are rounding: the `x` are one value.
const LEAST_SPREAD: f64 = 1e-20;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_planted_power_comes_back() {
        for power in [-1.0, -2.0 / 3.0, -0.5, 0.0, 2.0] {
            let pairs: Vec<(f64, f64)> =
                [3e-4, 1e-3, 3e-3, 1e-2].iter().map(|&x: &f64| (x, 7.0 * x.powf(power))).collect();
            assert!((log_log_slope(&pairs).unwrap() - power).abs() < 1e-12);
        }
    }

    #[test]
    fn disturbances_that_cancel_do_not_count() {
        // At x = e^-1, 1, e, factors with logarithms 1, -2, 1 are orthogonal to constant and slope.
        let e = std::f64::consts::E;
        let pairs = [(1.0 / e, e * e * e), (1.0, 1.0 / (e * e)), (e, e / (e * e))];
        assert!((log_log_slope(&pairs).unwrap() + 2.0).abs() < 1e-12);
    }

    #[test]
    fn too_little_has_no_slope() {
        assert_eq!(log_log_slope(&[]), None);
        assert_eq!(log_log_slope(&[(1.0, 2.0)]), None);
        assert_eq!(log_log_slope(&[(0.1, 2.0), (0.1, 3.0)]), None);
        assert_eq!(log_log_slope(&[(1.0, 2.0), (0.0, 3.0), (2.0, f64::NAN), (3.0, -1.0)]), None);
    }
}
