//! Grows the largest splat around a seed that stays within the budget.
//!
//! After Wu and Kobbelt 2004: the domain grows until the fit's largest error passes the
//! bound. Here it is an ellipse in the principal frame, grown by `super::enlarge`, and it is cut where
//! the walk over the surface meets a border.

use std::cell::Cell;

use glam::{DVec2, DVec3};

use super::backing::{Backing, Look};
use super::budget::Budget;
use super::outline::{Outline, holds_an_end, outlines};
use super::region::{Member, Region};
use super::settle::{Candidate, settle};
use super::starts::Starts;
use crate::analyse::surface::Surface;
use crate::fit::clip::{self, ClipTolerance, Clips};
use crate::fit::ellipse::{crossings, holds};
use crate::fit::limits::{self, Limited};
use crate::fit::pose::{Axes, Fitting, Pose, Principal, Shapes, above, miss, principal};
use crate::fit::quadric::{RIDGE, STIFF_RIDGE};
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::splat::Splat;

/// More clip curves than this on one splat cost about as much as a second splat would: with 32, files are between
/// 0.4 % smaller (a truck) and 1 % larger (a sheet with a hundred holes).
pub(super) const MOST_CLIPS: usize = 8;

/// A fit that turns the normal by more than this (cosine of 3°) is judged on what its own
/// ellipse reaches.
const TURNED: f64 = 0.9986;

/// No quadric may slope more than this at the rim (about 76°): beyond, a height over the
/// tangent plane says little of the distance between surfaces.
const STEEPEST: f64 = 4.0;

/// Points on lines count this many times in the fit, since they must lie nearer.
const LINE_WEIGHT: f64 = 4.0;

/// A quadric of six terms needs no more members than this to be fitted to, borders and rim
/// aside; all are judged.
const MOST_FITTED: usize = 320;

/// Up to this share of an ellipse its quadric is held to the budget for fits, as if it were to cover all
/// of it. At 0.6 to 0.9 files are of one size, at 0 (no part) 5 % larger. Beyond, it is held to the budget
/// for rims.
const COVERED_SHARE: f64 = 0.8;

/// Principal directions matter where the two sagittas differ by this share of the budget.
const ROUND_SHARE: f64 = 0.1;

/// How many times steps are halved where splats do not keep the budget otherwise. With the second a threaded bolt takes
/// 2 to 6 % fewer bytes than with the first alone; with a third most models take 1 to 2 % more.
const HALVINGS: [u8; 2] = [1, 2];

/// Why a domain does not keep the budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A seed lies outside the ellipse.
    Seed,
    /// The surface strays from every quadric.
    Fit,
    /// No clip curves could be fitted to an outline.
    Clip,
    /// The clip curves fitted stray from the outline, or cut the surface.
    Stray,
    /// Below a part of the rim that is not cut away there is no surface.
    Bare,
}

/// What a splat without clip curves comes back as from whatever will store it in steps halved at least so many
/// times; `None` if it cannot be stored.
pub type Round<'a> = dyn Fn(&Splat, u8) -> Option<Splat> + Sync + 'a;

/// Everything growing needs that stays the same from seed to seed.
pub struct Grower<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// The distances to keep.
    pub budget: Budget,
    /// What splats may be pieces of.
    pub shapes: Shapes,
    /// Which way their axes lie.
    pub axes: Axes,
    /// Where nothing lies across a border ([`super::outline::open_sides`]), for splats that
    /// partners cut; else empty.
    pub open: &'a [bool],
    /// How far a rim may stand out beside a mesh: 0, or [`Budget::overhang`].
    pub overhang: f64,
    /// Splats are rounded before they are judged and cut, so that storing them changes
    /// nothing that was judged.
    pub round: &'a Round<'a>,
    /// How many times the steps of that are halved at least.
    pub fineness: u8,
}

/// On a close look this many times as many places are looked at along a clip curve as on a quick one: between
/// those of a quick one a curve may lie some hundredths of the bound farther off its line.
const FINER: f64 = 4.0;

/// Clip curves over a quadric.
pub(super) struct Cut<'a> {
    pub(super) clips: &'a [ClipCurve],
    pub(super) radii: DVec2,
    pub(super) curvature: DVec2,
}

impl Cut<'_> {
    /// Whether they cut along outlines and nowhere else, and at every corner of these.
    pub(super) fn follows(&self, outlines: &[Outline], tolerance: &ClipTolerance, look: Look) -> bool {
        self.border_along(outlines, tolerance, look).is_some()
    }

    /// Places along the border that they give the splat, in splat coordinates, if it [follows](Self::follows)
    /// outlines.
    ///
    /// What is looked at closely keeps the tolerance for edges, in space.
    pub(super) fn border_along(
        &self,
        outlines: &[Outline],
        tolerance: &ClipTolerance,
        look: Look,
    ) -> Option<Vec<DVec3>> {
        let (reach, finer) = match look {
            Look::Coarse => (tolerance.reach(), 1.0),
            Look::Fine => (tolerance.edge, FINER),
        };
        let conics = self.conics();
        let cuts = |uv: DVec2| conics.iter().any(|conic| conic.cuts(uv));
        let followed = |line: &Outline| clip::follows(&line.points, line.closed, self.radii, cuts, tolerance);
        let last = vec![Cell::new(0); outlines.len()];
        let mut border = Vec::new();
        let along = |uv: DVec2| {
            let place = self.lifted(uv);
            border.push(place);
            outlines.iter().zip(&last).any(|(line, last)| line.near(place, reach, last))
        };
        let follows = outlines.iter().all(followed)
            && clip::border(&conics, self.radii, tolerance, finer).all(along)
            && (look == Look::Coarse || self.reaches_corners(outlines, reach, &border));
        follows.then_some(border)
    }

    /// Places along the border, whatever it follows, as close as on a close look.
    pub(super) fn border(&self, tolerance: &ClipTolerance) -> Vec<DVec3> {
        clip::border(&self.conics(), self.radii, tolerance, FINER).map(|uv| self.lifted(uv)).collect()
    }

    fn conics(&self) -> Vec<Conic> {
        self.clips.iter().map(|clip| clip.conic(self.radii)).collect()
    }

    /// The place of the quadric over another.
    fn lifted(&self, uv: DVec2) -> DVec3 {
        uv.extend((self.curvature * uv * uv).element_sum())
    }

    /// Whether every corner of outlines that lies well inside the ellipse has a place of a border within
    /// `reach`: where the quadric slopes, one that is near enough in the plane may not be.
    fn reaches_corners(&self, outlines: &[Outline], reach: f64, border: &[DVec3]) -> bool {
        let corners = outlines.iter().flat_map(Outline::corners);
        corners
            .filter(|&corner| well_inside(corner, self.radii, reach))
            .all(|corner| passes(border, corner, reach))
    }
}

/// Whether a place lies in an ellipse, by a margin off each of its radii.
pub(super) fn well_inside(place: DVec3, radii: DVec2, margin: f64) -> bool {
    let inner = radii - margin;
    inner.min_element() > 0.0 && holds(place.truncate(), inner)
}

/// Whether a border, by places along it, passes another within `reach`.
pub(super) fn passes(border: &[DVec3], place: DVec3, reach: f64) -> bool {
    border.iter().any(|on| on.distance(place) <= reach)
}

/// A pose and radii with the quadric found for them.
#[derive(Clone, Debug, Default)]
pub(super) struct Domain {
    pub(super) pose: Pose,
    /// Of the ellipse that is trusted to cover; the splat's own goes on by the pad.
    pub(super) radii: DVec2,
    pub(super) curvature: DVec2,
    pub(super) rank: u8,
    /// How many points the ellipse reaches and the quadric covers.
    pub(super) members: usize,
    /// How far from the centre they lie along each axis.
    pub(super) extent: DVec2,
}

impl<'a> Grower<'a> {
    /// A grower of all shapes along their principal axes, whose rims stand out nowhere, for splats that curves cut.
    #[must_use]
    pub fn new(surface: &'a Surface, budget: Budget, round: &'a Round<'a>) -> Self {
        let (shapes, axes) = (Shapes::All, Axes::Principal);
        Self { surface, budget, shapes, axes, open: &[], overhang: 0.0, round, fineness: 0 }
    }
}

impl Grower<'_> {
    /// The largest splat found around a piece that covers it; `None` if even the least does
    /// not keep the budget.
    pub fn grow(&self, piece: u32, region: &mut Region) -> Option<Candidate> {
        self.grown(Starts::of(self, piece).least(), piece, region)
    }

    /// The same for a piece that this fails for, in finer steps: where rounding moves what has grown off its lines, it
    /// would have to be smaller by more than these cost.
    pub fn grow_finer(&self, piece: u32, region: &mut Region) -> Option<Candidate> {
        self.finer().find_map(|finer| finer.grow(piece, region))
    }

    /// Growers of splats that are rounded in finer steps.
    pub(super) fn finer(&self) -> impl Iterator<Item = Self> {
        HALVINGS.into_iter().map(|fineness| Self { fineness, ..*self })
    }

    /// A splat as it comes back from whatever will store it.
    pub(super) fn rounded(&self, splat: &Splat) -> Option<Splat> {
        (self.round)(splat, self.fineness)
    }

    /// The same for a piece that this fails for, from ellipses along it that are broader than a sliver.
    pub fn grow_broad(&self, piece: u32, region: &mut Region) -> Option<Candidate> {
        let held = Self { axes: Axes::Held, ..*self };
        held.grown(Starts::of(self, piece).broad(), piece, region)
    }

    /// The largest splat found from the first of some starts that leads to one.
    fn grown(
        &self,
        mut starts: impl Iterator<Item = (Pose, DVec2)>,
        piece: u32,
        region: &mut Region,
    ) -> Option<Candidate> {
        let seeds = self.surface.pieces[piece as usize];
        starts.find_map(|(pose, radii)| {
            let least = self.attempt(&pose, radii, &seeds, region).ok()?;
            let around = self.grown_around(least, &seeds, region);
            let aside = self.grown_aside(around.clone(), &seeds, region);
            // One that grew to a side may hold only where it is smaller, and there its seed lies outside: of scan
            // lines far apart a quarter of the points took a last resort for that.
            settle(self, aside, &seeds, piece, region).or_else(|| settle(self, around, &seeds, piece, region))
        })
    }

    /// The domain that [`Self::grow`] would make a splat of, before it is rounded and cut with care.
    pub(super) fn domain(&self, piece: u32, region: &mut Region) -> Option<Domain> {
        let seeds = self.surface.pieces[piece as usize];
        let mut starts = Starts::of(self, piece).least();
        let least = starts.find_map(|(pose, radii)| self.attempt(&pose, radii, &seeds, region).ok())?;
        Some(self.enlarged(least, &seeds, region))
    }

    /// The same for a piece that this fails for: rims may stand out a little where the surface folds
    /// away.
    pub fn grow_overhanging(&self, piece: u32, region: &mut Region) -> Option<Candidate> {
        Self { overhang: self.budget.overhang, ..*self }.grow(piece, region)
    }

    /// The same for a spot of a cloud: a splat may pass lines at a greater distance, as far as its cuts still follow
    /// them within the bound. Partners begin to cut no farther outside than the lesser distance allows.
    pub fn grow_beside_lines(&self, piece: u32, region: &mut Region) -> Option<Candidate> {
        if self.budget.clip.clips == Clips::Partners {
            return None;
        }
        let line = self.budget.far_line;
        let budget = Budget { line, cloud_line: line, ..self.budget };
        Self { budget, ..*self }.grow(piece, region)
    }

    /// Fits a splat to what an ellipse reaches; why not, if it does not keep the budget.
    pub(super) fn attempt(
        &self,
        pose: &Pose,
        radii: DVec2,
        seeds: &[u32],
        region: &mut Region,
    ) -> Result<Domain, Stop> {
        let outer = self.budget.padded(radii);
        if !region.gather(self.surface, pose, outer, seeds) {
            return Err(Stop::Seed);
        }
        let fitted = self.fitted(pose, outer, region).ok_or(Stop::Fit)?;
        if fitted.pose.axes.z_axis.dot(pose.axes.z_axis) < TURNED {
            // The ellipse has turned so far that it reaches other points.
            if !region.gather(self.surface, &fitted.pose, outer, seeds) {
                return Err(Stop::Seed);
            }
        } else {
            for member in &mut region.members {
                member.local = fitted.pose.to_local(self.surface.point(member.point));
            }
        }
        if !self.keeps(&fitted.pose, outer, fitted.curvature, self.budget.line, 1.0, region) {
            return Err(Stop::Fit);
        }
        let clips = self.clips(&fitted.pose, outer, fitted.curvature, Look::Coarse, region)?;
        if !Backing::of(self, &fitted.pose, outer, fitted.curvature, region, Look::Coarse).holds(&clips) {
            return Err(Stop::Bare);
        }
        // The seeds come first of the members.
        let seeds_near = region.members.iter().take_while(|member| seeds.contains(&member.point));
        if !seeds_near.clone().all(|member| self.near(fitted.curvature, member.local, 1.0)) {
            return Err(Stop::Fit);
        }
        let near = |member: &&Member| self.near(fitted.curvature, member.local, 1.0);
        let members = region.members.iter().filter(near).count();
        let extents = region.members.iter().filter(near).map(|member| member.local.truncate().abs());
        let extent = extents.fold(DVec2::ZERO, DVec2::max);
        let Principal { pose, curvature, rank, .. } = fitted;
        Ok(Domain { pose, radii, curvature, rank, members, extent })
    }

    /// The quadric of members and rim, in its principal frame; `None` if it is too steep. Where the
    /// least-squares fit does not keep the budget, another that does is looked for.
    fn fitted(&self, pose: &Pose, outer: DVec2, region: &Region) -> Option<Principal> {
        let largest = outer.max_element();
        let least = ROUND_SHARE * self.budget.fit / (largest * largest);
        let mut places = self.limited(pose, outer, region);
        let too_steep = |fit: &Principal| (2.0 * fit.curvature * outer).abs().max_element() > STEEPEST;
        // Points of a strip say little of the curvature across it, and what they say may be
        // nothing but their distance from the strip's own surface.
        let (fitting, fit) = [RIDGE, STIFF_RIDGE].into_iter().find_map(|ridge| {
            let fitting =
                Fitting { shapes: self.shapes, axes: self.axes, least, ridge, ..Fitting::within(largest) };
            let weighted = places.iter().map(|place| (place.point, place.weight));
            let fit = principal(pose, &fitting, weighted);
            (!too_steep(&fit)).then_some((fitting, fit))
        })?;
        let kept = limits::within(&fit, &fitting, &mut places).filter(|kept| !too_steep(kept));
        Some(kept.unwrap_or(fit))
    }

    /// What a quadric over an ellipse is fitted to, and the budget there: for what it should cover, on
    /// lines, and near the rim.
    fn limited(&self, pose: &Pose, outer: DVec2, region: &Region) -> Vec<Limited> {
        let Budget { fit, line, rim: off, .. } = self.budget;
        // Every so many-th of the members, which come ring by ring: the sums hardly change.
        let stride = region.members.len().div_ceil(MOST_FITTED);
        let members = region.members.iter().step_by(stride).map(|member| {
            let (weight, range) = if self.surface.on_border(member.point) {
                (LINE_WEIGHT, [-line, line])
            } else if (member.local.truncate() / outer).length() < COVERED_SHARE {
                (1.0, [-fit, fit])
            } else {
                (1.0, [-off, off])
            };
            Limited { point: self.surface.point(member.point), weight, range }
        });
        let rim =
            self.rim(pose, outer, region).map(|point| Limited { point, weight: 1.0, range: [-off, off] });
        members.chain(rim).collect()
    }

    /// Whether members and rim lie near enough to a quadric not to stray from the surface.
    ///
    /// Members farther off than the budget for fits are not covered by it ([`Self::near`]),
    /// but may be reached over: what stands there must keep the budget for rims. Points on
    /// lines always have to lie within `line`, since there the surface ends. `slack` multiplies the
    /// other distances allowed.
    pub(super) fn keeps(
        &self,
        pose: &Pose,
        outer: DVec2,
        curvature: DVec2,
        line: f64,
        slack: f64,
        region: &Region,
    ) -> bool {
        let kept = |member: &Member| {
            if self.surface.on_border(member.point) {
                miss(curvature, member.local) <= line
            } else {
                self.reaches(curvature, member.local, slack)
            }
        };
        region.members.iter().all(kept)
            && self.rim(pose, outer, region).all(|point| self.reaches(curvature, pose.to_local(point), slack))
    }

    /// Whether a place is near enough to a quadric to be covered by it.
    pub(super) fn near(&self, curvature: DVec2, local: DVec3, slack: f64) -> bool {
        self.budget.covers(curvature, local, slack)
    }

    /// Whether a place is near enough to a quadric that it may reach over it.
    pub(super) fn reaches(&self, curvature: DVec2, local: DVec3, slack: f64) -> bool {
        self.budget.reaches(above(curvature, local), slack)
    }

    /// Where the surface leaves the ellipse, as far as neighbours' joining lines tell.
    ///
    /// Between the members the surface of a mesh is flat, and a quadric through few members
    /// alone could stray from it anywhere; these places hold it.
    fn rim<'r>(
        &'r self,
        pose: &'r Pose,
        outer: DVec2,
        region: &'r Region,
    ) -> impl Iterator<Item = DVec3> + Clone + 'r {
        region.rim.iter().filter_map(move |&(inside, outside)| {
            let ends = [inside, outside].map(|point| self.surface.point(point));
            let [a, b] = ends.map(|point| pose.to_local(point).truncate());
            let (_, leave) = crossings(a, b, outer)?;
            (0.0..=1.0).contains(&leave).then(|| ends[0].lerp(ends[1], leave))
        })
    }

    /// Clip curves for every border the region meets; why not, if they cannot follow it.
    pub(super) fn clips(
        &self,
        pose: &Pose,
        outer: DVec2,
        curvature: DVec2,
        look: Look,
        region: &Region,
    ) -> Result<Vec<ClipCurve>, Stop> {
        if holds_an_end(self.surface, region, pose, outer, self.budget.clip.outset) {
            return Err(Stop::Stray);
        }
        let outlines = outlines(self.surface, region, pose, self.open);
        let mut clips = Vec::new();
        for Outline { points, closed, .. } in &outlines {
            clips.extend(clip::fit(points, *closed, outer, &self.budget.clip).ok_or(Stop::Clip)?);
            if clips.len() > MOST_CLIPS {
                return Err(Stop::Clip);
            }
        }
        let tolerance = &self.budget.clip;
        let cut = Cut { clips: &clips, radii: outer, curvature };
        if cut.follows(&outlines, tolerance, look) { Ok(clips) } else { Err(Stop::Stray) }
    }

    /// Of the curves that [`Self::clips`] gives, those along which the surface ends, if it is
    /// partners that cut along feature lines. Around a corner of both kinds they are kept.
    pub(super) fn end_clips(&self, pose: &Pose, outer: DVec2, region: &Region) -> Option<Vec<ClipCurve>> {
        let mut clips = Vec::new();
        if self.budget.clip.clips == Clips::Partners {
            for Outline { points, closed, .. } in
                outlines(self.surface, region, pose, self.open).iter().filter(|outline| outline.ends)
            {
                clips.extend(clip::fit(points, *closed, outer, &self.budget.clip)?);
            }
        }
        Some(clips)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_surface};
    use crate::analyse::planted::random;
    use crate::analyse::split::split;
    use crate::analyse::weld::Welded;
    use crate::model::cloud::Cloud;
    use crate::model::polyline::nearest_on;
    use glam::Vec3;

    #[test]
    fn splats_beside_lines_that_stray_from_the_faces_are_still_cut_along_them() {
        const BOUND: f64 = 0.004;
        // A floor and a wall below its side, along a line that is now above the floor and now below.
        let place = |n: u64| {
            let (a, b) = (0.25 + 0.25 * random(2 * n), 0.5 * random(2 * n + 1));
            if n.is_multiple_of(2) { DVec3::new(a, b, 0.0) } else { DVec3::new(0.0, b, -a) }.as_vec3()
        };
        let cloud = Cloud { positions: (0..1200).map(place).collect(), ..Cloud::default() };
        let at = |n: u32| {
            let off = if n.is_multiple_of(2) { 0.6 * BOUND } else { -0.6 * BOUND };
            DVec3::new(0.0, f64::from(n) / 40.0 - 0.5, off)
        };
        let line: Vec<DVec3> = (0..=40).map(at).collect();
        let given = Lines::Given(std::slice::from_ref(&line));
        let surface = cloud_surface(&cloud, NormalSource::Estimate, given, Some(0.0), None, None, None)
            .unwrap()
            .surface;
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = Grower::new(&surface, Budget::new(BOUND, Clips::Curved), &round);
        let mut region = Region::new(surface.points.len());
        let is_beside = |at: DVec3| at.x < 0.03 && at.y.abs() < 0.4;
        let mut grown = 0;
        for piece in (0..surface.pieces.len() as u32).filter(|&piece| is_beside(surface.middle(piece))) {
            if grower.grow(piece, &mut region).is_some() {
                continue;
            }
            let Some(Candidate { splat, .. }) = grower.grow_beside_lines(piece, &mut region) else {
                continue;
            };
            grown += u32::from(!splat.clips.is_empty());
            let cut = Cut { clips: &splat.clips, radii: splat.radii, curvature: splat.curvature };
            let border = cut.border(&grower.budget.clip).into_iter().map(|on| splat.center + splat.axes * on);
            for on in border.filter(|on| on.y.abs() < 0.45) {
                let off = line.windows(2).map(|side| nearest_on(side[0], side[1], on).distance(on));
                assert!(off.fold(f64::INFINITY, f64::min) <= BOUND, "{on} is off the line");
            }
        }
        assert!(grown > 10, "{grown} grown that otherwise are not");
    }

    #[test]
    fn what_rounding_moves_off_its_lines_grows_in_finer_steps() {
        const BOUND: f64 = 0.004;
        let positions = vec![Vec3::ZERO, Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.25, 0.45, 0.0)];
        let surface =
            split(&Welded { positions, triangles: vec![[0, 1, 2]], ..Welded::default() }, &[false; 3]);
        // Lines may be passed at a third of the bound.
        let off = |fineness: u8| 0.8 * BOUND / f64::from(1 << fineness);
        let round = |splat: &Splat, fineness: u8| {
            Some(Splat { center: splat.center.with_z(off(fineness)), ..splat.clone() })
        };
        let grower = Grower::new(&surface, Budget::new(BOUND, Clips::Curved), &round);
        let mut region = Region::new(surface.points.len());
        assert!(grower.grow(0, &mut region).is_none());
        let found = grower.grow_finer(0, &mut region).unwrap();
        assert_eq!((found.splat.center.z.to_bits(), found.pieces), (off(2).to_bits(), vec![0]));
    }

    #[test]
    fn a_corner_that_a_slope_takes_away_from_the_border_is_not_reached() {
        let line = [DVec2::new(0.5, -1.0), DVec2::new(0.5, 0.0), DVec2::new(-0.5, 0.0)];
        let reached = |curvature: f64, off: f64| {
            let curvature = DVec2::new(curvature, 0.0);
            let lifted = |uv: DVec2| uv.extend((curvature * uv * uv).element_sum());
            let points = line.to_vec();
            let heights = points.iter().map(|point| lifted(*point).z).collect();
            let outline = Outline { points, heights, closed: false, ends: false };
            let cut = Cut { clips: &[], radii: DVec2::ONE, curvature };
            cut.reaches_corners(&[outline], 0.1, &[lifted(line[1] + DVec2::new(off, 0.0))])
        };
        assert!(reached(0.0, 0.09) && !reached(0.0, 0.11), "in a plane");
        assert!(reached(1.0, 0.06) && !reached(1.0, 0.09), "at a slope of one");
    }
}
