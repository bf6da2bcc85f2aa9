//! A splat laid out for a given set of pieces.

use glam::{DMat3, DVec2, DVec3};

use super::grow::{Domain, Grower};
use super::region::Region;
use super::settle::{Candidate, settle};
use crate::analyse::surface::Surface;
use crate::fit::pose::Pose;

/// An ellipse around places goes on by this factor beyond the farthest, so that the turn and the
/// rounding of the splat leave them inside.
const OUTSET: f64 = 1.02;

/// No ellipse around places is more slender than this: those on a line have no width.
const SLENDEREST: f64 = 0.05;

/// Times an ellipse is laid out anew in the frame of the quadric found over the last one.
const ROUNDS: usize = 2;

/// Pieces that one splat is to cover.
pub(super) struct Need {
    pieces: Vec<u32>,
    /// The corners of the pieces.
    places: Vec<DVec3>,
    /// Margin by which the pieces of a cloud must lie inside.
    margin: f64,
    /// A frame at their middle.
    pose: Pose,
    /// How far from the middle the farthest lies.
    pub(super) reach: f64,
}

impl Need {
    /// A need of these pieces, ascending; `axes` are those of a splat over some of them. `None`
    /// for no pieces.
    pub(super) fn new(surface: &Surface, pieces: Vec<u32>, axes: DMat3) -> Option<Self> {
        let mut corners: Vec<u32> = pieces.iter().flat_map(|&piece| surface.pieces[piece as usize]).collect();
        corners.sort_unstable();
        corners.dedup();
        let places: Vec<DVec3> = corners.into_iter().map(|corner| surface.point(corner)).collect();
        let middle = places.iter().sum::<DVec3>() / places.len() as f64;
        let margin = pieces.iter().map(|&piece| surface.piece_margin(piece)).fold(0.0, f64::max);
        let reach = places.iter().map(|place| place.distance(middle)).fold(0.0, f64::max) + margin;
        let pose = Pose { center: middle, axes };
        (!pieces.is_empty()).then_some(Self { pieces, places, margin, pose, reach })
    }

    /// A splat that covers all of it, grown as far as that goes on.
    pub(super) fn covered(&self, grower: &Grower, region: &mut Region) -> Option<Candidate> {
        let piece = self.central(grower.surface);
        let seeds = grower.surface.pieces[piece as usize];
        let least = self.domain(grower, &seeds, region)?;
        let settled = |domain: Domain, region: &mut Region| {
            settle(grower, domain, &seeds, piece, region)
                .filter(|found| found.covers(self.pieces.iter().copied()))
        };
        let found = settled(least.clone(), region)?;
        // More than is needed leaves less for others to cover alone.
        let larger = grower.enlarged(least, &seeds, region);
        let grown = settled(larger, region);
        Some(grown.filter(|grown| grown.pieces.len() > found.pieces.len()).unwrap_or(found))
    }

    /// A domain that encloses all places.
    fn domain(&self, grower: &Grower, seeds: &[u32], region: &mut Region) -> Option<Domain> {
        let mut pose = self.pose;
        for _ in 0..ROUNDS {
            let (around, radii) = self.ellipse(&pose);
            let domain = grower.attempt(&around, radii, seeds, region).ok()?;
            let trusted = |place: &DVec3| {
                let local = domain.pose.to_local(*place);
                (local.truncate() / domain.radii).length_squared() <= 1.0
                    && grower.near(domain.curvature, local, 1.0)
            };
            if self.places.iter().all(trusted) {
                return Some(domain);
            }
            pose = domain.pose;
        }
        None
    }

    /// An ellipse along a frame's axes around all places, and the frame moved to its centre.
    fn ellipse(&self, pose: &Pose) -> (Pose, DVec2) {
        let flat = || self.places.iter().map(|&place| pose.to_local(place).truncate());
        let low = flat().fold(DVec2::INFINITY, DVec2::min);
        let high = flat().fold(DVec2::NEG_INFINITY, DVec2::max);
        let (center, half) = (0.5 * (low + high), (0.5 * (high - low)).max(DVec2::splat(f64::MIN_POSITIVE)));
        let half = half.max(DVec2::splat(SLENDEREST * half.max_element()));
        let scale = flat().map(|uv| ((uv - center) / half).length()).fold(0.0, f64::max);
        let moved = Pose { center: pose.center + pose.axes * center.extend(0.0), ..*pose };
        (moved, OUTSET * scale * half + self.margin)
    }

    /// The piece nearest to the middle.
    fn central(&self, surface: &Surface) -> u32 {
        let far = |piece: u32| surface.middle(piece).distance_squared(self.pose.center);
        self.pieces.iter().copied().min_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b))).unwrap_or(0)
    }
}
