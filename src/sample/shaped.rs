//! The ellipse around what a point of a cloud stands for beside a feature line.

use glam::{DVec2, Vec3};

use crate::fit::ellipse::{around, least_turn};
use crate::fit::pose::Pose;

/// An ellipse: its frame, at its centre, and its radii there.
pub(super) struct Shaped {
    pub(super) pose: Pose,
    pub(super) radii: DVec2,
}

impl Shaped {
    /// The ellipse around some corners in the plane of a frame; `None` of none.
    pub(super) fn around(corners: &[Vec3], pose: &Pose) -> Option<Self> {
        let flat = |pose: &Pose| -> Vec<DVec2> {
            corners.iter().map(|corner| pose.to_local(corner.as_dvec3()).truncate()).collect()
        };
        let turned = pose.turned(least_turn(&flat(pose)));
        let (center, radii) = around(&flat(&turned));
        let pose = Pose { center: turned.center + turned.axes * center.extend(0.0), ..turned };
        (!corners.is_empty()).then_some(Self { pose, radii })
    }
}
