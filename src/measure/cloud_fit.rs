//! A cloud's surface: around each point the quadric that fits those near it, as far as the point's disc.
//!
//! Points are near if they are of the same sheet: their normals agree, and no feature line passes between.

use std::num::NonZeroUsize;

use glam::{DVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen};

use crate::error::{Error, Result};
use crate::model::discs::{Discs, End};
use crate::model::polyline::nearest_on;

/// Neighbours, itself among them, that a fit rests on: twice what a quadric has numbers and more,
/// so that noise is averaged, yet about two rings of an even sampling only.
const NEIGHBOURS: usize = 20;

/// Fewer points than this, or worse spread ones, are fitted with a plane.
const QUADRIC: usize = 9;

/// Normals of one sheet agree by at least this cosine (60°), as where a bake joins points.
const AGREE: f32 = 0.5;

/// Points, the nearest ones, whose fits are asked for a place that lies beside the disc of the nearest of
/// all: two rings, as where a bake looks for what a point is joined to.
const ASKED: usize = 16;

/// Weight of keeping the second-order terms small, a point (ridge regression): it decides only
/// where the points lie so that nothing else does.
const RIDGE: f64 = 1e-6;

/// A cloud with its discs and its neighbour search.
pub(super) struct CloudFit<'a> {
    tree: ImmutableKdTree<f32, 3>,
    points: Vec<[f32; 3]>,
    discs: &'a Discs,
}

/// The fit around one point.
#[derive(Clone, Copy, Debug)]
struct Fit<'a> {
    /// Columns: two tangents and the normal of the plane.
    axes: [DVec3; 3],
    origin: DVec3,
    /// Of `1, u, v, u², uv, v²`, in units of `unit`.
    height: [f64; 6],
    /// Unit of the coordinates: farthest of the neighbours.
    unit: f64,
    /// How far to the side of its point it holds.
    reach: f64,
    /// Where it ends before that.
    ends: &'a [End],
}

/// How a place lies to a fit.
#[derive(Clone, Copy, Debug)]
struct Off {
    /// Its distance.
    distance: f64,
    /// Whether it lies over the disc or under it.
    over: bool,
}

impl<'a> CloudFit<'a> {
    /// The surface of points with discs, one each.
    ///
    /// # Errors
    /// [`Error::Internal`] should the search tree not take the points.
    pub(super) fn new(positions: &[Vec3], discs: &'a Discs) -> Result<Self> {
        let points: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
        let tree = ImmutableKdTree::new_from_slice(&points).map_err(|error| {
            Error::Internal(format!("the neighbour search refused the points: {error:?}"))
        })?;
        Ok(Self { tree, points, discs })
    }

    /// Distance from a place to the fit around the point nearest to it, if the place lies over that
    /// point's disc; else to the nearest of the fits around, each as far as its disc reaches.
    ///
    /// An open disc reaches a margin farther than it stands for the surface, since so much is not known.
    /// What stands out past the cloud's border is seen as far as it stands out farther than that. Where
    /// other sheets pass nearby, turned otherwise, their fits count too, those of each up to the nearest over
    /// whose disc the place lies: at a corner, points of two faces may be nearer than any of the third.
    pub(super) fn distance(&self, place: DVec3) -> f64 {
        let near = self.nearest(place.as_vec3().to_array(), ASKED);
        let Some((&nearest, others)) = near.split_first() else { return f64::INFINITY };
        let Off { mut distance, over } = self.fit(nearest).off(place);
        let mut told: Vec<u32> = over.then_some(nearest).into_iter().collect();
        for &point in others {
            if told.iter().any(|&other| self.agree(other, point)) {
                continue;
            }
            let off = self.fit(point).off(place);
            distance = distance.min(off.distance);
            told.extend((over && off.over).then_some(point));
        }
        distance
    }

    /// Unit normal of the fit at a point, of either sign.
    pub(super) fn normal(&self, point: usize) -> DVec3 {
        self.fit(point as u32).normal()
    }

    /// The points nearest to a place, nearest first.
    fn nearest(&self, place: [f32; 3], count: usize) -> Vec<u32> {
        let asked = NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN);
        let found = self.tree.query(&place).nearest_n::<SquaredEuclidean<f32>>(asked).execute();
        let mut found: Vec<(f32, u32)> = found.iter().map(|found| (found.distance, found.item)).collect();
        // The search gives no order to rely on.
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|found| found.1).collect()
    }

    fn point(&self, point: u32) -> DVec3 {
        Vec3::from(self.points[point as usize]).as_dvec3()
    }

    /// Whether two points lie on sheets turned alike.
    fn agree(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|point| self.discs.at(point as usize).normal);
        a.dot(b) >= AGREE
    }

    /// Whether the sheet goes straight on from one point to another.
    fn is_joined(&self, point: u32, other: u32) -> bool {
        let center = self.point(point);
        let way = self.point(other) - center;
        self.agree(point, other) && self.discs.share(point as usize, center, way) >= 1.0
    }

    fn fit(&self, point: u32) -> Fit<'a> {
        let origin = self.point(point);
        let near = self.nearest(self.points[point as usize], NEIGHBOURS);
        let joined = near.into_iter().filter(|&other| other == point || self.is_joined(point, other));
        let around: Vec<DVec3> = joined.map(|other| self.point(other) - origin).collect();
        let unit = around.last().map_or(0.0, |p| p.length());
        let axes = plane(&around);
        let local: Vec<DVec3> = (around.iter())
            .map(|p| DVec3::new(p.dot(axes[0]), p.dot(axes[1]), p.dot(axes[2])) / unit.max(f64::MIN_POSITIVE))
            .collect();
        let reach = f64::from(self.discs.at(point as usize).reach());
        Fit { axes, origin, height: heights(&local), unit, reach, ends: self.discs.ends(point as usize) }
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

impl Fit<'_> {
    /// Height and its slopes over a place, in units of `unit`.
    fn over(&self, u: f64, v: f64) -> (f64, f64, f64) {
        let [h, c, d, a, e, b] = self.height;
        let height = h + u * (c + a * u + e * v) + v * (d + b * v);
        (height, c + 2.0 * a * u + e * v, d + e * u + 2.0 * b * v)
    }

    /// How a place lies to the fit, to first order in the slope, which is small in the plane of the fit
    /// itself.
    fn off(&self, place: DVec3) -> Off {
        let way = place - self.origin;
        if self.unit <= 0.0 {
            return Off { distance: way.length(), over: false };
        }
        let [u, v, w] = self.axes.map(|axis| way.dot(axis));
        let flat = u * self.axes[0] + v * self.axes[1];
        let (share, beside) = self.held(flat);
        let [u, v, w] = [share * u, share * v, w].map(|length| length / self.unit);
        let (height, along, across) = self.over(u, v);
        let above = (w - height) / libm::sqrt(1.0 + along * along + across * across);
        Off { distance: libm::hypot(self.unit * above, beside), over: share >= 1.0 }
    }

    /// How much of a way in the fit's plane it holds for, and how far from that the way goes on beside it.
    fn held(&self, way: DVec3) -> (f64, f64) {
        let side = way.length();
        let within = if side > self.reach { self.reach / side } else { 1.0 };
        let crossed = |end: &End| end.crossed(self.origin, way);
        let share = self.ends.iter().filter_map(crossed).fold(within, f64::min);
        // The line itself is of the surface, too.
        let lines = self.ends.iter().filter(|end| share < within && crossed(end).is_some());
        let to_line = lines.map(|end| {
            let [from, to] = end.ends.map(|end| end.as_dvec3() - self.origin);
            nearest_on(from, to, way).distance(way)
        });
        (share, to_line.fold((1.0 - share) * side, f64::min))
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
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_discs};
    use crate::measure::planted;
    use crate::model::cloud::Cloud;
    use crate::model::discs::Disc;

    fn discs(points: &[Vec3]) -> Discs {
        planted::discs(&Cloud { positions: points.to_vec(), ..Cloud::default() })
    }

    #[test]
    fn beside_an_edge_the_other_face_counts_beyond_its_nearest_point() {
        let floor = |n: u32| Vec3::new(0.1 * (n % 5) as f32, 0.1 * (n / 5) as f32 - 0.2, 0.0);
        // The nearest of the wall stands for little of it.
        let wall = [(0.0, 0.3, 0.02), (0.06, 0.35, 0.3), (-0.06, 0.36, 0.3), (0.0, 0.45, 0.3)];
        let points: Vec<Vec3> =
            (0..25).map(floor).chain(wall.map(|(y, z, _)| Vec3::new(0.0, y, z))).collect();
        let disc = |normal: Vec3, margin: f32| Disc { normal, margin, ..Disc::default() };
        let floor = (0..25).map(|_| disc(Vec3::Z, 0.1));
        let discs = Discs::new(floor.chain(wall.map(|(_, _, margin)| disc(Vec3::X, margin))).collect(), &[]);
        let fit = CloudFit::new(&points, &discs).unwrap();
        let on_wall = fit.distance(DVec3::new(0.0, 0.02, 0.14));
        assert!(on_wall < 1e-6, "{on_wall}");
    }

    #[test]
    fn at_a_corner_the_third_face_counts_where_points_of_two_are_nearer() {
        let out = [Vec3::X, Vec3::Y, Vec3::Z];
        // The nearest of each face, that of the third farther from a place on it than those of the others.
        let nearest =
            [Vec3::new(0.0, -0.02, -0.01), Vec3::new(-0.01, 0.0, -0.02), Vec3::new(-0.03, -0.03, 0.0)];
        let others =
            [1, 2].map(|turn| [0, 1, 2].map(|face: usize| nearest[face] - 0.2 * out[(face + turn) % 3]));
        let points = [nearest, others[0], others[1]].concat();
        let disc = |n: usize| Disc { normal: out[n % 3], margin: 0.05, ..Disc::default() };
        let discs = Discs::new((0..9).map(disc).collect(), &[]);
        let fit = CloudFit::new(&points, &discs).unwrap();
        let found = fit.distance(DVec3::new(-0.008, -0.01, 0.0));
        assert!(found < 1e-6, "{found}");
        assert!(fit.distance(DVec3::new(-0.008, -0.01, -0.005)) > 0.004, "inside, all are off");
    }

    #[test]
    fn a_lattice_on_a_bowl_gives_heights_normals_and_its_border() {
        let bowl = |x: f64, y: f64| DVec3::new(x, y, 0.4 * x * x - 0.2 * y * y + 0.1 * x);
        let step = 1.0 / 40.0;
        let points: Vec<Vec3> = (0..81 * 81)
            .map(|n| bowl(f64::from(n % 81 - 40) * step, f64::from(n / 81 - 40) * step).as_vec3())
            .collect();
        let discs = discs(&points);
        let fit = CloudFit::new(&points, &discs).unwrap();
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
        // Past the border less what is not known of it: two margins, of about half the lattice's diagonal.
        for past in [0.1, 0.3] {
            let found = fit.distance(bowl(1.0, 0.0) + past * DVec3::new(1.0, 0.0, 0.9).normalize());
            assert!(found < past - step && found > past - 2.0 * step, "{past} gave {found}");
        }
    }

    #[test]
    fn a_gap_that_is_no_hole_is_surface_and_a_hole_is_none() {
        let step = 1.0 / 40.0;
        let at = |n: i32| Vec3::new((n % 81 - 40) as f32, (n / 81 - 40) as f32, 0.0) * step;
        let holed = |radius: f32| -> Vec<Vec3> {
            (0..81 * 81).map(at).filter(|p| p.length() >= radius * step).collect()
        };
        // Empty discs are holes where they are larger than 2.5 spacings.
        for (radius, [least, most]) in
            [(1.2, [0.0, 1e-6]), (2.1, [0.0, 1e-6]), (6.0, [2.5 * step, 6.0 * step])]
        {
            let points = holed(radius);
            let discs = discs(&points);
            let found = CloudFit::new(&points, &discs).unwrap().distance(DVec3::ZERO);
            assert!(found >= f64::from(least) && found <= f64::from(most), "{radius} steps: {found}");
        }
    }

    #[test]
    fn a_fit_ends_at_a_line_and_what_lies_across_is_of_another() {
        // Two sheets that meet at a right angle along the y axis, with the line between them.
        let step = 0.05;
        let at = |n: i32| [f64::from(n % 20) * step + 0.5 * step, f64::from(n / 20 - 20) * step];
        let floor = (0..800).map(at).map(|[x, y]| DVec3::new(x, y, 0.0));
        let wall = (0..800).map(at).map(|[z, y]| DVec3::new(0.0, y, -z));
        let points: Vec<Vec3> = floor.chain(wall).map(|p| p.as_vec3()).collect();
        let line = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
        let cloud = Cloud { positions: points.clone(), ..Cloud::default() };
        let lines = [line.to_vec()];
        let discs = cloud_discs(&cloud, NormalSource::Auto, Lines::Given(&lines), None).unwrap().discs;
        let fit = CloudFit::new(&points, &discs).unwrap();
        for n in -10..10 {
            let y = 0.07 * f64::from(n);
            for (x, z) in [(0.3, 0.0), (0.02, 0.0), (0.0, -0.02), (0.004, 0.0)] {
                let found = fit.distance(DVec3::new(x, y, z));
                assert!(found < 1e-6, "{x} {y} {z} is on a sheet: {found}");
            }
            for past in [0.01, 0.04] {
                let found = fit.distance(DVec3::new(-past, y, 0.0));
                assert!((found - past).abs() < 1e-6, "{past} past the line gave {found}");
            }
        }
    }
}
