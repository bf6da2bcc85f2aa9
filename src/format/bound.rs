//! How far a quadric moves when its numbers are rounded: an upper bound, not a sample.
//!
//! Let `S` be the splat before rounding and `S'` after. A point of `S` over the unit disc's
//! `(x, y)` is `C + A (r_u x, r_v y, s_u x² + s_v y²)` with the sagittas `s`. In the frame of
//! `S'` its coordinates `u', v', w'` are polynomials of degree two in `(x, y)`, so its distance
//! along `k'` to the quadric of `S'`,
//!
//! ```text
//! e(x, y) = w' - a' u'² - b' v'²
//! ```
//!
//! is a polynomial of degree four. Its coefficients are worked out and each degree is bounded
//! over the disc: constant and quadratic part together by the eigenvalues of the form, the
//! linear part by the length of its gradient, a cubic or quartic monomial `x^p y^q` by its
//! maximum `sqrt(p^p q^q / (p+q)^(p+q))`. The sum of the bounds bounds `|e|`.
//!
//! A point that lies `d` off `S` along `k` is carried to within `d (1 + slope)` where the
//! slope is at most `|k x k'|` times the steepest slope of `S'`; that part is added for `d` up
//! to the share of the fit, so that the sum of both shares holds for the input's points.

use glam::{DMat2, DVec2, DVec3};

use crate::model::splat::Splat;
use crate::tolerance::FIT_SHARE;

/// Powers `(p, q)` of `x^p y^q` up to degree four.
#[cfg(test)]
const POWERS: [(usize, usize); 15] = [
    (0, 0),
    (1, 0),
    (0, 1),
    (2, 0),
    (1, 1),
    (0, 2),
    (3, 0),
    (2, 1),
    (1, 2),
    (0, 3),
    (4, 0),
    (3, 1),
    (2, 2),
    (1, 3),
    (0, 4),
];

/// Largest value of each cubic and quartic monomial over the unit disc.
const HIGH: [f64; 9] = [1.0, 0.384_900_2, 0.384_900_2, 1.0, 1.0, 0.324_759_6, 0.25, 0.324_759_6, 1.0];

/// A polynomial of degree at most four; coefficients degree by degree, `x` first.
type Quartic = [f64; 15];

/// A polynomial of degree two: `1, x, y, x², y²`.
type Quadratic = [f64; 5];

/// Powers of the terms of a [`Quadratic`].
const QUADRATIC: [(usize, usize); 5] = [(0, 0), (1, 0), (0, 1), (2, 0), (0, 2)];

fn place((p, q): (usize, usize)) -> usize {
    let degree = p + q;
    degree * (degree + 1) / 2 + q
}

/// `sum += factor * f²`.
fn add_square(sum: &mut Quartic, f: &Quadratic, factor: f64) {
    for (n, (p, q)) in QUADRATIC.iter().enumerate() {
        for (m, (s, t)) in QUADRATIC.iter().enumerate() {
            sum[place((p + s, q + t))] += factor * f[n] * f[m];
        }
    }
}

/// Two splats compared.
pub struct Moved {
    /// Coordinates of the first splat's points in the second's frame.
    local: [Quadratic; 3],
    /// `k` of the first in the frame of the second.
    k: DVec3,
    /// Least and greatest height of the first over its own plane.
    heights: (f64, f64),
    /// Columns of the map of the plane onto the plane.
    plane: DMat2,
    radii: DVec2,
    curvature: DVec2,
}

impl Moved {
    /// Compares a splat with what it was rounded to.
    #[must_use]
    pub fn new(from: &Splat, to: &Splat) -> Self {
        let shift = to.axes.transpose() * (from.center - to.center);
        let turn = to.axes.transpose() * from.axes;
        let sagitta = from.curvature * from.radii * from.radii;
        let k = turn.z_axis;
        let local = [0, 1, 2].map(|n| {
            [
                shift[n],
                turn.x_axis[n] * from.radii.x,
                turn.y_axis[n] * from.radii.y,
                k[n] * sagitta.x,
                k[n] * sagitta.y,
            ]
        });
        Self {
            local,
            k,
            heights: (sagitta.min_element().min(0.0), sagitta.max_element().max(0.0)),
            plane: DMat2::from_cols(turn.x_axis.truncate(), turn.y_axis.truncate()),
            radii: to.radii,
            curvature: to.curvature,
        }
    }

    /// The bound on `|e|` over the first splat's domain, the share of points off it included.
    #[must_use]
    pub fn height(&self, budget: f64) -> f64 {
        let mut e: Quartic = [0.0; 15];
        for (n, power) in QUADRATIC.iter().enumerate() {
            e[place(*power)] += self.local[2][n];
        }
        add_square(&mut e, &self.local[0], -self.curvature.x);
        add_square(&mut e, &self.local[1], -self.curvature.y);
        let (mean, half) = (0.5 * (e[3] + e[5]), libm::hypot(0.5 * (e[3] - e[5]), 0.5 * e[4]));
        let even = (e[0] + (mean + half).max(0.0)).abs().max((e[0] + (mean - half).min(0.0)).abs());
        let odd = libm::hypot(e[1], e[2]);
        let high: f64 = e[6..].iter().zip(HIGH).map(|(c, most)| c.abs() * most).sum();
        even + odd + high + self.off_surface(FIT_SHARE * budget)
    }

    /// How much more than `d` a point `d` off the first splat may lie off the second.
    fn off_surface(&self, d: f64) -> f64 {
        let slope = 2.0 * (self.curvature * self.radii).abs().max_element();
        let tilt = self.k.truncate().length();
        d * tilt * (slope + self.curvature.abs().max_element() * d * tilt)
    }

    /// In the second splat's plane, where the middle of the first's heights is carried to,
    /// less the plane map itself: `(u', v') = plane (u, v) + offset`.
    #[must_use]
    pub fn offset(&self) -> DVec2 {
        let middle = 0.5 * (self.heights.0 + self.heights.1);
        DVec2::new(self.local[0][0], self.local[1][0]) + self.k.truncate() * middle
    }

    /// The map of the first splat's plane to the second's.
    #[must_use]
    pub fn plane(&self) -> DMat2 {
        self.plane
    }

    /// How far the true place in the second's plane may be from the affine map's.
    #[must_use]
    pub fn bend_of_plane(&self) -> f64 {
        self.k.truncate().length() * 0.5 * (self.heights.1 - self.heights.0)
    }

    /// For each radius, how far the first's domain reaches in units of the second's radii; and
    /// an upper bound of its farthest point in the second's ellipse norm.
    #[must_use]
    pub fn reach(&self) -> (DVec2, f64) {
        let scale = self.radii.recip();
        let row = |n: usize| DVec2::new(self.local[n][1], self.local[n][2]) * scale[n];
        let (x, y) = (row(0), row(1));
        let bend = self.k.truncate().abs() * (0.5 * (self.heights.1 - self.heights.0));
        let offset = (self.offset().abs() + bend) * scale;
        // The greatest singular value of the 2x2 matrix with these rows.
        let (mean, half) = (
            0.5 * (x.length_squared() + y.length_squared()),
            libm::hypot(0.5 * (x.length_squared() - y.length_squared()), x.dot(y)),
        );
        let norm = (mean + half).sqrt() + offset.length();
        (DVec2::new(x.length() + offset.x, y.length() + offset.y), norm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_number_the_powers_in_order() {
        for (n, power) in POWERS.iter().enumerate() {
            assert_eq!(place(*power), n);
        }
    }

    #[test]
    fn monomial_maxima_are_upper_bounds_and_are_met() {
        for (n, (p, q)) in POWERS[6..].iter().enumerate() {
            let most = (0..100_000)
                .map(|t| {
                    let (sin, cos) = libm::sincos(f64::from(t) * 1e-4);
                    (cos.powi(*p as i32) * sin.powi(*q as i32)).abs()
                })
                .fold(0.0, f64::max);
            assert!(most <= HIGH[n] && most > 0.999 * HIGH[n], "{p} {q}: {most}");
        }
    }
}
