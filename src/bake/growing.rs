//! How splats grow, over whatever surface; what is begun over a mesh before its pieces are small enough.

use super::Progress;
use super::analysed::MOST_PIECES;
use crate::analyse::mesh_surface::Marked;
use crate::analyse::refine::{Fineness, Side};
use crate::analyse::surface::Surface;
use crate::fit::clip::Clips;
use crate::fit::pose::Shapes;
use crate::sample::budget::Budget;
use crate::sample::candidates::Regions;
use crate::sample::grow::{Grower, Round};
use crate::sample::outline::open_sides;
use crate::sample::scout::{Begun, scout};

/// All that growing takes but a surface.
pub(super) struct Growing<'a> {
    pub(super) budget: Budget,
    pub(super) shapes: Shapes,
    pub(super) round: &'a Round<'a>,
}

impl Growing<'_> {
    /// A grower over a surface with such sides.
    pub(super) fn over<'s>(&'s self, surface: &'s Surface, open: &'s [bool]) -> Grower<'s> {
        let &Self { budget, shapes, round } = self;
        Grower { shapes, open, ..Grower::new(surface, budget, round) }
    }

    /// The sides across which nothing lies, as [`open_sides`], where splats that partners cut have to know.
    pub(super) fn open_sides(&self, surface: &Surface) -> Vec<bool> {
        match self.budget.clip.clips {
            Clips::Partners => open_sides(surface),
            Clips::Curved | Clips::Straight => Vec::new(),
        }
    }

    /// The surface of a mesh with pieces small beside the splats that will cover them, and splats begun.
    pub(super) fn begun(
        &self,
        surface: Surface,
        marked: Marked,
        progress: &mut dyn Progress,
    ) -> (Surface, Begun) {
        let total = surface.pieces.len() as u64;
        let open = self.open_sides(&surface);
        let (grower, regions) = (self.over(&surface, &open), Regions::new(surface.points.len()));
        let scouted = scout(&grower, &regions, |done| progress.advance(done as u64, total));
        let too_long = |side: &Side| scouted.is_long(side.face, side.way);
        let (finer, part_of) = marked.refined(&Fineness { too_long: &too_long, most: MOST_PIECES });
        let surface = if part_of.len() > surface.pieces.len() { finer.surface() } else { surface };
        (surface, scouted.begun(&part_of))
    }
}
