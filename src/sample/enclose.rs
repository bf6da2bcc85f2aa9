//! A splat laid out for a given set of pieces.

use glam::{DMat3, DVec2, DVec3};

use super::grow::{Domain, Grower};
use super::region::Region;
use super::settle::{Candidate, settle};
use super::shaped::{Shaped, boxed};
use crate::analyse::surface::Surface;
use crate::fit::pose::{Axes, Pose};

/// An ellipse around places goes on by this factor beyond the farthest, so that the turn and the
/// rounding of the splat leave them inside.
const OUTSET: f64 = 1.02;

/// The same where the least splat is looked for, the first that does: rounding turns a slender one so that its ends
/// move by more than its width.
const WIDER: [f64; 3] = [OUTSET, 1.1, 1.3];

/// Times an ellipse is laid out anew in the frame of the quadric found over the last one.
const ROUNDS: usize = 2;

/// Pieces that one splat is to cover.
pub(super) struct Need {
    pieces: Vec<u32>,
    /// The corners of the pieces, and of what those beside lines stand for.
    places: Vec<DVec3>,
    /// Margin by which the other pieces of a cloud must lie inside.
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
        let cells = || pieces.iter().map(|&piece| surface.cells.of(piece));
        let places = corners.into_iter().map(|corner| surface.point(corner));
        let places: Vec<DVec3> = places.chain(cells().flatten().map(|corner| corner.as_dvec3())).collect();
        let middle = places.iter().sum::<DVec3>() / places.len() as f64;
        let all_around = pieces.iter().zip(cells()).filter(|(_, cell)| cell.is_empty());
        let margin = all_around.map(|(&piece, _)| surface.piece_margin(piece)).fold(0.0, f64::max);
        let reach = places.iter().map(|place| place.distance(middle)).fold(0.0, f64::max) + margin;
        let pose = Pose { center: middle, axes };
        (!pieces.is_empty()).then_some(Self { pieces, places, margin, pose, reach })
    }

    /// A splat that covers all of it, grown as far as that goes on, along the first of some axes that do.
    pub(super) fn covered(&self, along: &[Axes], grower: &Grower, region: &mut Region) -> Option<Candidate> {
        along.iter().find_map(|&axes| self.laid_out(axes, grower).grown(region))
    }

    /// A splat that covers all of it and goes on as little beyond as can be.
    pub(super) fn enclosed(&self, axes: Axes, grower: &Grower, region: &mut Region) -> Option<Candidate> {
        self.laid_out(axes, grower).least(region)
    }

    /// Splats laid out for it along the principal axes of what lies there, or along the box around it, in which
    /// a strip is narrow whichever way it bends.
    fn laid_out<'a>(&'a self, axes: Axes, grower: &Grower<'a>) -> Layout<'a> {
        let pose = match axes {
            Axes::Principal => self.pose,
            Axes::Held => boxed(&self.places, &self.pose),
        };
        Layout { need: self, grower: Grower { axes, ..*grower }, pose, piece: self.central(grower.surface) }
    }

    /// The piece nearest to the middle.
    fn central(&self, surface: &Surface) -> u32 {
        let far = |piece: u32| surface.middle(piece).distance_squared(self.pose.center);
        self.pieces.iter().copied().min_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b))).unwrap_or(0)
    }
}

/// A need, and a frame to begin from.
struct Layout<'a> {
    need: &'a Need,
    grower: Grower<'a>,
    pose: Pose,
    /// The piece that a splat grows from.
    piece: u32,
}

impl Layout<'_> {
    fn seeds(&self) -> [u32; 3] {
        self.grower.surface.pieces[self.piece as usize]
    }

    /// A splat grown as far as that goes on.
    fn grown(&self, region: &mut Region) -> Option<Candidate> {
        let least = self.domain(OUTSET, region)?;
        let found = self.settled(least.clone(), region)?;
        // More than is needed leaves less for others to cover alone.
        let larger = self.grower.enlarged(least, &self.seeds(), region);
        let grown = self.settled(larger, region);
        Some(grown.filter(|grown| grown.pieces.len() > found.pieces.len()).unwrap_or(found))
    }

    /// The least splat.
    fn least(&self, region: &mut Region) -> Option<Candidate> {
        WIDER.into_iter().find_map(|outset| {
            let domain = self.domain(outset, region)?;
            self.settled(domain, region)
        })
    }

    /// The splat of a domain, if it covers all of the need.
    fn settled(&self, domain: Domain, region: &mut Region) -> Option<Candidate> {
        settle(&self.grower, domain, &self.seeds(), self.piece, region)
            .filter(|found| found.covers(self.need.pieces.iter().copied()))
    }

    /// A domain that encloses all places and goes on beyond them by a factor.
    fn domain(&self, outset: f64, region: &mut Region) -> Option<Domain> {
        let mut pose = self.pose;
        for _ in 0..ROUNDS {
            let (around, radii) = self.ellipse(&pose, outset);
            let domain = self.grower.attempt(&around, radii, &self.seeds(), region).ok()?;
            let trusted = |place: &DVec3| {
                let local = domain.pose.to_local(*place);
                (local.truncate() / domain.radii).length_squared() <= 1.0
                    && self.grower.near(domain.curvature, local, 1.0)
            };
            if self.need.places.iter().all(trusted) {
                return Some(domain);
            }
            pose = domain.pose;
        }
        None
    }

    /// An ellipse along a frame's axes around all places, and the frame moved to its centre.
    fn ellipse(&self, pose: &Pose, outset: f64) -> (Pose, DVec2) {
        let Shaped { pose, radii } = Shaped::along(&self.need.places, pose);
        (pose, outset * radii + self.need.margin)
    }
}
