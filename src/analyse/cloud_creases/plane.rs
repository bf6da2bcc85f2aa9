//! Planes of total least squares, from moments that are summed as points come.

use glam::{DMat3, DVec3};

/// Sums over points: how many, where, and how they spread.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    count: f64,
    sum: DVec3,
    /// Sums of the products `xx yy zz` and `xy xz yz`.
    squares: [DVec3; 2],
}

/// A plane, in the unit of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// Mean of the points.
    pub(super) middle: DVec3,
    /// Unit normal, of either sign.
    pub(super) normal: DVec3,
    /// Variance of the points along the plane in the direction in which they spread less.
    pub(super) width: f64,
}

/// A spread whose eigenvalues differ by less than this share of their mean has no directions; nor has
/// one whose two least do.
const ROUND: f64 = 1e-9;

impl Moments {
    /// The moments of points.
    pub(super) fn of(points: impl Iterator<Item = DVec3>) -> Self {
        points.fold(Self::default(), Self::with)
    }

    /// With one point more.
    #[must_use]
    pub(super) fn with(mut self, p: DVec3) -> Self {
        self.count += 1.0;
        self.sum += p;
        self.squares[0] += p * p;
        self.squares[1] += DVec3::new(p.x * p.y, p.x * p.z, p.y * p.z);
        self
    }

    /// Second moments about the mean: the diagonal, and the elements `xy xz yz` beside it.
    fn spread(&self) -> [DVec3; 2] {
        let m = self.sum / self.count;
        let [diagonal, beside] = self.squares.map(|sum| sum / self.count);
        [diagonal - m * m, beside - DVec3::new(m.x * m.y, m.x * m.z, m.y * m.z)]
    }

    /// About the variance across the plane, from below: `l0 l1 l2 / (l0 l1 + l0 l2 + l1 l2)` of the
    /// spread's eigenvalues, for which none of them needs to be known.
    pub(super) fn thickness(&self) -> f64 {
        let [d, o] = self.spread();
        let minors = d.x * d.y - o.x * o.x + d.x * d.z - o.y * o.y + d.y * d.z - o.z * o.z;
        if minors > 0.0 { matrix(d, o).determinant() / minors } else { 0.0 }
    }

    /// The plane; `None` for points along a line or at one place.
    ///
    /// Eigenvalues in closed form (Smith 1961, "Eigenvalues of a symmetric 3 x 3 matrix").
    pub(super) fn plane(&self) -> Option<Plane> {
        let [d, o] = self.spread();
        let mean = d.element_sum() / 3.0;
        let off = d - mean;
        let radius = ((off.length_squared() + 2.0 * o.length_squared()) / 6.0).sqrt();
        if radius <= ROUND * mean {
            return None;
        }
        let half = 0.5 * matrix(off / radius, o / radius).determinant();
        let angle = libm::acos(half.clamp(-1.0, 1.0)) / 3.0;
        let at = |angle: f64| mean + 2.0 * radius * libm::cos(angle);
        let (most, least) = (at(angle), at(angle + std::f64::consts::TAU / 3.0));
        let rows = matrix(d - least, o);
        let [x, y, z] = [rows.x_axis, rows.y_axis, rows.z_axis];
        let across = [x.cross(y), x.cross(z), y.cross(z)];
        let longest = across
            .into_iter()
            .fold(DVec3::ZERO, |a, b| if b.length_squared() > a.length_squared() { b } else { a });
        // Its length is the product of what the other eigenvalues are greater.
        let longest = longest / (radius * radius);
        let normal = longest.try_normalize().filter(|_| longest.length() > ROUND)?;
        Some(Plane { middle: self.sum / self.count, normal, width: 3.0 * mean - most - least })
    }
}

/// A symmetric matrix from its diagonal and the elements `xy xz yz`.
fn matrix(d: DVec3, o: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(d.x, o.x, o.y), DVec3::new(o.x, d.y, o.z), DVec3::new(o.y, o.z, d.z))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::random;

    #[test]
    fn a_planted_plane_is_found() {
        for k in 0..50 {
            let normal = DVec3::new(random(3 * k), random(3 * k + 1), random(3 * k + 2)).normalize();
            let (right, up) = normal.any_orthonormal_pair();
            let point = |n: u64| {
                let n = 1000 * k + 3 * n;
                5.0 * normal + random(n) * right + 0.6 * random(n + 1) * up + 0.03 * random(n + 2) * normal
            };
            let moments = Moments::of((0..300).map(point));
            let plane = moments.plane().unwrap();
            assert!(plane.normal.dot(normal).abs() > 0.9995, "{plane:?} {normal}");
            assert!((0.09..0.15).contains(&plane.width), "0.36 / 3: {plane:?}");
            assert!((2e-4..4e-4).contains(&moments.thickness()), "0.0009 / 3");
        }
        assert_eq!(Moments::of((0..9).map(|n| DVec3::X * f64::from(n))).plane(), None);
        assert_eq!(Moments::of([DVec3::ONE; 9].into_iter()).plane(), None);
    }
}
