//! The axis along which points spread least: the normal of their plane of least squares.
//!
//! The least root of the characteristic polynomial, which Newton's method reaches from zero, and the cross
//! product of two rows of what is left. For the neighbourhoods of 4 million points of a surface that takes a
//! fifth of the time of nalgebra's symmetric eigenvalues, which still answer where the root is not told well
//! from the next.

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// Where two eigenvalues differ by less than this share of their sum, the axis would lose more than a few
/// of its digits.
const APART: f64 = 1e-2;

/// Steps within which the least eigenvalue is found, if it lies so far from the next.
const STEPS: usize = 12;

/// A step of no more than this share of the sum of the eigenvalues ends the search: it is quadratic by then.
const SMALL: f64 = 1e-13;

/// The least axis of a symmetric matrix without negative eigenvalues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeastAxis {
    /// Unit vector, of either sign.
    pub(super) axis: DVec3,
    /// Its eigenvalue.
    pub(super) least: f64,
    /// The next greater eigenvalue.
    pub(super) middle: f64,
}

impl LeastAxis {
    /// That of a matrix which is not zero.
    pub(super) fn of(matrix: &DMat3) -> Self {
        Self::by_rows(matrix).unwrap_or_else(|| Self::by_turns(matrix))
    }

    /// That of a matrix whose least eigenvalue lies well apart from the others.
    fn by_rows(matrix: &DMat3) -> Option<Self> {
        let sum = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        let unit = *matrix * sum.recip();
        let [minors, product] = [minors(&unit), unit.determinant()];
        let least = least_root(minors, product)?;
        // The other two: of this sum, and this product.
        let (rest, product) = (1.0 - least, minors - least * (1.0 - least));
        let middle = 2.0 * product / (rest + (rest * rest - 4.0 * product).max(0.0).sqrt());
        let [x, y, z] = [unit.x_axis, unit.y_axis, unit.z_axis];
        let [x, y, z] = [x - least * DVec3::X, y - least * DVec3::Y, z - least * DVec3::Z];
        let longer = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
        let axis = longer(longer(x.cross(y), y.cross(z)), z.cross(x)).try_normalize()?;
        (middle - least >= APART).then_some(Self { axis, least: least * sum, middle: middle * sum })
    }

    /// That of any matrix.
    fn by_turns(matrix: &DMat3) -> Self {
        let eigen = SymmetricEigen::new(Matrix3::from_column_slice(&matrix.to_cols_array()));
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [least, middle, _] = order;
        let axis = eigen.eigenvectors.column(least);
        Self {
            axis: DVec3::new(axis[0], axis[1], axis[2]).normalize_or(DVec3::Z),
            least: eigen.eigenvalues[least],
            middle: eigen.eigenvalues[middle],
        }
    }
}

/// Sum of the principal minors of a symmetric matrix: for eigenvalues `l0 <= l1 <= l2`, `l0 l1 + l0 l2 + l1 l2`.
pub(super) fn minors(m: &DMat3) -> f64 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    x.x * y.y - x.y * x.y + x.x * z.z - x.z * x.z + y.y * z.z - y.z * y.z
}

/// The least of three eigenvalues whose sum is 1, by the sum of the products of two and the product of all.
///
/// Below it the polynomial falls, ever less steeply, so that no step from zero goes too far. `None` where
/// steps stay long, as they do before a double root.
fn least_root(minors: f64, product: f64) -> Option<f64> {
    let mut root = 0.0_f64;
    for _ in 0..STEPS {
        let value = ((1.0 - root) * root - minors) * root + product;
        let slope = minors - (2.0 - 3.0 * root) * root;
        if slope <= 0.0 {
            return None;
        }
        let step = value / slope;
        root += step;
        if step.abs() <= SMALL {
            return Some(root);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::DQuat;

    use super::*;
    use crate::analyse::planted::random;

    /// A matrix of given eigenvalues, turned at random, and its least axis.
    fn planted(seed: u64, values: DVec3) -> (DMat3, DVec3) {
        let [x, y, z, w] = [0, 1, 2, 3].map(|k| random(4 * seed + k));
        let turn = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize());
        (turn * DMat3::from_diagonal(values) * turn.transpose(), turn.x_axis)
    }

    #[test]
    fn both_ways_find_planted_axes() {
        for seed in 0..2000 {
            let [thin, wide] = [1000, 1001].map(|k| 0.5 + 0.5 * random(3000 * seed + k));
            let scale = libm::exp2(40.0 * random(seed));
            let values = scale * DVec3::new(0.2 * thin * (0.1 + wide), 0.1 + wide, 1.2);
            let (matrix, axis) = planted(seed, values);
            for found in [LeastAxis::by_rows(&matrix).unwrap(), LeastAxis::by_turns(&matrix)] {
                assert!(found.axis.cross(axis).length() < 1e-12, "{values}: {found:?}");
                assert!((found.least - values.x).abs() < 1e-12 * scale);
                assert!((found.middle - values.y).abs() < 1e-12 * scale);
            }
        }
    }

    #[test]
    fn flat_and_straight_and_round_neighbourhoods_have_an_axis() {
        for seed in 0..200 {
            let flat = DVec3::new(0.0, 0.7, 1.0);
            let (matrix, axis) = planted(seed, flat);
            let found = LeastAxis::by_rows(&matrix).unwrap();
            assert!(found.axis.cross(axis).length() < 1e-14 && found.least.abs() < 1e-15);
            // Any axis across a straight line will do, and any at all for a ball.
            for values in [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1e-9, 3e-9, 1.0), DVec3::ONE] {
                let (matrix, _) = planted(seed, values);
                assert_eq!(LeastAxis::by_rows(&matrix), None, "{values}");
                let found = LeastAxis::of(&matrix);
                let off = (matrix * found.axis - found.least * found.axis).length();
                assert!(off < 1e-14 && (found.axis.length() - 1.0).abs() < 1e-14);
            }
        }
    }
}
