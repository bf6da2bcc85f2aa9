//! T Figure 33: the mean error of splats of one radius, flat against quadric, on a head.

use glam::{DVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use qsplat::analyse::cloud_normals::{NormalSource, normals, plane};
use qsplat::analyse::distinct::distinct;
use qsplat::analyse::nearest::Search;
use qsplat::fit::pose::{Fitting, Pose, principal};
use qsplat::{Result, deliver};
use rayon::prelude::*;

use super::models::or_fixture;
use super::page::Page;
use super::plot::Plot;
use super::search::tree;

/// Radii, shares of the diagonal. The thesis does not say which one it took.
const RADII: [f64; 6] = [0.005, 0.01, 0.015, 0.02, 0.03, 0.04];

/// By how much the mean error fell, T 4.2, page 65.
const DOCUMENT: f64 = 0.72;

/// At most so many splats are fitted, spread evenly over the points.
const SPLATS: usize = 20_000;

/// A splat takes the points of its own sheet: normals within 60° of its own.
const FACING: f32 = 0.5;

/// Fewer points than this do not show by how much a quadric errs: it has six terms.
const FEWEST: usize = 12;

/// A head's points with normals.
struct Head {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    tree: ImmutableKdTree<f32, 3>,
    diagonal: f64,
}

/// Mean errors over all splats, model units.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// From the tangent plane at the centre (T 4.7).
    tangent: f64,
    /// From the plane of least squares.
    plane: f64,
    /// From the quadric of least squares (T 4.9).
    quadric: f64,
}

/// The section.
///
/// # Errors
/// Those of reading the model and writing the page.
pub fn make(page: &mut Page) -> Result<()> {
    let model = or_fixture("igea.ply", "blob.ply")?;
    let head = head(&model.input)?;
    let mut rows = Vec::new();
    let mut curves = [Vec::new(), Vec::new()];
    for share in RADII {
        let (errors, splats, members) = mean_errors(&head, share * head.diagonal);
        let against = |flat: f64| 1.0 - errors.quadric / flat;
        let of_diagonal = |error: f64| format!("{:.3e}", error / head.diagonal);
        rows.push(vec![
            format!("{:.1} %", 100.0 * share),
            splats.to_string(),
            format!("{members:.0}"),
            of_diagonal(errors.tangent),
            of_diagonal(errors.plane),
            of_diagonal(errors.quadric),
            format!("{:.1} %", 100.0 * against(errors.tangent)),
            format!("{:.1} %", 100.0 * against(errors.plane)),
        ]);
        for (curve, flat) in curves.iter_mut().zip([errors.tangent, errors.plane]) {
            curve.push((100.0 * share, 100.0 * against(flat)));
        }
    }
    page.section("T Figure 33: flat and quadric splats of one radius");
    page.say(&format!(
        "The document (section 4.2, page 65; Max Planck's head, a radius it does not name): from flat \
         to quadric splats the mean error falls by about {:.0} %. Ours: {}, {} points, splats centred at \
         points of the cloud, errors as in its equations 4.7 and 4.9, as shares of `D`. The last column \
         compares with the best plane instead of the tangent plane, which is harder to beat.",
        100.0 * DOCUMENT,
        model.name,
        head.points.len(),
    ));
    let columns = [
        "radius / D",
        "splats",
        "points a splat",
        "flat",
        "best plane",
        "quadric",
        "fall",
        "fall from best plane",
    ];
    page.table("figure-33", &columns, &rows)?;
    let [tangent, plane] = curves;
    let document = vec![(0.0, 100.0 * DOCUMENT), (100.0 * RADII[RADII.len() - 1], 100.0 * DOCUMENT)];
    let plot = Plot {
        title: "Fall of the mean error from flat to quadric splats",
        across: "radius, % of D",
        up: "fall, %",
        curves: vec![("tangent plane", tangent), ("best plane", plane), ("document", document)],
    };
    page.picture("figure-33", "fall of the mean error against the radius", &plot.svg()?)
}

fn head(input: &qsplat::ingest::Input) -> Result<Head> {
    let points = distinct(input.cloud());
    let nearest = Search::new(&points.positions)?.nearest();
    let normals = normals(&points, &nearest, NormalSource::Auto, None)?.normals;
    let tree = tree(&points.positions)?;
    let diagonal = deliver::model(input).diagonal();
    Ok(Head { points: points.positions, normals, tree, diagonal })
}

/// Means over all splats with enough points; how many those are, and their mean number of points.
fn mean_errors(head: &Head, radius: f64) -> (Errors, usize, f64) {
    let step = head.points.len().div_ceil(SPLATS);
    let centers: Vec<usize> = (0..head.points.len()).step_by(step).collect();
    let found: Vec<Option<(Errors, usize)>> =
        centers.par_iter().map(|&center| errors(head, center, radius)).collect();
    let mut sum = Errors::default();
    let (mut splats, mut members) = (0, 0);
    for (errors, count) in found.into_iter().flatten() {
        sum.tangent += errors.tangent;
        sum.plane += errors.plane;
        sum.quadric += errors.quadric;
        splats += 1;
        members += count;
    }
    let mean = |sum: f64| sum / f64::from(splats.max(1) as u32);
    let errors = Errors { tangent: mean(sum.tangent), plane: mean(sum.plane), quadric: mean(sum.quadric) };
    (errors, splats, mean(members as f64))
}

/// The errors of the splats around one point, and how many points they cover.
fn errors(head: &Head, center: usize, radius: f64) -> Option<(Errors, usize)> {
    let at = |n: u32| head.points[n as usize].as_dvec3();
    let (own, normal) = (head.points[center].to_array(), head.normals[center]);
    let square = (radius * radius) as f32;
    let found = head.tree.query(&own).within::<SquaredEuclidean<f32>>(square).execute();
    let members: Vec<u32> = found
        .iter()
        .map(|found| found.item)
        .filter(|&n| head.normals[n as usize].dot(normal) > FACING)
        .collect();
    if members.len() < FEWEST {
        return None;
    }
    let mean = |height: &dyn Fn(DVec3) -> f64| {
        members.iter().map(|&n| height(at(n)).abs()).sum::<f64>() / members.len() as f64
    };
    let pose = Pose::at(at(center as u32), normal.as_dvec3());
    let fitted = principal(&pose, &Fitting::within(radius), members.iter().map(|&n| (at(n), 1.0)));
    let others = members.iter().copied().filter(|&n| n as usize != center);
    let best = plane(&head.points, center, others).normal.as_dvec3();
    let middle = members.iter().map(|&n| at(n)).sum::<DVec3>() / members.len() as f64;
    let errors = Errors {
        tangent: mean(&|p| pose.to_local(p).z),
        plane: mean(&|p| (p - middle).dot(best)),
        quadric: mean(&|p| {
            let local = fitted.pose.to_local(p);
            let uv = local.truncate();
            local.z - (fitted.curvature * uv * uv).element_sum()
        }),
    };
    Some((errors, members.len()))
}
