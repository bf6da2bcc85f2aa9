//! The splat of last resort: one triangle, exactly.
//!
//! Where no larger splat keeps the budget (a sliver between feature lines, a mesh coarser
//! than the budget), a plane over the triangle's least ellipse, cut along its three sides,
//! covers the triangle without error. So every piece of a mesh can be covered.

use glam::{DVec2, DVec3};

use super::grow::Grower;
use super::settle::{Candidate, rounded};
use crate::fit::clip::{self, Care};
use crate::fit::ellipse::circumellipse;
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
    let (theta, radii) = circumellipse(points.map(|point| pose.to_local(point).truncate()));
    let (pose, radii) = (pose.turned(theta), radii + margin + budget.pad);
    let mut splat = rounded(grower, &pose, radii, DVec2::ZERO)?;
    let outline: Vec<DVec2> = points.iter().map(|&p| splat.to_local(p).truncate()).collect();
    if corners[0] != corners[1] {
        // A sliver thinner than the tolerance has no corners to cut at, and needs no cut.
        splat.clips = clip::fit(&outline, true, splat.radii, &budget.clip, Care::Nearest).unwrap_or_default();
    }
    splat.color = surface.colors.get(corners[0] as usize).copied().unwrap_or([u8::MAX; 3]);
    // What ends at a triangle's own sides is cut by itself, whatever lies across.
    let end_clips = splat.clips.clone();
    Some(Candidate { splat, end_clips, pieces: vec![piece], rank: 3 })
}
