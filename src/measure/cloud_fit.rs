//! A cloud's surface: at each place the quadric that fits the points around the nearest one.

use std::num::NonZeroUsize;

use glam::{DVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen};

use crate::error::{Error, Result};

/// Neighbours, itself among them, that a fit rests on: twice what a quadric has numbers and more,
/// so that noise is averaged, yet about two rings of an even sampling only.
const NEIGHBOURS: usize = 20;

/// Fewer points than this, or worse spread ones, are fitted with a plane.
const QUADRIC: usize = 9;

/// The fit reaches as far as this many of the nearest neighbours, itself among them: the first
/// ring of an even sampling. What lies farther to the side lies beyond the surface.
const RING: usize = 9;

/// Weight of keeping the second-order terms small, a point (ridge regression): it decides only
/// where the points lie so that nothing else does.
const RIDGE: f64 = 1e-6;

/// A cloud and its neighbour search.
pub(super) struct CloudFit {
    tree: ImmutableKdTree<f32, 3>,
    points: Vec<[f32; 3]>,
}

/// The fit around one point.
#[derive(Clone, Copy, Debug)]
struct Fit {
    /// Columns: two tangents and the normal of the plane.
    axes: [DVec3; 3],
    origin: DVec3,
    /// Of `1, u, v, u², uv, v²`, in units of `reach`.
    height: [f64; 6],
    /// Unit of the coordinates: farthest of the neighbours.
    unit: f64,
    /// How far to the side of its point it holds.
    reach: f64,
}

impl CloudFit {
    /// # Errors
    /// [`Error::Internal`] should the search tree not take the points.
    pub(super) fn new(positions: &[Vec3]) -> Result<Self> {
        let points: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
        let tree = ImmutableKdTree::new_from_slice(&points).map_err(|error| {
            Error::Internal(format!("the neighbour search refused the points: {error:?}"))
        })?;
        Ok(Self { tree, points })
    }

    /// Distance from a place to the fit around the point nearest to it.
    ///
    /// To the side the fit ends at the reach of that point's first ring of neighbours, so what
    /// stands out past the cloud's border is seen as far as it stands out farther than that.
    pub(super) fn distance(&self, place: DVec3) -> f64 {
        let Some(&nearest) = self.nearest(place.as_vec3().to_array(), 1).first() else {
            return f64::INFINITY;
        };
        self.fit(nearest).distance(place)
    }

    /// Unit normal of the fit at a point, of either sign.
    pub(super) fn normal(&self, point: usize) -> DVec3 {
        self.fit(point as u32).normal()
    }

    fn nearest(&self, place: [f32; 3], count: usize) -> Vec<u32> {
        let asked = NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN);
        let found = self.tree.query(&place).nearest_n::<SquaredEuclidean<f32>>(asked).execute();
        found.iter().map(|found| found.item).collect()
    }

    fn fit(&self, point: u32) -> Fit {
        let center = self.points[point as usize];
        let at = |n: &u32| Vec3::from(self.points[*n as usize]).as_dvec3();
        let origin = Vec3::from(center).as_dvec3();
        let mut around: Vec<DVec3> =
            self.nearest(center, NEIGHBOURS).iter().map(|n| at(n) - origin).collect();
        // The search gives no order to rely on.
        around.sort_unstable_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let length = |n: usize| around.get(n).or(around.last()).map_or(0.0, |p| p.length());
        let (reach, unit) = (length(RING - 1), length(NEIGHBOURS));
        let axes = plane(&around);
        let local: Vec<DVec3> = (around.iter())
            .map(|p| DVec3::new(p.dot(axes[0]), p.dot(axes[1]), p.dot(axes[2])) / unit.max(f64::MIN_POSITIVE))
            .collect();
        Fit { axes, origin, height: heights(&local), unit, reach }
    }
}

/// Two tangents and the normal of the plane nearest to points around the origin.
fn plane(around: &[DVec3]) -> [DVec3; 3] {
    let mean = around.iter().sum::<DVec3>() / around.len().max(1) as f64;
    let mut spread = Matrix3::zeros();
    for p in around {
        let way = nalgebra::Vector3::from((*p - mean).to_array());
        spread += way * way.transpose();
    }
    let eigen = SymmetricEigen::new(spread);
    let least = (0..3).min_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b])).unwrap_or(2);
    let axis = eigen.eigenvectors.column(least);
    let normal = DVec3::new(axis[0], axis[1], axis[2]).try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = normal.any_orthonormal_pair();
    [u, v, normal]
}

/// Least-squares height over the plane, of `1, u, v, u², uv, v²`.
fn heights(local: &[DVec3]) -> [f64; 6] {
    let mut normal = SMatrix::<f64, 6, 6>::zeros();
    let mut right = SVector::<f64, 6>::zeros();
    for p in local {
        let row = SVector::from([1.0, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y]);
        normal += row * row.transpose();
        right += row * p.z;
    }
    // A plane is kept where there are too few points for more.
    let ridge = if local.len() >= QUADRIC { RIDGE } else { 1.0 / RIDGE };
    for n in 0..6 {
        normal[(n, n)] += local.len() as f64 * if n < 3 { RIDGE * RIDGE } else { ridge };
    }
    normal.cholesky().map_or([0.0; 6], |factor| factor.solve(&right).into())
}

impl Fit {
    /// Height and its slopes over a place, in units of `unit`.
    fn over(&self, u: f64, v: f64) -> (f64, f64, f64) {
        let [h, c, d, a, e, b] = self.height;
        let height = h + u * (c + a * u + e * v) + v * (d + b * v);
        (height, c + 2.0 * a * u + e * v, d + e * u + 2.0 * b * v)
    }

    /// To first order in the slope, which is small in the plane of the fit itself.
    fn distance(&self, place: DVec3) -> f64 {
        let way = place - self.origin;
        if self.unit <= 0.0 {
            return way.length();
        }
        let [mut u, mut v, w] = self.axes.map(|axis| way.dot(axis) / self.unit);
        let (side, reach) = (libm::hypot(u, v), self.reach / self.unit);
        if side > reach {
            (u, v) = (u * reach / side, v * reach / side);
        }
        let (height, along, across) = self.over(u, v);
        let above = (w - height) / libm::sqrt(1.0 + along * along + across * across);
        self.unit * libm::hypot(above, (side - reach).max(0.0))
    }

    /// Unit normal over its own point.
    fn normal(&self) -> DVec3 {
        let (_, along, across) = self.over(0.0, 0.0);
        (self.axes[2] - along * self.axes[0] - across * self.axes[1]).normalize_or_zero()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_on_a_bowl_gives_heights_normals_and_its_border() {
        let bowl = |x: f64, y: f64| DVec3::new(x, y, 0.4 * x * x - 0.2 * y * y + 0.1 * x);
        let step = 1.0 / 40.0;
        let points: Vec<Vec3> = (0..81 * 81)
            .map(|n| bowl(f64::from(n % 81 - 40) * step, f64::from(n / 81 - 40) * step).as_vec3())
            .collect();
        let fit = CloudFit::new(&points).unwrap();
        for n in 0..200 {
            let (x, y) = (f64::from(n) * 0.0037 - 0.4, f64::from(n % 17) * 0.04 - 0.3);
            let normal = DVec3::new(-0.8 * x - 0.1, 0.4 * y, 1.0).normalize();
            let off = f64::from(n % 5) * 1e-3;
            let found = fit.distance(bowl(x, y) + off * normal);
            assert!((found - off).abs() < 2e-6, "{off} gave {found}");
            let on = (0..points.len()).min_by(|&a, &b| {
                let d = |k: usize| points[k].as_dvec3().distance(bowl(x, y));
                d(a).total_cmp(&d(b))
            });
            let on = on.unwrap();
            let p = points[on].as_dvec3();
            let normal = DVec3::new(-0.8 * p.x - 0.1, 0.4 * p.y, 1.0).normalize();
            // Seen from the plane of a lopsided neighbourhood, tilted by about curvature times radius,
            // the bowl has cubic terms: of the order of (0.8 * 0.06)^3 of slope, 0.006 degrees.
            assert!(fit.normal(on).cross(normal).length() < 0.02_f64.to_radians());
        }
        // Past the border less what a ring reaches: the lattice's step or its diagonal.
        for past in [0.1, 0.3] {
            let found = fit.distance(bowl(1.0, 0.0) + past * DVec3::new(1.0, 0.0, 0.9).normalize());
            assert!(found < past && found > past - 3.0 * step, "{past} gave {found}");
        }
    }
}
