//! Ends the growth of a splat: rounds it as the file will, judges it once more, cuts it.

use glam::{DVec2, DVec3, Vec3};

use super::backing::{Backing, Look};
use super::facet::extremes;
use super::grow::{Domain, Grower};
use super::margin::disc_inside;
use super::outline::{Outline, outlines};
use super::region::Region;
use crate::fit::clip::Clips;
use crate::fit::pose::Pose;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::splat::Splat;
use crate::tolerance::FIT_SHARE;

/// A domain that does not hold when rounded shrinks by this factor, so many times.
const SHRINK: (f64, usize) = (0.95, 10);

/// Sizes in a row at which what is fitted anew may fail to keep the budget: where one does, the next may not. Stopping at
/// the first, four of seven models take 1 to 3 % more bytes and the others as many.
const SKIPS: usize = 3;

/// A splat is padded by the first of these many times the least padding with which it keeps the budget: rays that
/// pass between two splats at a slant need the more of either the flatter they are. Along rays that no bake looks
/// along, three times leaves 65 holes where twice left 110 (five models, 156 views each).
const PADS: [f64; 3] = [3.0, 2.0, 1.0];

/// A rounded splat may use the whole budget, less this share for the rounding of arithmetic.
pub(super) const ROUNDED_SLACK: f64 = (1.0 - 1e-6) / FIT_SHARE;

/// A quadric whose sagittas are below this many budgets may do as a plane.
const FLAT_SAGITTA: f64 = 2.0;

/// A quadric whose lesser sagitta is at most this many budgets may do as a cylinder. Bent by that
/// much, it still lies within half a budget of a cylinder through its middle height.
const CYLINDER_SAGITTA: f64 = 1.0;

/// A splat that keeps the budget, and what it covers.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The splat, cut along feature lines and where the surface ends.
    pub splat: Splat,
    /// The latter of its clip curves, where partners are to make the other cuts; else none.
    pub end_clips: Vec<ClipCurve>,
    /// Whether it is one of last resort, which covers its own piece and is cut along the sides of that.
    pub last_resort: bool,
    /// The pieces it covers, ascending.
    pub pieces: Vec<u32>,
    /// How many of the fit's six terms the points determined.
    pub rank: u8,
}

impl Candidate {
    /// With its clip curves as they come out of the file, where they lie up to their share of the bound off.
    #[must_use]
    pub(super) fn stored(mut self, grower: &Grower) -> Self {
        if !self.splat.clips.is_empty() {
            // What was rounded before it was cut is on the grids, so that only the cuts are rounded.
            self.splat = grower.rounded(&self.splat).unwrap_or(self.splat);
        }
        self
    }
}

/// The splat of a grown domain, or of the largest smaller one that holds when rounded.
pub(super) fn settle(
    grower: &Grower,
    mut domain: Domain,
    seeds: &[u32],
    piece: u32,
    region: &mut Region,
) -> Option<Candidate> {
    let (shrink, tries) = SHRINK;
    for _ in 0..tries {
        let outer = grower.budget.padded(domain.radii);
        let sagitta = (domain.curvature * outer * outer).abs().max_element();
        let plane = (sagitta <= FLAT_SAGITTA * grower.budget.fit).then_some(DVec2::ZERO);
        let quadric = (domain.curvature != DVec2::ZERO).then_some(domain.curvature);
        for curvature in plane.into_iter().chain(quadric) {
            let found = PADS.into_iter().find_map(|pad| {
                let more = grower.budget.padded_by(domain.radii, pad * grower.budget.pad) - outer;
                let mut ended = |pose: &Pose, curvature: DVec2| {
                    rounded(grower, pose, outer + more, curvature)
                        .and_then(|splat| finish(grower, splat, more, domain.rank, seeds, region))
                };
                let found = ended(&domain.pose, curvature)
                    .filter(|candidate| candidate.pieces.binary_search(&piece).is_ok())?;
                // A zero costs the file less than a number, so a cylinder that does as much will do.
                let cylinder = cylinder(&domain.pose, outer + more, curvature, grower.budget.fit)
                    .and_then(|(pose, curvature)| ended(&pose, curvature))
                    .filter(|cylinder| cylinder.covers(found.pieces.iter().copied()));
                Some(cylinder.unwrap_or(found))
            });
            if found.is_some() {
                return found;
            }
        }
        let smaller = std::iter::successors(Some(shrink * domain.radii), |radii| Some(shrink * *radii));
        domain =
            smaller.take(SKIPS).find_map(|radii| grower.attempt(&domain.pose, radii, seeds, region).ok())?;
    }
    None
}

/// The cylinder nearest to a quadric over an ellipse, as pose and curvature: the lesser sagitta is
/// zero, and the centre moves along `k` by half of what that takes away. `None` if the quadric bends
/// too much to do as one, or is one already.
fn cylinder(pose: &Pose, radii: DVec2, curvature: DVec2, fit: f64) -> Option<(Pose, DVec2)> {
    let sagitta = curvature * radii * radii;
    let [kept, lost] =
        if sagitta.x.abs() >= sagitta.y.abs() { [DVec2::X, DVec2::Y] } else { [DVec2::Y, DVec2::X] };
    let lost = sagitta.dot(lost);
    let center = pose.center + 0.5 * lost * pose.axes.z_axis;
    let slight = lost != 0.0 && lost.abs() <= CYLINDER_SAGITTA * fit;
    slight.then_some((Pose { center, ..*pose }, curvature * kept))
}

/// A splat as it will be stored, not yet cut or coloured.
pub(super) fn rounded(grower: &Grower, pose: &Pose, radii: DVec2, curvature: DVec2) -> Option<Splat> {
    grower.rounded(&Splat {
        center: pose.center,
        axes: pose.axes,
        radii,
        curvature,
        clips: Vec::new(),
        partners: Vec::new(),
        color: [u8::MAX; 3],
    })
}

/// Judges and cuts a rounded splat; `None` if it does not keep the budget. `more` is by how much its
/// radii go on beyond the padding that every splat has.
fn finish(
    grower: &Grower,
    mut splat: Splat,
    more: DVec2,
    rank: u8,
    seeds: &[u32],
    region: &mut Region,
) -> Option<Candidate> {
    let pose = Pose { center: splat.center, axes: splat.axes };
    let meshed = grower.surface.spots.is_empty();
    // Partners begin to cut no farther outside a line than the lesser distance allows.
    let partnered = grower.budget.clip.clips == Clips::Partners;
    let line =
        if meshed || partnered { ROUNDED_SLACK * grower.budget.line } else { grower.budget.cloud_line };
    let kept = region.gather(grower.surface, &pose, splat.radii, seeds)
        && grower.keeps(&pose, splat.radii, splat.curvature, line, ROUNDED_SLACK, region);
    splat.clips =
        kept.then(|| grower.clips(&pose, splat.radii, splat.curvature, Look::Fine, region).ok())??;
    if !Backing::of(grower, &pose, splat.radii, splat.curvature, region, Look::Fine).holds(&splat.clips) {
        return None;
    }
    let trusted = grower.budget.trusted(splat.radii - more);
    // Points strewn about a line may lie as near to a curve as that is rounded.
    let stored = if meshed { None } else { Some(grower.rounded(&splat)?.clips) };
    let clips = stored.as_ref().unwrap_or(&splat.clips);
    let conics: Vec<Conic> = clips.iter().map(|clip| clip.conic(splat.radii)).collect();
    let domain = Covering { grower, splat: &splat, conics, trusted };
    let pieces = if meshed { domain.triangles(region) } else { domain.spots(region) }?;
    let end_clips = grower.end_clips(&pose, splat.radii, region)?;
    splat.color = mean_color(grower, &pieces);
    Some(Candidate { splat, end_clips, last_resort: false, pieces, rank })
}

/// A splat and what may tell what it covers.
struct Covering<'a> {
    grower: &'a Grower<'a>,
    splat: &'a Splat,
    conics: Vec<Conic>,
    /// Radii of the ellipse that is trusted to cover.
    trusted: DVec2,
}

impl Candidate {
    /// Whether it covers all of these pieces, ascending.
    pub(super) fn covers(&self, pieces: impl IntoIterator<Item = u32>) -> bool {
        let mut own = self.pieces.iter();
        pieces.into_iter().all(|piece| own.find(|own| **own >= piece) == Some(&piece))
    }

    /// What it is to be cut along, of the region that it reaches over, which is gathered for that; `None` for
    /// one of last resort, which is cut otherwise.
    pub(super) fn outlines(&self, grower: &Grower, region: &mut Region) -> Option<Vec<Outline>> {
        let (surface, splat) = (grower.surface, &self.splat);
        let pose = Pose { center: splat.center, axes: splat.axes };
        let seeds = surface.pieces[*self.pieces.first()? as usize];
        let reached = !self.last_resort && region.gather(surface, &pose, splat.radii, &seeds);
        reached.then(|| outlines(surface, region, &pose, grower.open))
    }
}

impl Covering<'_> {
    /// Whether a place lies within the domain by a margin, near the quadric and not cut away.
    fn covers(&self, local: DVec3, margin: f64) -> bool {
        disc_inside(local.truncate(), margin, self.trusted)
            && self.grower.near(self.splat.curvature, local, ROUNDED_SLACK)
            && !self.cuts(local.truncate())
    }

    /// Whether what a spot stands for lies within the domain, and the spot near the quadric and not cut away.
    ///
    /// A cell lies within it if its corners do, since an ellipse is convex; it holds the spot.
    fn covers_spot(&self, spot: u32, local: DVec3) -> bool {
        let surface = self.grower.surface;
        let inside =
            |corner: &Vec3| disc_inside(self.splat.to_local(corner.as_dvec3()).truncate(), 0.0, self.trusted);
        match surface.cells.of(spot) {
            [] => self.covers(local, surface.piece_margin(spot)),
            cell => self.covers(local, 0.0) && cell.iter().all(inside),
        }
    }

    fn cuts(&self, uv: DVec2) -> bool {
        self.conics.iter().any(|conic| conic.cuts(uv))
    }

    /// The triangles that are covered, ascending; `None` if the splat strays from one it reaches.
    fn triangles(&self, region: &mut Region) -> Option<Vec<u32>> {
        let surface = self.grower.surface;
        let inside = region.members.iter().filter(|member| self.covers(member.local, 0.0));
        let points: Vec<u32> = inside.map(|member| member.point).collect();
        region.mark_only(&points);
        let mut pieces = Vec::new();
        for piece in surface.pieces_at(region.members.iter().map(|member| member.point)) {
            let corners = surface.pieces[piece as usize];
            let facet = corners.map(|corner| self.splat.to_local(surface.point(corner)));
            let extremes = extremes(&facet, self.splat.curvature, self.splat.radii);
            if !extremes.iter().all(|&above| self.grower.budget.reaches(above, ROUNDED_SLACK)) {
                return None;
            }
            let near = extremes.iter().all(|above| above.abs() <= ROUNDED_SLACK * self.grower.budget.fit);
            if near && region.marks_all(&corners) {
                pieces.push(piece);
            }
        }
        Some(pieces)
    }

    /// The spots that are covered, ascending; `None` if the splat strays from one it reaches.
    fn spots(&self, region: &Region) -> Option<Vec<u32>> {
        let surface = self.grower.surface;
        let mut points: Vec<u32> = region.reached().collect();
        points.sort_unstable();
        let mut pieces = Vec::new();
        // The pieces of a cloud are numbered in the order of the points that stand for them.
        for &piece in points.into_iter().flat_map(|point| surface.pieces_of.row(point)) {
            let spot = surface.spots[piece as usize];
            let local = self.splat.to_local(spot.position.as_dvec3());
            if self.splat.ellipse(local.truncate()) > 1.0 {
                continue;
            }
            if !self.grower.reaches(self.splat.curvature, local, ROUNDED_SLACK)
                && !self.cuts(local.truncate())
            {
                return None;
            }
            if self.covers_spot(piece, local) {
                pieces.push(piece);
            }
        }
        Some(pieces)
    }
}

/// The mean colour of the corners of some pieces; white where the surface has none.
fn mean_color(grower: &Grower, pieces: &[u32]) -> [u8; 3] {
    let colors = &grower.surface.colors;
    if colors.is_empty() || pieces.is_empty() {
        return [u8::MAX; 3];
    }
    let mut sums = [0_u64; 3];
    for corners in pieces.iter().map(|&piece| grower.surface.pieces[piece as usize]) {
        for point in corners {
            for (sum, channel) in sums.iter_mut().zip(colors[point as usize]) {
                *sum += u64::from(channel);
            }
        }
    }
    let count = 3 * pieces.len() as u64;
    sums.map(|sum| ((sum + count / 2) / count) as u8)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_surface};
    use crate::analyse::planted::{normal, random};
    use crate::model::cloud::Cloud;
    use crate::sample::budget::Budget;
    use glam::{DMat3, Vec2Swizzles, Vec3};

    #[test]
    fn what_a_splat_of_a_cloud_covers_is_not_cut_away_once_stored() {
        // Two faces at right angles, whose points scatter over their edge by the bound.
        let bound = 0.01;
        let places: Vec<Vec3> = (0..4000)
            .map(|n| {
                let (x, way) = (random(2 * n), 0.25 * (1.0 + random(2 * n + 1)) + 2.0 * bound * normal(n));
                let place = if n.is_multiple_of(2) { [x, -way, 0.0] } else { [x, 0.0, -way] };
                (0.5 * DVec3::from_array(place)).as_vec3()
            })
            .collect();
        let cloud = Cloud { positions: places, ..Cloud::default() };
        let line = [vec![DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0)]];
        let surface =
            cloud_surface(&cloud, NormalSource::Estimate, Lines::Given(&line), None, None, None, None)
                .unwrap()
                .surface;
        // As if files kept the ends of curves to a twentieth of a radian.
        let coarse = |splat: &Splat, _: u8| {
            let angle = |alpha: f64| (20.0 * alpha).round() / 20.0;
            let stored = |clip: &ClipCurve| ClipCurve {
                alpha1: angle(clip.alpha1),
                alpha3: angle(clip.alpha3),
                ..*clip
            };
            Some(Splat { clips: splat.clips.iter().map(stored).collect(), ..splat.clone() })
        };
        let grower = Grower::new(&surface, Budget::new(bound, Clips::Curved), &coarse);
        let mut region = Region::new(surface.points.len());
        let pieces = (0..surface.pieces.len() as u32).step_by(50);
        let grown: Vec<Candidate> = pieces.filter_map(|piece| grower.grow(piece, &mut region)).collect();
        let cut = grown.iter().filter(|candidate| !candidate.splat.clips.is_empty());
        assert!(cut.count() > 20, "few of {} are cut", grown.len());
        for candidate in grown {
            let stored = coarse(&candidate.splat, 0).unwrap();
            for piece in candidate.pieces {
                let uv = stored.to_local(surface.middle(piece)).truncate();
                assert!(!stored.clips.iter().any(|clip| clip.cuts(uv, stored.radii)), "{uv}");
            }
        }
    }

    #[test]
    fn the_nearest_cylinder_halves_what_is_lost() {
        let pose = Pose { center: DVec3::ONE, axes: DMat3::IDENTITY };
        let radii = DVec2::new(0.5, 2.0);
        // Sagittas of 1 and -1/32.
        let curvature = DVec2::new(4.0, -1.0 / 128.0);
        let found = |radii: DVec2, curvature: DVec2| cylinder(&pose, radii, curvature, 1.0 / 32.0);
        let bent = DVec2::new(4.0, 0.0);
        let moved = Pose { center: DVec3::new(1.0, 1.0, 1.0 - 1.0 / 64.0), ..pose };
        assert_eq!(found(radii, curvature), Some((moved, bent)));
        assert_eq!(found(radii.yx(), curvature.yx()), Some((moved, bent.yx())));
        assert!(cylinder(&pose, radii, curvature, 1.0 / 33.0).is_none(), "it bends too much");
        assert!(found(radii, bent).is_none(), "it is one already");
        assert!(found(radii, DVec2::ZERO).is_none(), "a plane is no cylinder");
    }
}
