//! The error budget in model units, shared out for sampling.

use glam::{DVec2, DVec3};

use crate::fit::clip::{ClipTolerance, Clips};
use crate::fit::pose::miss;
use crate::tolerance::{
    CLIP_LEAST_SHARE, CLIP_MISS_SHARE, CLIP_OUTSET_SHARE, CLIP_QUANTIZE_SHARE, CLOUD_LINE_SHARE,
    FAR_LINE_SHARE, FIT_SHARE, LINE_FIT_SHARE,
};

/// Distances that growing a splat must keep, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Between a point and the quadric that covers it, along `k`.
    pub fit: f64,
    /// The same for a point on a feature line: two surfaces meet there, each cut somewhat
    /// outside the line, and the nearer both pass the line the less remains of a slit.
    pub line: f64,
    /// The same once the splat is rounded and cut along its lines, in a cloud.
    pub cloud_line: f64,
    /// The same where splats of a cloud may pass lines at the greatest distance, if that is what it takes to do
    /// without a last resort.
    pub far_line: f64,
    /// How far a quadric may lie off the surface that it reaches over but need not cover, because
    /// another splat does: more than what it covers, since its error grows with the third power of the distance.
    pub rim: f64,
    /// How far, in space, a rim may stand out where the surface folds away below it, if that is what
    /// it takes to do without a last resort.
    pub overhang: f64,
    /// How far points of the input lie at most from the places of the surface that stand for them.
    pub moved: f64,
    /// How far a large domain goes on beyond what it is trusted to cover: see [`Self::padded`].
    pub pad: f64,
    /// For clip curves.
    pub clip: ClipTolerance,
    /// For clip curves that are rounded already: what rounding may take is theirs as well.
    pub stored: ClipTolerance,
}

/// Share of the bound by which a rim may stand out beside the surface, as cut borders do: where that is
/// as narrow as the bound, as the lip of a teapot is at one percent, no ellipse has it all below.
const OVERHANG_SHARE: f64 = 0.5;

/// Bounds by which a rim may lie off the surface: `backward max` comes to about as much. Beside meshes of the
/// same greatest error, files of five models are a sixth smaller than with rims that sink by two bounds, beside those
/// of the same rms or the same normals 3 %, though 3 % larger at the same bound. Rims of 1.2 make 3 % less of the
/// first, and 2 % more of the second.
const RIM: f64 = 1.4;

/// A rounded clip curve lies within this share of the bound of its line, in space, where it is looked at;
/// between such places it may lie a little farther off.
const STORED_EDGE_SHARE: f64 = 0.97;

/// Share of the bound that domains are padded by.
const PAD_SHARE: f64 = 0.75;

/// No radius is padded by more than this share of itself.
const PAD_RADIUS_SHARE: f64 = 0.25;

impl Budget {
    /// Shares out a bound in model units, for splats cut by these curves.
    #[must_use]
    pub fn new(max_error: f64, clips: Clips) -> Self {
        let clip = ClipTolerance {
            outset: CLIP_OUTSET_SHARE * max_error,
            miss: CLIP_MISS_SHARE * max_error,
            least: 0.0,
            edge: (1.0 - CLIP_QUANTIZE_SHARE) * max_error,
            rounding: CLIP_QUANTIZE_SHARE * max_error,
            clips,
        };
        Self {
            fit: FIT_SHARE * max_error,
            line: LINE_FIT_SHARE * max_error,
            cloud_line: CLOUD_LINE_SHARE * max_error,
            far_line: FAR_LINE_SHARE * max_error,
            rim: RIM * FIT_SHARE * max_error,
            overhang: OVERHANG_SHARE * max_error,
            moved: 0.0,
            pad: PAD_SHARE * max_error,
            clip,
            stored: ClipTolerance {
                miss: (CLIP_MISS_SHARE + CLIP_QUANTIZE_SHARE) * max_error,
                least: CLIP_LEAST_SHARE * max_error,
                edge: STORED_EDGE_SHARE * max_error,
                rounding: 0.0,
                ..clip
            },
        }
    }

    /// The same over a surface whose places lie up to a distance, in model units, off the input's points that they
    /// stand for.
    #[must_use]
    pub fn moved_by(self, moved: f64) -> Self {
        Self { moved, ..self }
    }

    /// Whether a quadric of this curvature lies so near to a place, in splat coordinates, that it may cover it, and the
    /// points of the input that it stands for. `slack` multiplies the distance allowed.
    #[must_use]
    pub fn covers(&self, curvature: DVec2, place: DVec3, slack: f64) -> bool {
        let slope = 2.0 * curvature * place.truncate();
        // A point aside of a place lies over what the quadric falls or rises by between them.
        let off = self.moved * (1.0 + slope.length_squared()).sqrt();
        miss(curvature, place) + off <= slack * self.fit
    }

    /// A share of all of it.
    #[must_use]
    pub fn scaled(&self, share: f64) -> Self {
        let &Self { fit, line, cloud_line, far_line, rim, overhang, moved, pad, clip, stored } = self;
        Self {
            fit: share * fit,
            line: share * line,
            cloud_line: share * cloud_line,
            far_line: share * far_line,
            rim: share * rim,
            overhang: share * overhang,
            moved,
            pad: share * pad,
            clip: clip.scaled(share),
            stored: stored.scaled(share),
        }
    }

    /// All of it for straight cuts that lie as far outside their lines as rounding allows: they miss nothing.
    #[must_use]
    pub fn cut_wide(&self) -> Self {
        let clip = ClipTolerance { outset: self.clip.edge - self.clip.rounding, ..self.clip };
        Self { clip, ..*self }
    }

    /// Whether a quadric may reach over a place that lies so far above it. `slack` multiplies the
    /// distances allowed.
    #[must_use]
    pub fn reaches(&self, above: f64, slack: f64) -> bool {
        above.abs() <= slack * self.rim
    }

    /// The radii of a splat that is trusted to cover an ellipse. It goes on a little beyond,
    /// so that neighbours overlap by more than the distance their surfaces may lie apart.
    #[must_use]
    pub fn padded(&self, trusted: DVec2) -> DVec2 {
        self.padded_by(trusted, self.pad)
    }

    /// The same with a padding other than the least.
    #[must_use]
    pub fn padded_by(&self, trusted: DVec2, pad: f64) -> DVec2 {
        trusted + (PAD_RADIUS_SHARE * trusted).min(DVec2::splat(pad))
    }

    /// The ellipse that a splat is trusted to cover: the inverse of [`Self::padded`].
    #[must_use]
    pub fn trusted(&self, radii: DVec2) -> DVec2 {
        (radii - self.pad).max(radii / (1.0 + PAD_RADIUS_SHARE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padding_and_trust_are_inverse() {
        let budget = Budget::new(0.01, Clips::Curved);
        for trusted in [DVec2::new(1e-4, 0.5), DVec2::new(0.02, 0.019), DVec2::new(0.0201, 3.0)] {
            assert!(budget.trusted(budget.padded(trusted)).distance(trusted) < 1e-15);
        }
    }

    #[test]
    fn what_was_moved_is_covered_only_where_the_places_it_came_from_are() {
        let whole = Budget::new(0.01, Clips::Curved);
        let moved = whole.moved_by(0.2 * whole.fit);
        let over = |share: f64| DVec3::new(0.0, 0.0, share * whole.fit);
        for (curvature, place, [before, after]) in [
            (DVec2::ZERO, over(0.75), [true, true]),
            (DVec2::ZERO, over(0.85), [true, false]),
            (DVec2::ZERO, over(1.05), [false, false]),
            // Where the quadric is steep, what lies aside lies over it.
            (DVec2::new(1.0, 0.0), DVec3::new(1.0, 0.0, 1.0), [true, true]),
            (DVec2::new(4.0, 0.0), DVec3::new(1.0, 0.0, 4.0), [true, false]),
        ] {
            assert_eq!([&whole, &moved].map(|budget| budget.covers(curvature, place, 1.0)), [before, after]);
        }
    }
}
