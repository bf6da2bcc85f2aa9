//! The splat of last resort: one triangle, exactly.
//!
//! Where no larger splat keeps the budget (a sliver between feature lines, a mesh coarser
//! than the budget), a plane over the triangle's least ellipse, cut along its sides, covers the
//! triangle without error. So every piece of a mesh can be covered.

use glam::{DVec2, DVec3};

use super::backing::{Below, between_cuts, place_count, rim_places};
use super::budget::Budget;
use super::disc;
use super::grow::Grower;
use super::outline::border_sides;
use super::region::{Member, Region};
use super::settle::{Candidate, rounded};
use super::shaped::Shaped;
use crate::fit::clip::{self, ClipTolerance, Clips};
use crate::fit::ellipse::{circumellipse, holds};
use crate::fit::pose::Pose;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::polyline::nearest_on;
use crate::model::splat::Splat;
use crate::model::triangle::to_triangle;

/// The splat over one piece: a triangle cut out of a plane, or the disc of a single point or the ellipse around what
/// one beside a line stands for, cut as [`super::disc`] tells.
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
    let pose = Pose::at(middle, upright(points, mean));
    // A point of a cloud may be stood for by another, which its disc need not reach.
    let is_spot = corners[0] == corners[1];
    let (pose, radii) = if let Some(Shaped { pose, radii }) = Shaped::over(surface, piece, &pose) {
        (pose, radii)
    } else if is_spot {
        (pose, DVec2::splat(surface.piece_margin(piece)))
    } else {
        let (theta, radii) = circumellipse(points.map(|point| pose.to_local(point).truncate()));
        (pose.turned(theta), radii)
    };
    let padded = |share: f64| rounded(grower, &pose, radii + share * budget.pad, DVec2::ZERO);
    let mut splat = padded(1.0)?;
    if !is_spot {
        let triangle = |splat: &Splat| Triangle::below(splat, grower, corners);
        splat.clips = triangle(&splat).clips(region);
        if triangle(&splat).strays(&splat.clips) {
            let cut = |splat: Splat| Some(Splat { clips: triangle(&splat).all()?, ..splat });
            let mut less = PADS.into_iter().filter_map(padded).filter_map(cut);
            let does = |less: &Splat| triangle(less).is_inside() && !triangle(less).strays(&less.clips);
            splat = less.find(does).unwrap_or(splat);
        }
    } else {
        splat = disc::cut(grower, splat, piece, region);
    }
    splat.color = surface.colors.get(corners[0] as usize).copied().unwrap_or([u8::MAX; 3]);
    // What ends at a triangle's own sides is cut by itself, whatever lies across.
    let end_clips = splat.clips.clone();
    Some(Candidate { splat, end_clips, last_resort: true, pieces: vec![piece], rank: 3 })
}

/// The same over a triangle, cut as far outside its sides as borders may lie: rounded, two that meet may lie so far
/// apart that a ray at a slant passes between them. `None` for a point of a cloud, whose curves follow lines less
/// exactly than chords do sides.
#[must_use]
pub fn wide(grower: &Grower, piece: u32, region: &mut Region) -> Option<Candidate> {
    let wide = Grower { budget: grower.budget.cut_wide(), ..*grower };
    grower.surface.spots.is_empty().then(|| over(&wide, piece, region))?
}

/// The direction across a triangle; for corners in a line, the one across that line that is nearest to another.
fn upright([a, b, c]: [DVec3; 3], other: DVec3) -> DVec3 {
    let sides = [b - a, c - b, a - c];
    let longest = sides.into_iter().fold(DVec3::ZERO, |most, side| {
        if side.length_squared() > most.length_squared() { side } else { most }
    });
    let in_line = longest.try_normalize().map_or(other, |along| {
        other.reject_from_normalized(along).normalize_or(along.any_orthonormal_vector())
    });
    sides[0].cross(-sides[2]).normalize_or(in_line)
}

/// Shares of the padding that a triangle cut along its sides is tried with where all of it would reach
/// too far beyond an acute corner.
const PADS: [f64; 3] = [0.5, 0.2, 0.05];

/// Which sides of a triangle to cut along, bit by bit; those with fewer cuts come first.
const CUT_ALONG: [u32; 8] = [0b000, 0b001, 0b010, 0b100, 0b011, 0b101, 0b110, 0b111];

/// Misses between places that are looked at along a chord: what lies too far beyond a corner may be as
/// short as one.
const STEP: f64 = 0.25;

/// Steps along a radius at most.
const MOST_STEPS: f64 = 512.0;

/// A place is nearest to a corner if that is farther from it than the triangle by no more than rounding.
const AT_CORNER: f64 = 1.0 + 1e-9;

/// Chords along some sides of a triangle.
struct Chords {
    /// Which sides, bit by bit.
    cut: u32,
    /// None along a side that passes the ellipse by.
    clips: Vec<ClipCurve>,
    /// The side that each runs along.
    sides: Vec<usize>,
}

impl Chords {
    fn cut_along(&self) -> impl Iterator<Item = usize> + use<> {
        let cut = self.cut;
        (0..3).filter(move |side| cut >> side & 1 == 1)
    }
}

/// A triangle in the plane of a splat.
struct Triangle<'a> {
    grower: &'a Grower<'a>,
    pose: Pose,
    radii: DVec2,
    corners: [u32; 3],
}

impl<'a> Triangle<'a> {
    /// That of some corners, below a splat.
    fn below(splat: &Splat, grower: &'a Grower<'a>, corners: [u32; 3]) -> Self {
        let pose = Pose { center: splat.center, axes: splat.axes };
        Self { grower, pose, radii: splat.radii, corners }
    }

    /// As few chords along its sides as will do.
    fn clips(&self, region: &mut Region) -> Vec<ClipCurve> {
        // A sliver thinner than the tolerance has no corners to cut at, and needs no cut.
        let all = || self.all().unwrap_or_default();
        let outline = self.outline();
        if !region.gather(self.grower.surface, &self.pose, self.radii, &self.corners) {
            return all();
        }
        let below = Below::triangles(self.grower.surface, &self.pose, region.reached());
        let ends = (0..3).filter(|&n| self.is_border(n)).map(|n| 1 << n).sum::<u32>();
        let fewer = CUT_ALONG.into_iter().filter(|cut| cut & ends == ends && *cut != 0b111);
        let mut chords = fewer.filter_map(|cut| self.chords(cut, &outline));
        chords.find(|chords| self.will_do(chords, region, &below)).map_or_else(all, |chords| chords.clips)
    }

    /// Chords along all of its sides.
    fn all(&self) -> Option<Vec<ClipCurve>> {
        let straight = ClipTolerance { clips: Clips::Straight, ..self.grower.budget.clip };
        clip::fit(&self.outline(), true, self.radii, &straight)
    }

    /// Whether its corners lie in the ellipse.
    fn is_inside(&self) -> bool {
        self.outline().iter().all(|&corner| (corner / self.radii).length_squared() <= 1.0)
    }

    /// Whether it is cut along all its sides, and what is left goes on beyond it too far.
    fn strays(&self, clips: &[ClipCurve]) -> bool {
        self.all().is_some_and(|all| all == clips) && self.goes_far(clips)
    }

    /// Whether the border of what clip curves leave goes farther beyond it than a rim may, or where it
    /// touches a line farther than a cut may.
    fn goes_far(&self, clips: &[ClipCurve]) -> bool {
        let conics = self.conics(clips);
        let arcs = between_cuts(clips, self.radii).filter(|&uv| !conics.iter().any(|conic| conic.cuts(uv)));
        let Budget { rim, clip, .. } = self.grower.budget;
        let most = if self.touches_a_line() { clip.edge } else { rim };
        let chords = (0..conics.len()).flat_map(|n| self.bordering(&conics, n));
        chords.chain(arcs).any(|uv| self.beyond(uv) > most)
    }

    /// Whether a chord goes on farther beyond the triangle and all lines than cuts may: along a line, or beyond a
    /// corner on one where no surface is as near. At an acute corner the next chord may cut it off too late.
    fn leaves_lines(&self, sides: &[usize], chords: &[Conic], region: &Region, below: &Below) -> bool {
        let local = |point: u32| self.pose.to_local(self.grower.surface.point(point));
        let lines: Vec<[DVec3; 2]> = border_sides(self.grower.surface, region)
            .into_iter()
            .map(|(from, to)| [local(from), local(to)])
            .collect();
        let most = self.grower.budget.clip.edge;
        let near = |place: DVec3| lines.iter().any(|&[a, b]| nearest_on(a, b, place).distance(place) <= most);
        let leaves = |uv: DVec2| self.beyond(uv) > most && !near(uv.extend(0.0));
        let stands_out = |uv: DVec2| self.is_past_line(uv) && !below.is_within(most, uv.extend(0.0));
        (0..chords.len()).any(|chord| {
            let along_line = self.is_border(sides[chord]);
            self.bordering(chords, chord).any(|uv| leaves(uv) && (along_line || stands_out(uv)))
        })
    }

    /// Whether the nearest of the triangle to a place beyond it is a corner on a line.
    fn is_past_line(&self, uv: DVec2) -> bool {
        let on_lines = self.corners.iter().filter(|&&corner| self.grower.surface.on_border(corner));
        let nearest = on_lines.map(|&corner| self.flat(corner).distance(uv)).fold(f64::INFINITY, f64::min);
        nearest <= self.beyond(uv) * AT_CORNER
    }

    fn touches_a_line(&self) -> bool {
        self.corners.iter().any(|&corner| self.grower.surface.on_border(corner))
    }

    /// How far a place lies from the triangle.
    fn beyond(&self, uv: DVec2) -> f64 {
        to_triangle(self.outline().map(|corner| corner.extend(0.0)), uv.extend(0.0)).length()
    }

    fn conics(&self, clips: &[ClipCurve]) -> Vec<Conic> {
        clips.iter().map(|clip| clip.conic(self.radii)).collect()
    }

    /// Places along a chord where it bounds what they all leave.
    fn bordering<'c>(&self, conics: &'c [Conic], chord: usize) -> impl Iterator<Item = DVec2> + use<'c> {
        let step = (STEP * self.grower.budget.clip.miss).max(self.radii.max_element() / MOST_STEPS);
        let radii = self.radii;
        let is_cut =
            move |uv: DVec2| conics.iter().enumerate().any(|(n, conic)| n != chord && conic.cuts(uv));
        conics[chord].walk(step).into_iter().filter(move |&uv| holds(uv, radii) && !is_cut(uv))
    }

    fn outline(&self) -> [DVec2; 3] {
        self.corners.map(|corner| self.flat(corner))
    }

    fn flat(&self, point: u32) -> DVec2 {
        self.pose.to_local(self.grower.surface.point(point)).truncate()
    }

    /// Whether the surface ends at a side.
    fn is_border(&self, side: usize) -> bool {
        self.grower.surface.border_next[self.corners[side] as usize] == self.corners[(side + 1) % 3]
    }

    /// Chords along some of the sides.
    fn chords(&self, cut: u32, outline: &[DVec2; 3]) -> Option<Chords> {
        let mut chords = Chords { cut, clips: Vec::new(), sides: Vec::new() };
        for side in chords.cut_along() {
            let ends = [outline[side], outline[(side + 1) % 3]];
            for clip in clip::along(ends, self.radii, &self.grower.budget.clip)? {
                chords.clips.push(clip);
                chords.sides.push(side);
            }
        }
        Some(chords)
    }

    /// Whether what chords along some of the sides leave has the surface below it, and reaches over
    /// no line.
    fn will_do(&self, chords: &Chords, region: &Region, below: &Below) -> bool {
        let conics = self.conics(&chords.clips);
        let is_cut = |uv: DVec2| conics.iter().any(|conic| conic.cuts(uv));
        let kept = |uv: DVec2| (uv / self.radii).length_squared() < 1.0 && !is_cut(uv);
        let near = |member: &Member| {
            !kept(member.local.truncate()) || self.grower.budget.reaches(member.local.z, 1.0)
        };
        region.members.iter().all(near)
            && !self.across(region).any(kept)
            && self.is_backed(chords, below, is_cut)
            && !self.leaves_lines(&chords.sides, &conics, region, below)
    }

    /// Whether the surface lies below the border of what chords leave: the ellipse and the chords
    /// themselves, but for where these run along the triangle.
    fn is_backed(&self, chords: &Chords, below: &Below, is_cut: impl Fn(DVec2) -> bool) -> bool {
        let budget = &self.grower.budget;
        let reach = budget.clip.reach();
        let beside_cut = |uv: DVec2| {
            chords.cut_along().any(|side| {
                let [a, b] = [side, (side + 1) % 3].map(|n| self.flat(self.corners[n]));
                nearest_on(a.extend(0.0), b.extend(0.0), uv.extend(0.0)).distance(uv.extend(0.0)) <= reach
            })
        };
        rim_places(self.radii, budget.rim)
            .chain(between_cuts(&chords.clips, self.radii))
            .chain(chords.clips.iter().flat_map(|clip| self.along(clip)))
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
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_surface};
    use crate::analyse::edges::Edges;
    use crate::analyse::split::split;
    use crate::analyse::surface::Surface;
    use crate::analyse::thin::Reach;
    use crate::analyse::weld::Welded;
    use crate::fit::clip::Clips;
    use crate::model::cloud::Cloud;
    use crate::sample::budget::Budget;
    use crate::sample::grow::Round;
    use crate::tolerance::QUANTIZE_SHARE;
    use glam::Vec3;

    const BOUND: f64 = 0.05;

    fn grower<'a>(surface: &'a Surface, round: &'a Round<'a>) -> Grower<'a> {
        Grower::new(surface, Budget::new(BOUND, Clips::Curved), round)
    }

    #[test]
    fn the_disc_of_a_point_that_another_stands_for_reaches_no_farther_than_it_stands_for_itself() {
        let positions =
            (0..900).map(|n: u16| Vec3::new(f32::from(n % 30), f32::from(n / 30), 0.0) / 60.0).collect();
        let cloud = Cloud { positions, ..Cloud::default() };
        let reach = Reach { radius: 0.1, offset: 0.01 };
        let (source, lines) = (NormalSource::Estimate, Lines::Given(&[]));
        let surface = cloud_surface(&cloud, source, lines, None, Some(reach), None, None).unwrap().surface;
        assert!(
            surface.points.len() * 4 < surface.pieces.len(),
            "{} points stand for all",
            surface.points.len()
        );
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = grower(&surface, &round);
        let mut region = Region::new(surface.points.len());
        for piece in 0..surface.pieces.len() as u32 {
            let Splat { center, radii, .. } = over(&grower, piece, &mut region).unwrap().splat;
            let radius = surface.piece_margin(piece) + grower.budget.pad;
            assert!(
                center.distance(surface.middle(piece)) < 1e-9 && (radii - radius).abs().max_element() < 1e-9
            );
        }
    }

    #[test]
    fn a_wide_one_goes_on_beyond_its_sides_as_far_as_borders_may() {
        let positions = vec![Vec3::ZERO, Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.25, 0.45, 0.0)];
        let welded = Welded { positions, triangles: vec![[0, 1, 2]], ..Welded::default() };
        let surface = split(&welded, &[false; 3]);
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = grower(&surface, &round);
        let reaches = |make: fn(&Grower, u32, &mut Region) -> Option<Candidate>, bounds: f64| {
            let splat = make(&grower, 0, &mut Region::new(3)).unwrap().splat;
            splat.covers(splat.to_local(DVec3::new(0.25, -bounds * BOUND, 0.0)).truncate())
        };
        assert!(reaches(over, 0.35) && !reaches(over, 0.55));
        assert!(reaches(wide, 0.75) && !reaches(wide, 0.9));
    }

    #[test]
    fn beyond_acute_corners_no_more_stands_out_than_at_cuts() {
        let mut less_padded = 0;
        // As far as the file's grids may move a splat.
        let moved = |splat: &Splat| splat.center + QUANTIZE_SHARE * BOUND * splat.axes.x_axis;
        let round = |splat: &Splat, _: u8| Some(Splat { center: moved(splat), ..splat.clone() });
        for n in 0..300_u16 {
            let (length, width, skew) = (f32::from(n % 10), f32::from(n / 10 % 6), f32::from(n / 60));
            let (x, y) = (0.1 + 0.1 * length, 0.02 + 0.06 * width);
            let positions = vec![Vec3::ZERO, Vec3::new(x, 0.0, 0.0), Vec3::new(0.4 * skew * x, y, 0.0)];
            let welded = Welded { positions, triangles: vec![[0, 1, 2]], ..Welded::default() };
            let surface = split(&welded, &[false; 3]);
            let grower = grower(&surface, &round);
            let splat = over(&grower, 0, &mut Region::new(3)).unwrap().splat;
            let corners = [0, 1, 2].map(|corner| splat.to_local(surface.point(corner)));
            let (_, least) = circumellipse(corners.map(|corner| corner.truncate()));
            less_padded +=
                u32::from(splat.radii.max_element() < least.max_element() + 0.9 * grower.budget.pad);
            let conics = splat.conics();
            let grid =
                (-50..=50).flat_map(|i| (-50..=50).map(move |j| DVec2::new(i.into(), j.into()) / 50.0));
            let uvs = grid.filter(|unit| unit.length_squared() <= 1.0).map(|unit| unit * splat.radii);
            for uv in uvs.filter(|&uv| !conics.iter().any(|conic| conic.cuts(uv))) {
                let out = to_triangle(corners, uv.extend(0.0)).length();
                assert!(out <= BOUND, "{n}: {out}");
            }
        }
        assert!(less_padded > 0, "no corner was acute enough");
    }

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
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = grower(&surface, &round);
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

    /// Whether chords along the sides of a facet that meet at an acute corner on a line go on too far beyond
    /// that: the surface goes on behind the corner, folded up by this slope, or ends at its sides.
    fn stands_out(behind: Option<f32>) -> bool {
        let beside = [-1.3, -0.3, 0.3, 1.3].map(|angle| (angle, 0.0));
        let behind = behind.into_iter().flat_map(|slope| [(2.5, slope), (3.7, slope)]);
        let place = |(angle, slope): (f32, f32)| {
            let (y, x) = angle.sin_cos();
            20.0 * BOUND as f32 * Vec3::new(x, y, -slope * x.min(0.0))
        };
        let around = beside.into_iter().chain(behind).map(place);
        let positions: Vec<Vec3> = std::iter::once(Vec3::ZERO).chain(around).collect();
        let triangles = (1..positions.len() as u32 - 1).map(|k| [0, k, k + 1]).collect();
        let welded = Welded { positions, triangles, ..Welded::default() };
        let surface = split(&welded, &vec![false; Edges::of(&welded.triangles).edges.len()]);
        // As far as the file's grids may widen a splat.
        let wider = |splat: &Splat| splat.radii + QUANTIZE_SHARE * BOUND;
        let round = |splat: &Splat, _: u8| Some(Splat { radii: wider(splat), ..splat.clone() });
        let grower = grower(&surface, &round);
        let mut region = Region::new(surface.points.len());
        let splat = over(&grower, 1, &mut region).unwrap().splat;
        let triangle = Triangle::below(&splat, &grower, [0, 2, 3]);
        assert!(region.gather(&surface, &triangle.pose, triangle.radii, &triangle.corners));
        let chords = triangle.chords(0b111, &triangle.outline()).unwrap();
        let below = Below::triangles(&surface, &triangle.pose, region.reached());
        triangle.leaves_lines(&chords.sides, &triangle.conics(&chords.clips), &region, &below)
    }

    #[test]
    fn a_triangle_without_an_inside_lies_along_its_splat() {
        let positions = vec![Vec3::ZERO, Vec3::new(0.0, 0.0, 3.0), Vec3::new(0.0, 0.0, 9.0)];
        let welded = Welded { positions, triangles: vec![[0, 1, 2]], ..Welded::default() };
        let surface = split(&welded, &vec![false; Edges::of(&welded.triangles).edges.len()]);
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let splat = over(&grower(&surface, &round), 0, &mut Region::new(surface.points.len())).unwrap().splat;
        for corner in surface.pieces[0] {
            let local = splat.to_local(surface.point(corner));
            assert!(local.z.abs() < 1e-9 && splat.ellipse(local.truncate()) < 1.0 + 1e-9, "{local}");
        }
    }

    #[test]
    fn chords_that_meet_beyond_a_corner_on_a_line_stay_near_it_or_the_surface() {
        assert!(stands_out(None), "into the air");
        assert!(!stands_out(Some(0.0)), "over a plane");
        assert!(stands_out(Some(1.5)), "below a slope");
    }
}
