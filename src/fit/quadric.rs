//! The least-squares quadric `w = h + c u + d v + a u² + e uv + b v²` through points.
//!
//! Ivo 2020, section 4.2, with a constant and a mixed term so that the frame can be moved
//! and turned until they vanish. Coordinates are divided by the domain's radius first, so
//! that the conditioning does not depend on the size of the splat.

use nalgebra::{SMatrix, SVector};

type Normal = SMatrix<f64, 6, 6>;
type Right = SVector<f64, 6>;

/// A pivot of the Cholesky factor below this share of the mean square of its column means
/// that the points do not fix that term: they lie nearly on a line or a conic. The normal
/// equations square the condition number, so this stands for about `1e-5` of the design's.
const WEAK_PIVOT: f64 = 1e-10;

/// Weight, a point, of keeping the second-order terms small (ridge regression, Hoerl and
/// Kennard 1970). Points in a band narrower than about a twentieth of the radius leave the
/// curvature across it to noise, and there this decides; elsewhere it weighs a millionth.
pub const RIDGE: f64 = 1e-7;

/// The same for a quadric that came out too steep at its rim: curvature across a band narrower
/// than a third of the radius goes, where a point may say nothing but its own error, and the
/// curvature along it shrinks by a hundredth.
pub const STIFF_RIDGE: f64 = 1e-3;

/// The same for a term that must go: what is left of it is lost in rounding.
pub const NONE_LEFT: f64 = 1e9;

/// Height over a plane as a full quadratic polynomial, in the units of its moments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Height {
    /// Constant.
    pub h: f64,
    /// Coefficient of `u`.
    pub c: f64,
    /// Coefficient of `v`.
    pub d: f64,
    /// Coefficient of `u²`.
    pub a: f64,
    /// Coefficient of `uv`.
    pub e: f64,
    /// Coefficient of `v²`.
    pub b: f64,
    /// How many of the six the points determined; the others are the least that fit
    /// (6 a quadric, fewer where the points lie on a conic or a line: a parabolic cylinder,
    /// a plane).
    pub rank: u8,
}

/// Powers `u^p v^q` up to the fourth degree.
const POWERS: usize = 15;

/// Which power each entry of the normal equations is the sum of: line `n` times column `m` of
/// `1, u, v, u², uv, v²`.
const PRODUCTS: [[usize; 6]; 6] = [
    [0, 1, 2, 3, 4, 5],
    [1, 3, 4, 6, 7, 8],
    [2, 4, 5, 7, 8, 9],
    [3, 6, 7, 10, 11, 12],
    [4, 7, 8, 11, 12, 13],
    [5, 8, 9, 12, 13, 14],
];

/// Sums of `u^p v^q w^s` over points: all that a fit needs, additive over sets of points.
#[derive(Clone, Debug)]
pub struct Moments {
    /// Of `1, u, v, u², uv, v², u³, u²v, uv², v³, u⁴, u³v, u²v², uv³, v⁴`.
    powers: [f64; POWERS],
    /// Of the first six of these times `w`.
    right: [f64; 6],
    radius: f64,
}

impl Moments {
    /// No points yet. `radius` is the unit of `u` and `v`, and must be positive.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        Self { powers: [0.0; POWERS], right: [0.0; 6], radius }
    }

    /// Adds a point given in the frame's coordinates, counted `weight` times.
    #[inline]
    pub fn add(&mut self, u: f64, v: f64, w: f64, weight: f64) {
        let (u, v) = (u / self.radius, v / self.radius);
        let [uu, uv, vv] = [u * u, u * v, v * v];
        let powers = [
            1.0,
            u,
            v,
            uu,
            uv,
            vv,
            uu * u,
            uu * v,
            u * vv,
            vv * v,
            uu * uu,
            uu * uv,
            uu * vv,
            uv * vv,
            vv * vv,
        ];
        for (sum, power) in self.powers.iter_mut().zip(powers) {
            *sum += weight * power;
        }
        for (sum, power) in self.right.iter_mut().zip(powers) {
            *sum += weight * w * power;
        }
    }

    /// The normal equations.
    fn equations(&self) -> (Normal, Right) {
        let normal = Normal::from_fn(|line, column| self.powers[PRODUCTS[line][column]]);
        (normal, Right::from(self.right))
    }

    /// The least-squares plane: a height whose second-order terms are zero.
    #[must_use]
    pub fn solve_plane(&self) -> Height {
        let second_order = 3..6;
        let (mut normal, mut right) = self.equations();
        for term in second_order {
            normal.fill_row(term, 0.0);
            normal.fill_column(term, 0.0);
            right[term] = 0.0;
        }
        let (x, rank) = least_norm(&normal, &right);
        Height { h: x[0], c: x[1] / self.radius, d: x[2] / self.radius, rank, ..Height::default() }
    }

    /// The least-squares polynomial; of all that fit equally well, the least.
    ///
    /// `ridge` is the weight, a point, of keeping the second-order terms small, as [`RIDGE`], and `mixed` that of
    /// keeping the one of `u` and `v` small.
    #[must_use]
    pub fn solve(&self, ridge: f64, mixed: f64) -> Height {
        let count = self.powers[0];
        if count == 0.0 {
            return Height::default();
        }
        let (plain, right) = self.equations();
        let mut normal = plain;
        for (second_order, ridge) in [(3, ridge), (4, mixed), (5, ridge)] {
            normal[(second_order, second_order)] += ridge * count;
        }
        let (x, rank) = match cholesky(&normal, &right) {
            Some(x) => (x, 6),
            None => least_norm(&plain, &right),
        };
        let (one, two) = (1.0 / self.radius, 1.0 / (self.radius * self.radius));
        Height { h: x[0], c: x[1] * one, d: x[2] * one, a: x[3] * two, e: x[4] * two, b: x[5] * two, rank }
    }
}

/// Solves the normal equations from their lower triangle, or `None` where a pivot is weak.
fn cholesky(normal: &Normal, right: &Right) -> Option<Right> {
    let mut factor = *normal;
    for column in 0..6 {
        let whole = factor[(column, column)];
        let mut pivot = whole;
        for k in 0..column {
            pivot -= factor[(column, k)] * factor[(column, k)];
        }
        if !(pivot > WEAK_PIVOT * normal[(0, 0)] && pivot > WEAK_PIVOT * whole) {
            return None;
        }
        let root = pivot.sqrt();
        factor[(column, column)] = root;
        for line in column + 1..6 {
            let mut sum = factor[(line, column)];
            for k in 0..column {
                sum -= factor[(line, k)] * factor[(column, k)];
            }
            factor[(line, column)] = sum / root;
        }
    }
    let mut x = *right;
    for line in 0..6 {
        for k in 0..line {
            x[line] -= factor[(line, k)] * x[k];
        }
        x[line] /= factor[(line, line)];
    }
    for line in (0..6).rev() {
        for k in line + 1..6 {
            x[line] -= factor[(k, line)] * x[k];
        }
        x[line] /= factor[(line, line)];
    }
    Some(x)
}

/// The least-norm solution by the eigenvectors of the normal matrix, and its rank.
fn least_norm(normal: &Normal, right: &Right) -> (Right, u8) {
    let eigen = normal.symmetric_eigen();
    let least = WEAK_PIVOT.max(f64::EPSILON) * eigen.eigenvalues.max();
    let mut x = Right::zeros();
    let mut rank = 0;
    for n in 0..6 {
        let value = eigen.eigenvalues[n];
        if value > least {
            let axis = eigen.eigenvectors.column(n);
            x += axis * (axis.dot(right) / value);
            rank += 1;
        }
    }
    (x, rank)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planted(height: Height, points: &[(f64, f64)], radius: f64) -> Height {
        let mut moments = Moments::new(radius);
        for &(u, v) in points {
            let w = height.h
                + height.c * u
                + height.d * v
                + height.a * u * u
                + height.e * u * v
                + height.b * v * v;
            moments.add(u, v, w, 1.0);
        }
        moments.solve(RIDGE, RIDGE)
    }

    fn disc(radius: f64) -> Vec<(f64, f64)> {
        (1..60)
            .map(|n| {
                let (sin, cos) = libm::sincos(2.4 * f64::from(n));
                let r = radius * (f64::from(n) / 60.0).sqrt();
                (r * cos, r * sin)
            })
            .collect()
    }

    #[test]
    fn a_planted_quadric_comes_back_at_any_size() {
        for radius in [1e-9, 1e-3, 1.0, 1e6] {
            let (c, a) = (0.3, 0.7 / radius);
            let plant = Height { h: 0.1 * radius, c, d: -0.2, a, e: -0.4 * a, b: -2.0 * a, rank: 6 };
            let found = planted(plant, &disc(radius), radius);
            assert_eq!(found.rank, 6);
            for (x, y) in [(found.h, plant.h), (found.a, plant.a), (found.e, plant.e), (found.b, plant.b)] {
                assert!((x - y).abs() <= 1e-5 * plant.b.abs().max(plant.h), "{x} {y} at {radius}");
            }
        }
    }

    #[test]
    fn a_plane_halves_the_sagitta_of_a_bowl_and_keeps_a_slope() {
        let points = disc(0.5);
        let mut moments = Moments::new(0.5);
        for &(u, v) in &points {
            moments.add(u, v, 0.3 * u - 0.1 * v + u * u + v * v, 1.0);
        }
        let plane = moments.solve_plane();
        // The mean of u² + v² over points spread evenly over a disc is half that of its rim.
        assert!((plane.h - 0.125).abs() < 5e-3, "{plane:?}");
        assert!((plane.c - 0.3).abs() < 2e-2 && (plane.d + 0.1).abs() < 2e-2, "{plane:?}");
        assert!(plane.a == 0.0 && plane.e == 0.0 && plane.b == 0.0 && plane.rank == 3);
    }

    #[test]
    fn points_on_a_line_give_a_cylinder_along_it() {
        let line: Vec<_> = (-10..=10).map(|n| (f64::from(n) * 0.1, 0.0)).collect();
        let found = planted(Height { a: 0.5, h: 0.2, ..Height::default() }, &line, 1.0);
        assert!(found.rank == 3, "{found:?}");
        assert!((found.a - 0.5).abs() < 1e-9 && found.b.abs() < 1e-9 && found.d.abs() < 1e-9);
    }

    #[test]
    fn a_stiff_fit_leaves_out_the_curvature_across_a_strip_of_noise() {
        // A strip a fifth of its length wide, curved along it, its two sides a little apart.
        let mut moments = Moments::new(1.0);
        for n in -20_i32..=20 {
            let u = 0.05 * f64::from(n);
            for side in [-1.0, 0.0, 1.0] {
                moments.add(u, 0.1 * side, 0.3 * u * u + 0.01 * side * side, 1.0);
            }
        }
        let (soft, stiff) = (moments.solve(RIDGE, RIDGE), moments.solve(STIFF_RIDGE, STIFF_RIDGE));
        assert!((soft.b - 1.0).abs() < 0.01 && (soft.a - 0.3).abs() < 1e-3, "{soft:?}");
        assert!(stiff.b.abs() < 0.1 && (stiff.a - 0.3).abs() < 0.01, "{stiff:?}");
    }

    #[test]
    fn one_point_gives_a_plane_through_it() {
        let found = planted(Height { h: 3.0, ..Height::default() }, &[(0.0, 0.0)], 1.0);
        assert!((found.h - 3.0).abs() < 1e-12 && found.a.abs() < 1e-12);
    }
}
