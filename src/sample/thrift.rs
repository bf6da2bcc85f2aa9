//! Other clip curves for the chosen splats, where whoever stores them knows some that cost less.

use glam::{DVec2, DVec3};

use super::backing::{Backing, Look};
use super::candidates::Regions;
use super::cover::Cover;
use super::grow::{Cut, Grower, passes, well_inside};
use super::outline::Outline;
use super::region::Region;
use super::settle::{Candidate, ROUNDED_SLACK};
use super::steps::Steps;
use crate::error::Result;
use crate::fit::clip::ClipTolerance;
use crate::fit::pose::Pose;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::splat::Splat;
use crate::model::trial::Trial;

/// Changes the clip curves of splats to others that cost less to store, as far as these will do. For those
/// who store nothing: `|_, _| Ok(())`.
pub type Saving<'a> = dyn Fn(&mut [Splat], &mut dyn Trial) -> Result<()> + Sync + 'a;

/// Times that all curves are gone through: from the second on those of the splats beside one are what they will be, or
/// nearly so.
const ROUNDS: usize = 2;

impl Cover {
    /// Lets clip curves of the chosen be changed, under the bound of the file; not where splats lie in heaps.
    ///
    /// # Errors
    /// Those of `saving`.
    pub fn save(
        &mut self,
        grower: &Grower,
        regions: &Regions,
        max_error: f64,
        saving: &Saving<'_>,
    ) -> Result<()> {
        let mut splats = self.splats();
        regions.with(|region| {
            let (candidates, chosen) = (&self.candidates, &self.chosen);
            let Some(steps) = Steps::new(&splats, max_error) else { return Ok(()) };
            let mut cuts = Cuts { grower, candidates, chosen, region, steps, at: None };
            (0..ROUNDS).try_for_each(|_| saving(&mut splats, &mut cuts))
        })?;
        for (&index, splat) in self.chosen.iter().zip(splats) {
            self.candidates[index].splat = splat;
        }
        Ok(())
    }
}

/// The cuts of the chosen candidates, of which one is at hand.
struct Cuts<'a> {
    grower: &'a Grower<'a>,
    candidates: &'a [Candidate],
    chosen: &'a [usize],
    region: &'a mut Region,
    steps: Steps,
    at: Option<Uncut<'a>>,
}

/// A splat without its clip curves, and what these have to leave of it.
struct Uncut<'a> {
    splat: &'a Splat,
    /// What it is to be cut along.
    outlines: Vec<Outline>,
    backing: Backing<'a>,
    /// Places of the outlines that its border follows now. Elsewhere the rim may bound it instead, just beyond a line.
    followed: Vec<DVec3>,
    /// Places that it covers.
    covered: Vec<DVec2>,
    /// Places that it strays from, and that are cut away.
    strayed: Vec<DVec2>,
}

impl Trial for Cuts<'_> {
    fn turn_to(&mut self, splat: usize) {
        let candidate = &self.candidates[self.chosen[splat]];
        self.at = uncut(candidate, self.grower, self.region);
        self.steps.turn_to(splat);
    }

    fn steps(&self, clips: &[ClipCurve]) -> f64 {
        self.steps.sum(clips)
    }

    fn will_do(&mut self, clips: &[ClipCurve]) -> bool {
        let Some(Uncut { splat, outlines, backing, followed, covered, strayed }) = &self.at else {
            return false;
        };
        let tolerance = &self.grower.budget.stored;
        let conics: Vec<Conic> = clips.iter().map(|clip| clip.conic(splat.radii)).collect();
        let cuts = |uv: &DVec2| conics.iter().any(|conic| conic.cuts(*uv));
        let cut = Cut { clips, radii: splat.radii, curvature: splat.curvature };
        !covered.iter().any(cuts)
            && strayed.iter().all(cuts)
            && cut
                .border_along(outlines, tolerance, Look::Fine)
                .is_some_and(|border| followed.iter().all(|&place| passes(&border, place, tolerance.edge)))
            && backing.holds(clips)
    }

    fn take(&mut self, clips: Vec<ClipCurve>) {
        self.steps.take(clips);
    }
}

/// A candidate without its clip curves; `None` for one of last resort, which is cut otherwise.
fn uncut<'a>(candidate: &'a Candidate, grower: &'a Grower, region: &mut Region) -> Option<Uncut<'a>> {
    let splat = &candidate.splat;
    let outlines = candidate.outlines(grower, region)?;
    let pose = Pose { center: splat.center, axes: splat.axes };
    let backing = Backing::of(grower, &pose, splat.radii, splat.curvature, region, Look::Fine);
    let (covered, strayed) = (covered(candidate, grower), strayed(splat, grower, region));
    let followed = followed(splat, &outlines, &grower.budget.stored);
    Some(Uncut { splat, outlines, backing, followed, covered, strayed })
}

/// The places of outlines, farther inside a splat's ellipse than curves lie outside lines, that its border passes
/// within the tolerance for edges. Nearer to the rim a line is left for the next splat along it.
fn followed(splat: &Splat, outlines: &[Outline], tolerance: &ClipTolerance) -> Vec<DVec3> {
    let cut = Cut { clips: &splat.clips, radii: splat.radii, curvature: splat.curvature };
    let border = cut.border(tolerance);
    let places = outlines.iter().flat_map(Outline::places);
    let inside = places.filter(|&place| well_inside(place, splat.radii, tolerance.outset));
    inside.filter(|&place| passes(&border, place, tolerance.edge)).collect()
}

/// The corners of what a candidate covers, or the spots.
fn covered(candidate: &Candidate, grower: &Grower) -> Vec<DVec2> {
    let surface = grower.surface;
    let local = |place| candidate.splat.to_local(place).truncate();
    let pieces = || candidate.pieces.iter().map(|&piece| piece as usize);
    if !surface.spots.is_empty() {
        return pieces().map(|piece| local(surface.spots[piece].position.as_dvec3())).collect();
    }
    let mut corners: Vec<u32> = pieces().flat_map(|piece| surface.pieces[piece]).collect();
    corners.sort_unstable();
    corners.dedup();
    corners.into_iter().map(|corner| local(surface.point(corner))).collect()
}

/// The spots of a cloud below a splat that it strays from; where triangles are, it strays from none.
fn strayed(splat: &Splat, grower: &Grower, region: &Region) -> Vec<DVec2> {
    let surface = grower.surface;
    if surface.spots.is_empty() {
        return Vec::new();
    }
    let spots = region.reached().flat_map(|point| surface.pieces_of.row(point));
    let locals = spots.map(|&spot| splat.to_local(surface.spots[spot as usize].position.as_dvec3()));
    let below = locals.filter(|local| splat.ellipse(local.truncate()) <= 1.0);
    below
        .filter(|local| !grower.reaches(splat.curvature, *local, ROUNDED_SLACK))
        .map(|local| local.truncate())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::clip::Clips;
    use crate::sample::budget::Budget;
    use crate::sample::cover::tests::candidate;
    use std::f64::consts::PI;

    #[test]
    fn a_curve_that_leaves_the_ellipse_beside_a_line_does_not_follow_it() {
        let tolerance = Budget::new(0.1, Clips::Curved).stored;
        let mut splat = candidate(&[]).splat;
        splat.radii = DVec2::new(2.4, 0.225);
        let line = [DVec2::new(-3.0, -0.1), DVec2::new(3.0, -0.1)].to_vec();
        let outline = Outline { points: line, heights: vec![0.0; 2], closed: false, ends: false };
        // Along the line, and past it beyond the rim, which lies within the bound of it.
        let along = |angle: f64| ClipCurve::chord(PI + angle, -angle);
        let bulging = ClipCurve { p2: DVec2::new(0.0, -0.5), rho: 0.5, ..along(0.02) };
        splat.clips = vec![along(0.05)];
        let places = followed(&splat, &[outline], &tolerance);
        let all = |clip: ClipCurve| {
            let cut = Cut { clips: &[clip], radii: splat.radii, curvature: splat.curvature };
            let border = cut.border(&tolerance);
            places.iter().all(|&place| passes(&border, place, tolerance.edge))
        };
        assert!(places.len() > 1, "{places:?}");
        assert!(all(along(0.06)) && !all(bulging));
    }
}
