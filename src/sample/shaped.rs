//! Ellipses around places: what pieces take up, or what a point of a cloud stands for beside a feature line.

use glam::{DVec2, DVec3};

use crate::analyse::surface::Surface;
use crate::fit::ellipse::{around, least_turn};
use crate::fit::pose::Pose;

/// An ellipse: its frame, at its centre, and its radii there.
pub(super) struct Shaped {
    pub(super) pose: Pose,
    pub(super) radii: DVec2,
}

impl Shaped {
    /// The ellipse around what a spot stands for, in the plane of a frame; `None` where that is the disc of its margin,
    /// and for a triangle.
    pub(super) fn over(surface: &Surface, piece: u32, pose: &Pose) -> Option<Self> {
        let corners: Vec<DVec3> = surface.cells.of(piece).iter().map(|corner| corner.as_dvec3()).collect();
        (!corners.is_empty()).then(|| Self::along(&corners, &boxed(&corners, pose)))
    }

    /// The ellipse along the axes of a frame around some places.
    pub(super) fn along(places: &[DVec3], pose: &Pose) -> Self {
        let (center, radii) = around(&flat(places, pose));
        Self { pose: Pose { center: pose.center + pose.axes * center.extend(0.0), ..*pose }, radii }
    }
}

/// A frame, turned about its normal so that the box around some places is least.
pub(super) fn boxed(places: &[DVec3], pose: &Pose) -> Pose {
    pose.turned(least_turn(&flat(places, pose)))
}

/// Places in the plane of a frame.
fn flat(places: &[DVec3], pose: &Pose) -> Vec<DVec2> {
    places.iter().map(|&place| pose.to_local(place).truncate()).collect()
}
