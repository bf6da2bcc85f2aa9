//! The splat of last resort: one triangle, exactly.
//!
//! Where no larger splat keeps the budget (a sliver between feature lines, a mesh coarser
//! than the budget), a plane over the triangle's least ellipse, cut along its three sides,
//! covers the triangle without error. So every piece of a mesh can be covered.

use glam::{DVec2, DVec3};

use super::grow::Grower;
use super::settle::{Candidate, rounded};
use crate::fit::clip::{self, Care};
use crate::fit::pose::Pose;

/// The splat over one piece: a triangle cut out of a plane, or the disc of a single point.
///
/// `None` if it cannot be stored: too small beside the budget, or too large.
#[must_use]
pub fn over(grower: &Grower, piece: u32) -> Option<Candidate> {
    let (surface, budget) = (grower.surface, &grower.budget);
    let corners = surface.pieces[piece as usize];
    let points = corners.map(|corner| surface.point(corner));
    let middle = surface.middle(piece);
    let mean: DVec3 = corners.iter().map(|&corner| surface.normal(corner)).sum();
    let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or(mean);
    let pose = Pose::at(middle, normal);
    let margin = surface.piece_margin(piece);
    let (pose, radii) = circumellipse(&pose, &points, margin, budget.pad);
    let mut splat = rounded(grower, &pose, radii, DVec2::ZERO)?;
    let outline: Vec<DVec2> = points.iter().map(|&p| splat.to_local(p).truncate()).collect();
    if corners[0] != corners[1] {
        // A sliver thinner than the tolerance has no corners to cut at, and needs no cut.
        splat.clips = clip::fit(&outline, true, splat.radii, &budget.clip, Care::Nearest).unwrap_or_default();
    }
    splat.color = surface.colors.get(corners[0] as usize).copied().unwrap_or([u8::MAX; 3]);
    Some(Candidate { splat, pieces: vec![piece], rank: 3 })
}

/// Steiner's ellipse through three points, in its own axes, grown by a pad.
///
/// With `S` the second moments of the corners about their mean it is `xᵀ S⁻¹ x = 2`.
fn circumellipse(pose: &Pose, points: &[DVec3; 3], margin: f64, pad: f64) -> (Pose, DVec2) {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &point in points {
        let uv = pose.to_local(point).truncate();
        xx += uv.x * uv.x / 3.0;
        xy += uv.x * uv.y / 3.0;
        yy += uv.y * uv.y / 3.0;
    }
    let theta = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let (mean, half) = (0.5 * (xx + yy), 0.5 * libm::hypot(xx - yy, 2.0 * xy));
    let radii = DVec2::new(mean + half, (mean - half).max(0.0)).map(|moment| (2.0 * moment).sqrt());
    (pose.turned(theta), radii + margin + pad)
}
