//! A generated asset: a splat at every point of a coarser cloud of the same surface.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use qsplat::Result;
use qsplat::analyse::nearest::listed;
use qsplat::fit::pose::{Fitting, Pose, Principal, principal};
use qsplat::model::asset::{Accuracy, Asset};
use qsplat::model::clip_curve::ClipCurve;
use qsplat::model::frame::Frame;
use qsplat::model::splat::Splat;
use rayon::prelude::*;

use crate::cloud::{Analysed, analysed};

/// Points that a splat stands for: about as many as in a bake of a dense scan at the default
/// error.
pub const POINTS_A_SPLAT: usize = 40;

/// The quadric through a point's neighbours, and how far the farthest lies.
pub fn quadric(analysed: &Analysed, n: usize) -> (Principal, f64) {
    let at = |n: usize| analysed.points.positions[n].as_dvec3();
    let pose = Pose::at(at(n), analysed.normals[n].as_dvec3());
    let near = listed(&analysed.nearest[n]).map(|other| (at(other as usize), 1.0));
    let radius = near.clone().map(|(point, _)| point.distance(at(n))).fold(f64::MIN_POSITIVE, f64::max);
    (principal(&pose, &Fitting::within(radius), near.chain(std::iter::once((at(n), 1.0)))), radius)
}

/// One splat for every [`POINTS_A_SPLAT`] of so many points, an eighth of them cut.
pub fn asset(points: usize) -> Result<Asset> {
    let analysed = analysed(points / POINTS_A_SPLAT)?;
    let splats = (0..analysed.nearest.len()).into_par_iter().map(|n| splat(&analysed, n)).collect();
    Ok(Asset {
        frame: Frame::default(),
        diagonal: DIAGONAL,
        max_error: 1e-3 * DIAGONAL,
        fit: Accuracy::default(),
        has_colors: false,
        splats,
    })
}

/// About the diagonal of the head's box.
const DIAGONAL: f64 = 1.6;

fn splat(analysed: &Analysed, n: usize) -> Splat {
    let (found, radius) = quadric(analysed, n);
    let clips = match n % 16 {
        0 => vec![ClipCurve::chord(0.0, FRAC_PI_2)],
        8 => vec![ClipCurve { alpha1: 0.0, alpha3: PI, p2: DVec2::new(0.0, 0.4 * radius), rho: 0.4 }],
        _ => Vec::new(),
    };
    Splat {
        center: found.pose.center,
        axes: found.pose.axes,
        radii: radius * DVec2::new(1.0, 0.8),
        curvature: found.curvature,
        clips,
        partners: Vec::new(),
        color: [255; 3],
    }
}
