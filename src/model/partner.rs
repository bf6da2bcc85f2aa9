//! Clip partners: splats across an edge whose surfaces cut a splat.
//!
//! Ivo, Vidal and Cavalcante-Neto, "A new method for cutting splats of models with sharp
//! features", sections IV and V: a fragment is tested in object space against the partners of
//! its splat. Theirs are planes; here a partner cuts by its whole quadric, carried on beyond its
//! ellipse, and a little late ([`PARTNER_OUTSET_SHARE`]), so that no slit opens.

use glam::{DMat3, DVec2, DVec3};

use super::splat::Splat;
use crate::tolerance::PARTNER_OUTSET_SHARE;

/// Which part of space a partner cuts away. A partner *sees* what lies above its surface, on the
/// side that its normal points to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cut {
    /// What it sees: the edge is convex (equation 19).
    Seen,
    /// What it does not see: the edge is concave (equation 18).
    Unseen,
}

impl Cut {
    /// The factor that makes a height over the partner positive where it cuts.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Seen => 1.0,
            Self::Unseen => -1.0,
        }
    }
}

/// A splat's surface, carried on beyond its ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// `C`.
    pub center: DVec3,
    /// Columns `i, j, k`.
    pub axes: DMat3,
    /// `(a, b)`.
    pub curvature: DVec2,
}

impl Sheet {
    /// The surface of a splat.
    #[must_use]
    pub fn of(splat: &Splat) -> Self {
        Self { center: splat.center, axes: splat.axes, curvature: splat.curvature }
    }

    /// How far a point lies above it, along `k`.
    #[must_use]
    pub fn above(&self, point: DVec3) -> f64 {
        let local = self.axes.transpose() * (point - self.center);
        let uv = local.truncate();
        local.z - (self.curvature * uv * uv).element_sum()
    }
}

/// A splat that cuts another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partner {
    /// Its index among the asset's splats.
    pub splat: u32,
    /// What it cuts away.
    pub cut: Cut,
    /// Its surface.
    pub sheet: Sheet,
    /// How far beyond its surface it begins to cut, model units.
    pub outset: f64,
}

impl Partner {
    /// Splat number `index` as a partner, in an asset with this error bound (model units).
    #[must_use]
    pub fn new(index: u32, splat: &Splat, cut: Cut, max_error: f64) -> Self {
        Self { splat: index, cut, sheet: Sheet::of(splat), outset: PARTNER_OUTSET_SHARE * max_error }
    }

    /// How far within the part of space that it cuts away a point lies; negative outside.
    #[must_use]
    pub fn depth(&self, point: DVec3) -> f64 {
        self.cut.sign() * self.sheet.above(point) - self.outset
    }
}

/// Partners whose areas intersect: a point is cut away where all of them cut it (equation 21).
///
/// Of several groups the areas unite (equation 20), so partners whose areas unite are groups of
/// one. Never empty.
pub type Group = Vec<Partner>;

/// Whether some group cuts a point away.
#[must_use]
pub fn cuts(groups: &[Group], point: DVec3) -> bool {
    groups.iter().any(|group| group.iter().all(|partner| partner.depth(point) > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane through a place.
    fn plane(index: u32, at: DVec3, normal: DVec3, cut: Cut) -> Partner {
        let (i, j) = normal.any_orthonormal_pair();
        let splat = Splat {
            center: at,
            axes: DMat3::from_cols(i, j, normal),
            radii: DVec2::ONE,
            curvature: DVec2::ZERO,
            clips: Vec::new(),
            partners: Vec::new(),
            color: [255; 3],
        };
        Partner::new(index, &splat, cut, 0.01)
    }

    #[test]
    fn groups_unite_and_their_partners_intersect() {
        let x = plane(0, DVec3::X, DVec3::X, Cut::Seen);
        let y = plane(1, DVec3::Y, DVec3::NEG_Y, Cut::Unseen);
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.3);
        let (union, intersection) = ([vec![x], vec![y]], [vec![x, y]]);
        for (point, by_union, by_intersection) in [
            (at(0.5, 0.5), false, false),
            (at(1.5, 0.5), true, false),
            (at(0.5, 1.5), true, false),
            (at(1.5, 1.5), true, true),
            // Within the outset of a plane nothing is cut.
            (at(1.0 + 0.9 * x.outset, 0.5), false, false),
        ] {
            assert_eq!(cuts(&union, point), by_union, "{point}");
            assert_eq!(cuts(&intersection, point), by_intersection, "{point}");
        }
        assert!(!cuts(&[], at(9.0, 9.0)));
    }

    #[test]
    fn a_bent_partner_cuts_by_its_quadric() {
        let mut bowl = plane(0, DVec3::ZERO, DVec3::Z, Cut::Seen);
        bowl.sheet.curvature = DVec2::splat(0.5);
        let along = bowl.sheet.axes.x_axis;
        assert!(bowl.depth(along + DVec3::Z * 0.51) > 0.0 && bowl.depth(along + DVec3::Z * 0.49) < 0.0);
    }
}
