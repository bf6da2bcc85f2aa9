//! `fit`: how far the input's points lie from the splats that cover them.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::point_grid::PointGrid;
use super::spread::larger;
use crate::model::asset::{Accuracy, Asset};
use crate::model::splat::Splat;
use crate::render::input::Model;

/// Bounds of distance within which a splat is taken to stand for a point: farther off lies
/// another sheet of the surface.
pub const REACH: f64 = 4.0;

/// The points the bound holds for: those of a cloud but for the ones `left_out`, which ascend,
/// and those of a mesh that its triangles use; one with two corners at one place is none.
///
/// Each place counts once: how often an input repeats a point, along seams say, tells nothing of
/// the surface.
#[must_use]
pub fn points(model: Model<'_>, left_out: &[u32]) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = match model {
        Model::Cloud(cloud) | Model::Surface(cloud, _) => {
            let mut rest = left_out.iter().peekable();
            let all = (0_u32..).zip(&cloud.positions);
            all.filter(|(n, _)| rest.next_if_eq(&n).is_none()).map(|(_, p)| *p).collect()
        }
        Model::Mesh(mesh) => {
            let mut used = vec![false; mesh.vertices.positions.len()];
            for (n, triangle) in mesh.triangles.iter().enumerate() {
                let [a, b, c] = mesh.corners(n);
                if a != b && b != c && c != a {
                    triangle.iter().for_each(|&vertex| used[vertex as usize] = true);
                }
            }
            mesh.vertices.positions.iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| *p).collect()
        }
    };
    // Adding zero turns -0 into 0: they are one place.
    points.par_sort_unstable_by_key(|&point| (point + Vec3::ZERO).to_array().map(f32::to_bits));
    points.dedup();
    points
}

/// What measuring the fit found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Over the points that some splat covers, model units.
    pub accuracy: Accuracy,
    /// The point of the largest distance, model units; `None` if no point is covered.
    pub worst: Option<Vec3>,
    /// Points that no splat covers within `reach`.
    pub uncovered: usize,
}

/// Measures the distance of each point, along the normal `k`, to the nearest quadric among
/// the splats that cover it: those in whose domain it lies, not cut away.
///
/// Points are in model units. A splat farther off than `reach` covers another sheet of the
/// surface, not this point.
#[must_use]
pub fn fit(points: &[Vec3], asset: &Asset, reach: f64) -> Fit {
    let grid = PointGrid::new(points);
    // Distances as bits, which sort as they do: the least of them is the same whichever thread comes first.
    let best: Vec<AtomicU64> = points.iter().map(|_| AtomicU64::new(f64::INFINITY.to_bits())).collect();
    asset.splats.par_iter().for_each(|splat| {
        for (point, distance) in covered(splat, &grid, points, reach) {
            best[point as usize].fetch_min(distance.to_bits(), Ordering::Relaxed);
        }
    });
    let distances = best.into_iter().map(|best| f64::from_bits(best.into_inner()));
    let found: Vec<(Vec3, f64)> =
        points.iter().copied().zip(distances).filter(|found| found.1.is_finite()).collect();
    let worst = found.iter().copied().reduce(larger).map(|worst| worst.0);
    let mut distances: Vec<f64> = found.into_iter().map(|found| found.1).collect();
    distances.par_sort_unstable_by(f64::total_cmp);
    let uncovered = points.len() - distances.len();
    Fit { uncovered, worst, accuracy: accuracy(&distances) }
}

/// The points a splat covers within `reach`, with their distances.
fn covered(splat: &Splat, grid: &PointGrid, points: &[Vec3], reach: f64) -> impl Iterator<Item = (u32, f64)> {
    let (low, high) = bounds(splat, reach);
    let conics = splat.conics();
    grid.near(low, high).filter_map(move |point| {
        let local = splat.to_local(points[point as usize].as_dvec3());
        let uv = local.truncate();
        let distance = (local.z - splat.height(uv)).abs();
        let inside = distance <= reach && splat.ellipse(uv) <= 1.0;
        let cut = |uv: DVec2| conics.iter().any(|conic| conic.cuts(uv)) || splat.partners_cut(uv);
        (inside && !cut(uv)).then_some((point, distance))
    })
}

/// A box that holds everything within `reach` of a splat along its normal.
fn bounds(splat: &Splat, reach: f64) -> (DVec3, DVec3) {
    let sagitta: DVec2 = splat.curvature * splat.radii * splat.radii;
    let (low, high) = (sagitta.min_element().min(0.0) - reach, sagitta.max_element().max(0.0) + reach);
    let [i, j, k] = [splat.axes.x_axis, splat.axes.y_axis, splat.axes.z_axis];
    // Along a coordinate axis an ellipse reaches the length of its two projected radii.
    let (u, v) = (i * splat.radii.x, j * splat.radii.y);
    let across = (u * u + v * v).map(f64::sqrt);
    (splat.center + (k * low).min(k * high) - across, splat.center + (k * low).max(k * high) + across)
}

/// Sums up sorted distances.
fn accuracy(distances: &[f64]) -> Accuracy {
    let Some(&max) = distances.last() else { return Accuracy::default() };
    let count = distances.len();
    let squares: f64 = distances.iter().map(|distance| distance * distance).sum();
    // The least distance that at least 99 in a hundred points keep.
    let p99 = distances[(count * 99).div_ceil(100) - 1];
    Accuracy { rms: (squares / count as f64).sqrt(), p99, max }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::clip_curve::ClipCurve;
    use crate::model::cloud::Cloud;
    use crate::model::frame::Frame;
    use crate::model::mesh::Mesh;
    use glam::DMat3;

    #[test]
    fn a_place_counts_once_and_only_if_used() {
        let places = [[0.0, 0.5, 0.0], [1.0, 0.0, 0.0], [-0.0, 0.5, 0.0], [0.0, 0.0, -1.0], [0.2; 3]];
        let cloud = Cloud { positions: places.map(Vec3::from_array).to_vec(), ..Cloud::default() };
        assert_eq!(points(Model::Cloud(&cloud), &[]).len(), 4);
        assert!(!points(Model::Cloud(&cloud), &[1, 4]).contains(&Vec3::X));
        // The last has two corners at one place.
        let triangles = vec![[0, 1, 3], [2, 3, 1], [0, 2, 4]];
        let mesh = Mesh { vertices: cloud, triangles, ..Mesh::default() };
        let used = points(Model::Mesh(&mesh), &[]);
        assert_eq!((used.len(), used.contains(&Vec3::splat(0.2))), (3, false));
    }

    #[test]
    fn planted_offsets_cuts_and_gaps_come_back() {
        let splat = Splat {
            center: DVec3::new(0.1, 0.0, -0.2),
            axes: DMat3::from_rotation_x(0.5),
            radii: DVec2::new(0.4, 0.3),
            curvature: DVec2::new(0.8, -0.5),
            // Cuts what lies below the chord along v = 0.
            clips: vec![ClipCurve::chord(std::f64::consts::PI, 0.0)],
            partners: Vec::new(),
            color: [255; 3],
        };
        let at = |u: f64, v: f64, off: f64| {
            let uv = DVec2::new(u, v);
            splat.to_model(uv.extend(splat.height(uv) + off)).as_vec3()
        };
        let mut points: Vec<Vec3> = (0..99).map(|n| at(f64::from(n) * 0.003, 0.05, 0.001)).collect();
        points.push(at(0.1, 0.1, -0.004));
        points.extend([at(0.1, -0.1, 0.0), at(0.3, 0.29, 0.0), at(0.0, 0.1, 0.02)]);
        let asset = Asset {
            frame: Frame::default(),
            diagonal: 1.0,
            max_error: 0.01,
            fit: Accuracy::default(),
            has_colors: false,
            splats: vec![splat],
        };
        let found = fit(&points, &asset, 0.01);
        assert_eq!(found.uncovered, 3, "one cut away, one beyond the rim, one out of reach");
        assert!((found.accuracy.max - 0.004).abs() < 1e-6 && (found.accuracy.p99 - 0.001).abs() < 1e-6);
    }
}
