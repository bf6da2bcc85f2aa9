//! The splat of last resort: one triangle, exactly.
//!
//! Where no larger splat keeps the budget (a sliver between feature lines, a mesh coarser
//! than the budget), a plane over the triangle's least ellipse, cut along its sides, covers the
//! triangle without error. So every piece of a mesh can be covered.

use glam::{DVec2, DVec3};

use super::backing::{Below, between_cuts, place_count, rim_places};
use super::grow::Grower;
use super::outline::border_sides;
use super::region::{Member, Region};
use super::settle::{Candidate, rounded};
use crate::fit::clip::{self, Care};
use crate::fit::ellipse::circumellipse;
use crate::fit::pose::Pose;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::polyline::nearest_on;

/// The splat over one piece: a triangle cut out of a plane, or the disc of a single point.
///
/// A side is cut along where the surface ends or folds away behind it: elsewhere the ellipse may go
/// on over the neighbours. `None` if it cannot be stored: too small beside the budget, or too large.
#[must_use]
pub fn over(grower: &Grower, piece: u32, region: &mut Region) -> Option<Candidate> {
    let (surface, budget) = (grower.surface, &grower.budget);
    let corners = surface.pieces[piece as usize];
    let points = corners.map(|corner| surface.point(corner));
    let middle = surface.middle(piece);
    let mean: DVec3 = corners.iter().map(|&corner| surface.normal(corner)).sum();
    let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or(mean);
    let pose = Pose::at(middle, normal);
    let margin = surface.piece_margin(piece);
    let (theta, radii) = circumellipse(points.map(|point| pose.to_local(point).truncate()));
    let (pose, radii) = (pose.turned(theta), radii + margin + budget.pad);
    let mut splat = rounded(grower, &pose, radii, DVec2::ZERO)?;
    if corners[0] != corners[1] {
        let pose = Pose { center: splat.center, axes: splat.axes };
        splat.clips = Triangle { grower, pose, radii: splat.radii, corners }.clips(region);
    }
    splat.color = surface.colors.get(corners[0] as usize).copied().unwrap_or([u8::MAX; 3]);
    // What ends at a triangle's own sides is cut by itself, whatever lies across.
    let end_clips = splat.clips.clone();
    Some(Candidate { splat, end_clips, pieces: vec![piece], rank: 3 })
}

/// Which sides of a triangle to cut along, bit by bit; those with fewer cuts come first.
const CUT_ALONG: [u32; 8] = [0b000, 0b001, 0b010, 0b100, 0b011, 0b101, 0b110, 0b111];

/// A triangle in the plane of a splat.
struct Triangle<'a> {
    grower: &'a Grower<'a>,
    pose: Pose,
    radii: DVec2,
    corners: [u32; 3],
}

impl Triangle<'_> {
    /// As few chords along its sides as will do.
    fn clips(&self, region: &mut Region) -> Vec<ClipCurve> {
        let outline = self.corners.map(|corner| self.flat(corner));
        // A sliver thinner than the tolerance has no corners to cut at, and needs no cut.
        let all = || self.fitted(&outline, true).unwrap_or_default();
        if !region.gather(self.grower.surface, &self.pose, self.radii, &self.corners) {
            return all();
        }
        let ends = (0..3).filter(|&n| self.is_border(n)).map(|n| 1 << n).sum::<u32>();
        let fewer = CUT_ALONG.into_iter().filter(|cut| cut & ends == ends && *cut != 0b111);
        fewer
            .filter_map(|cut| Some((cut, self.chords(cut, &outline)?)))
            .find(|(cut, clips)| self.will_do(*cut, clips, region))
            .map(|(_, clips)| clips)
            .unwrap_or_else(all)
    }

    fn flat(&self, point: u32) -> DVec2 {
        self.pose.to_local(self.grower.surface.point(point)).truncate()
    }

    fn fitted(&self, line: &[DVec2], closed: bool) -> Option<Vec<ClipCurve>> {
        clip::fit(line, closed, self.radii, &self.grower.budget.clip, Care::Nearest)
    }

    /// Whether the surface ends at a side.
    fn is_border(&self, side: usize) -> bool {
        self.grower.surface.border_next[self.corners[side] as usize] == self.corners[(side + 1) % 3]
    }

    /// Chords along some of the sides.
    fn chords(&self, cut: u32, outline: &[DVec2; 3]) -> Option<Vec<ClipCurve>> {
        let sides = (0..3).filter(|side| cut >> side & 1 == 1);
        let chord = |side: usize| {
            let (a, b) = (outline[side], outline[(side + 1) % 3]);
            let beyond = 2.0 * self.radii.max_element() * (b - a).normalize_or_zero();
            self.fitted(&[a - beyond, b + beyond], false)
        };
        let chords: Option<Vec<Vec<ClipCurve>>> = sides.map(chord).collect();
        chords.map(|chords| chords.concat())
    }

    /// Whether what chords along some of the sides leave has the surface below it, and reaches over
    /// no line.
    fn will_do(&self, cut: u32, clips: &[ClipCurve], region: &Region) -> bool {
        let conics: Vec<Conic> = clips.iter().map(|clip| clip.conic(self.radii)).collect();
        let is_cut = |uv: DVec2| conics.iter().any(|conic| conic.cuts(uv));
        let kept = |uv: DVec2| (uv / self.radii).length_squared() < 1.0 && !is_cut(uv);
        let near = |member: &Member| {
            !kept(member.local.truncate()) || self.grower.budget.reaches(member.local.z, 1.0)
        };
        region.members.iter().all(near)
            && !self.across(region).any(kept)
            && self.is_backed(cut, clips, region, is_cut)
    }

    /// Whether the surface lies below the border of what chords leave: the ellipse and the chords
    /// themselves, but for where these run along the triangle.
    fn is_backed(
        &self,
        cut: u32,
        clips: &[ClipCurve],
        region: &Region,
        is_cut: impl Fn(DVec2) -> bool,
    ) -> bool {
        let budget = &self.grower.budget;
        let reach = budget.clip.reach();
        let below = Below::triangles(self.grower.surface, &self.pose, region.reached());
        let beside_cut = |uv: DVec2| {
            (0..3).filter(|side| cut >> side & 1 == 1).any(|side| {
                let [a, b] = [side, (side + 1) % 3].map(|n| self.flat(self.corners[n]));
                nearest_on(a.extend(0.0), b.extend(0.0), uv.extend(0.0)).distance(uv.extend(0.0)) <= reach
            })
        };
        rim_places(self.radii, budget.rim)
            .chain(between_cuts(clips, self.radii))
            .chain(clips.iter().flat_map(|clip| self.along(clip)))
            .filter(|&uv| !is_cut(uv))
            .all(|uv| below.near(uv, 0.0, budget, budget.overhang) || beside_cut(uv))
    }

    /// Places on the kept side of a chord.
    fn along(&self, clip: &ClipCurve) -> impl Iterator<Item = DVec2> {
        let Conic { p1, p3, .. } = clip.conic(self.radii);
        let budget = &self.grower.budget;
        let inside = (p3 - p1).perp().normalize_or_zero() * budget.clip.miss;
        let count = place_count(p1.distance(p3), budget.rim);
        (0..=count).map(move |n| p1.lerp(p3, n as f64 / count as f64) + inside)
    }

    /// Places just across the lines that end the surface around.
    fn across<'r>(&'r self, region: &'r Region) -> impl Iterator<Item = DVec2> + 'r {
        let tolerance = &self.grower.budget.clip;
        border_sides(self.grower.surface, region).into_iter().flat_map(move |(from, to)| {
            let (a, b) = (self.flat(from), self.flat(to));
            let out = -(b - a).perp().normalize_or_zero() * (tolerance.outset + tolerance.miss);
            ALONG.map(|share| a.lerp(b, share) + out)
        })
    }
}

/// Where along a border's side the places just across it are looked at.
const ALONG: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::edges::Edges;
    use crate::analyse::split::split;
    use crate::analyse::weld::Welded;
    use crate::fit::clip::Clips;
    use crate::fit::pose::Shapes;
    use crate::model::splat::Splat;
    use crate::sample::budget::Budget;
    use glam::Vec3;

    /// How many chords the splat over a triangle in the middle of a grid of unit cells has: the grid
    /// is folded by an angle, degrees, along one side of the triangle, and cut open along it if `cut`.
    fn chords(fold: f32, cut: bool) -> Option<usize> {
        let (sin, cos) = fold.to_radians().sin_cos();
        let place = |n: u32| {
            let (x, y) = ((n % 5) as f32 - 2.0, (n / 5) as f32);
            if x <= 0.0 { Vec3::new(x, y, 0.0) } else { Vec3::new(x * cos, y, -x * sin) }
        };
        let positions: Vec<Vec3> = (0..20).map(place).collect();
        let cells = (0..12_u32).map(|n| n / 4 * 5 + n % 4);
        let triangles: Vec<[u32; 3]> =
            cells.flat_map(|n| [[n, n + 1, n + 5], [n + 1, n + 6, n + 5]]).collect();
        let welded = Welded { positions, triangles, ..Welded::default() };
        let edges = Edges::of(&welded.triangles);
        let marked: Vec<bool> =
            edges.edges.iter().map(|edge| cut && edge.ends.iter().all(|end| end % 5 == 2)).collect();
        let surface = split(&welded, &marked);
        let budget = Budget::new(0.05, Clips::Curved);
        let round = |splat: &Splat| Some(splat.clone());
        let grower = Grower {
            surface: &surface,
            budget,
            shapes: Shapes::All,
            open: &[],
            overhang: 0.0,
            round: &round,
        };
        let mut region = Region::new(surface.points.len());
        // Before the fold, with a side on it.
        over(&grower, 11, &mut region).map(|found| found.splat.clips.len())
    }

    #[test]
    fn sides_are_cut_only_where_the_surface_ends_or_folds_away() {
        assert_eq!(chords(0.0, false), Some(0), "within a plane");
        assert_eq!(chords(5.0, false), Some(0), "at hardly a fold");
        assert_eq!(chords(60.0, false), Some(1), "at a fold");
        assert_eq!(chords(0.0, true), Some(1), "at a line");
    }
}
