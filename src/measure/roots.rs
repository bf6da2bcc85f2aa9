//! Real roots: of a function between two signs, and all of a polynomial's in an interval.

/// Halvings at most; a double's bits are used up by then.
const ROUNDS: usize = 64;

/// Roots are found to this share of the interval at hand. What is minimised at them changes with
/// its square.
const FINE: f64 = 1e-12;

/// A polynomial that comes this near to 0 at an extremum, as a share of the sum of its terms'
/// magnitudes, touches it there but for rounding.
const TOUCH: f64 = 1e-13;

/// A root of `f` between `a` and `b`, where it has the values `fa` and `fb` of opposite signs.
///
/// Chandrupatla 1997: inverse quadratic interpolation where it is safe, else bisection.
pub(super) fn between(f: impl Fn(f64) -> f64, (a, fa): (f64, f64), (b, fb): (f64, f64)) -> f64 {
    let tolerance = FINE * (b - a).abs();
    // b is the newest place, a the one on the other side of the root, c the one before.
    let (mut a, mut fa, mut b, mut fb) = (b, fb, a, fa);
    let (mut c, mut fc);
    let mut t = 0.5;
    for _ in 0..ROUNDS {
        let x = b + t * (a - b);
        let fx = f(x);
        if (fx > 0.0) == (fb > 0.0) {
            (c, fc) = (b, fb);
        } else {
            (c, fc, a, fa) = (a, fa, b, fb);
        }
        (b, fb) = (x, fx);
        let width = (a - b).abs();
        if fb == 0.0 || width <= tolerance {
            break;
        }
        let (xi, phi) = ((b - a) / (c - a), (fb - fa) / (fc - fa));
        let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        t = if safe {
            fb / (fa - fb) * fc / (fa - fc) + (c - b) / (a - b) * fb / (fc - fb) * fa / (fc - fa)
        } else {
            0.5
        };
        let least = 0.5 * tolerance / width;
        t = t.clamp(least, 1.0 - least);
    }
    if fa.abs() < fb.abs() { a } else { b }
}

/// The roots in `[low, high]` of a polynomial given by its coefficients, the constant first;
/// ascending. Where it only touches 0 a root may come twice.
///
/// Between two roots of its derivative it is monotone: each such piece has at most one.
pub(super) fn polynomial(coefficients: &[f64], low: f64, high: f64) -> Vec<f64> {
    let degree = coefficients.len().saturating_sub(1);
    if degree == 0 {
        return Vec::new();
    }
    let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let size = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x.abs() + c.abs());
    let slope: Vec<f64> = (1..=degree).map(|n| n as f64 * coefficients[n]).collect();
    let mut knots = vec![low];
    knots.extend(polynomial(&slope, low, high));
    knots.push(high);
    let values: Vec<f64> = knots.iter().map(|&x| value(x)).collect();
    let mut found = Vec::new();
    for n in 0..knots.len() {
        if values[n].abs() <= TOUCH * size(knots[n]) {
            found.push(knots[n]);
        }
        let next = values.get(n + 1).copied().unwrap_or(0.0);
        if values[n] * next < 0.0 {
            found.push(between(value, (knots[n], values[n]), (knots[n + 1], next)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_roots_come_back() {
        for planted in [vec![0.1, 0.5, 0.7, 0.9], vec![0.25, 0.25, 0.8], vec![-3.0, 0.5, 1e3], vec![0.999]] {
            let expanded = planted.iter().fold(vec![1.0], |p, root| {
                let mut next = vec![0.0; p.len() + 1];
                for (n, c) in p.iter().enumerate() {
                    next[n] -= root * c;
                    next[n + 1] += c;
                }
                next
            });
            let found = polynomial(&expanded, 0.0, 1.0);
            for root in &planted {
                let near = found.iter().any(|x| (x - root).abs() < 1e-6);
                assert_eq!(near, (0.0..=1.0).contains(root), "{planted:?} gave {found:?}");
            }
            for x in found {
                assert!(planted.iter().any(|root| (x - root).abs() < 1e-6), "{planted:?} gave {x}");
            }
        }
        assert!(polynomial(&[1.0, 0.0, 1.0], -9.0, 9.0).is_empty());
        assert!((between(|x| libm::exp(x) - 2.0, (0.0, -1.0), (9.0, 8e3)) - 2.0_f64.ln()).abs() < 1e-10);
    }
}
