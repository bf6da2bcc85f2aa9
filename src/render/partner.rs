//! What clip partners cut away; twin of `partner.wgsl`.
//!
//! A partner's quadric is given in the coordinates of the splat that it cuts, so that a fragment
//! needs no more than its own place in them.

use glam::{DMat3, DVec2, DVec3};

use crate::model::partner::{Group, Partner};
use crate::model::splat::Splat;

/// A partner in the coordinates of the splat that it cuts: `axes * place + origin` is a place in
/// the partner's own.
#[derive(Clone, Copy, Debug)]
pub struct LocalPartner {
    /// Rows `i, j, k` of the partner, the last with the sign that is positive where it cuts.
    pub axes: DMat3,
    /// The splat's centre.
    pub origin: DVec3,
    /// `(a, b)`, with that sign.
    pub curvature: DVec2,
    /// How far beyond its surface it begins to cut.
    pub outset: f64,
}

/// A group of partners in the coordinates of the splat that they cut.
#[must_use]
pub fn locals(group: &Group, splat: &Splat) -> Vec<LocalPartner> {
    group.iter().map(|partner| LocalPartner::new(partner, splat)).collect()
}

impl LocalPartner {
    fn new(partner: &Partner, splat: &Splat) -> Self {
        let signs = DMat3::from_diagonal(DVec3::new(1.0, 1.0, partner.cut.sign()));
        let to_partner = signs * partner.sheet.axes.transpose();
        Self {
            axes: to_partner * splat.axes,
            origin: to_partner * (splat.center - partner.sheet.center),
            curvature: partner.cut.sign() * partner.sheet.curvature,
            outset: partner.outset,
        }
    }

    /// Whether it cuts a place of the splat, in the splat's `(u, v, w)`.
    fn cuts(&self, place: DVec3) -> bool {
        let there = self.axes * place + self.origin;
        let uv = there.truncate();
        there.z - (self.curvature * uv).dot(uv) > self.outset
    }
}

/// Whether all partners of some group cut a place of the splat away.
#[must_use]
pub fn clipped_away(groups: &[Vec<LocalPartner>], place: DVec3) -> bool {
    groups.iter().any(|group| group.iter().all(|partner| partner.cuts(place)))
}
