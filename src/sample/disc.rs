//! The disc of last resort around one point of a cloud, cut along the lines that it reaches.
//!
//! It reaches as far as its point stands for the surface, beside a line as an ellipse around that, which goes somewhat
//! too far across. Seen from above it is cut along curves that follow the lines, though these may rise from the disc.
//! Where none do, chords along some of the lines may, as far as the surface keeps to one side of them, and else one
//! beside them, as far across as it goes.

use glam::DVec2;

use super::grow::{Grower, MOST_CLIPS};
use super::outline::{Outline, border_sides, holds_an_end, outlines};
use super::region::{Member, Region};
use crate::fit::clip;
use crate::fit::ellipse::crossings;
use crate::fit::pose::Pose;
use crate::model::clip_curve::{ClipCurve, Conic};
use crate::model::polyline::nearest_on;
use crate::model::splat::Splat;

/// A side is cut along already if a place so many misses past the cut along it is cut away: lines wander a little.
const PAST: f64 = 2.0;

/// The disc over a piece of a cloud cut along the lines around, by curves none of which cuts anything of the surface that
/// the disc lies near; uncut where rounding would let them cut the point itself.
#[must_use]
pub fn cut(grower: &Grower, disc: Splat, piece: u32, region: &mut Region) -> Splat {
    let pose = Pose { center: disc.center, axes: disc.axes };
    let seeds = grower.surface.pieces[piece as usize];
    if !region.gather(grower.surface, &pose, disc.radii, &seeds) {
        return disc;
    }
    let place = disc.to_local(grower.surface.middle(piece)).truncate();
    let lines = Lines { grower, pose, radii: disc.radii, place, region };
    let clips = lines.curves().unwrap_or_else(|| lines.chords());
    let splat = Splat { clips, ..disc.clone() };
    let keeps = |stored: Splat| !stored.clips.iter().any(|clip| clip.cuts(place, stored.radii));
    if grower.rounded(&splat).is_some_and(keeps) { splat } else { disc }
}

/// The lines that a disc reaches.
struct Lines<'a> {
    grower: &'a Grower<'a>,
    pose: Pose,
    radii: DVec2,
    /// Where its point lies.
    place: DVec2,
    region: &'a Region,
}

impl Lines<'_> {
    /// Curves along all lines; `None` where there are none, one cannot be followed so, its curve cuts the surface, or
    /// what all leave goes on over such of the surface as the disc is not near.
    fn curves(&self) -> Option<Vec<ClipCurve>> {
        let (surface, tolerance) = (self.grower.surface, &self.grower.budget.clip);
        if holds_an_end(surface, self.region, &self.pose, self.radii, tolerance.outset) {
            return None;
        }
        let mut clips = Vec::new();
        for Outline { points, closed, .. } in outlines(surface, self.region, &self.pose, self.grower.open) {
            clips.extend(clip::fit(&points, closed, self.radii, tolerance)?);
        }
        let conics: Vec<Conic> = clips.iter().map(|clip| clip.conic(self.radii)).collect();
        let few = (1..=MOST_CLIPS).contains(&clips.len());
        (few && conics.iter().all(|conic| self.keeps(conic)) && !self.goes_astray(&conics)).then_some(clips)
    }

    /// Chords along them, the nearest first, as long as some line is not cut along.
    fn chords(&self) -> Vec<ClipCurve> {
        let (mut clips, mut conics) = (Vec::new(), Vec::<Conic>::new());
        let sides = self.sides();
        for &side in &sides {
            if clips.len() < MOST_CLIPS
                && !conics.iter().any(|conic| conic.cuts(self.across(side)))
                && let Some((clip, conic)) = self.chord(side)
            {
                clips.push(clip);
                conics.push(conic);
            }
        }
        // The surface may lie around a line's bend.
        if clips.is_empty()
            && let Some(&nearest) = sides.first()
        {
            clips.extend(self.chord_beyond(nearest));
        }
        clips
    }

    /// Sides of lines beyond which the disc goes farther than cuts may, the nearest first.
    fn sides(&self) -> Vec<[DVec2; 2]> {
        let flat = |point: u32| self.pose.to_local(self.grower.surface.point(point)).truncate();
        let ends = border_sides(self.grower.surface, self.region).into_iter();
        let ends = ends.filter(|&(from, _)| !self.grower.surface.is_carried(from));
        let sides = ends.map(|(from, to)| [flat(from), flat(to)]);
        let place = self.place.extend(0.0);
        let off = |[a, b]: [DVec2; 2]| nearest_on(a.extend(0.0), b.extend(0.0), place).distance(place);
        let mut near: Vec<(f64, [DVec2; 2])> = sides.map(|side| (off(side), side)).collect();
        near.retain(|&(_, side)| self.is_crossed(side));
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.into_iter().map(|(_, side)| side).collect()
    }

    /// Whether a side passes through it, farther inside than cuts may lie off.
    fn is_crossed(&self, [a, b]: [DVec2; 2]) -> bool {
        let inner = self.radii - self.grower.budget.clip.edge;
        let within = || crossings(a, b, inner).is_some_and(|(enter, leave)| enter < 1.0 && leave > 0.0);
        inner.min_element() > 0.0 && within()
    }

    /// A place just across a side.
    fn across(&self, [a, b]: [DVec2; 2]) -> DVec2 {
        let tolerance = &self.grower.budget.clip;
        a.midpoint(b) - (b - a).perp().normalize_or_zero() * (tolerance.outset + PAST * tolerance.miss)
    }

    /// The chord along a side; `None` if it would cut any of the surface.
    fn chord(&self, side: [DVec2; 2]) -> Option<(ClipCurve, Conic)> {
        let clip = clip::along(side, self.radii, &self.grower.budget.clip)?.pop()?;
        let conic = clip.conic(self.radii);
        self.keeps(&conic).then_some((clip, conic))
    }

    /// Whether curves leave what members lie over or under that the disc is not near.
    fn goes_astray(&self, conics: &[Conic]) -> bool {
        let left = |member: &Member| !conics.iter().any(|conic| conic.cuts(member.local.truncate()));
        self.region.members.iter().any(|member| !self.is_near(member) && left(member))
    }

    /// Whether a curve cuts nothing of the surface that the disc is near.
    fn keeps(&self, conic: &Conic) -> bool {
        self.near().all(|member| !conic.cuts(member.local.truncate()))
    }

    /// The members that the disc lies so near to as splats have to; others may lie beyond a line that turns back.
    fn near(&self) -> impl Iterator<Item = &Member> {
        self.region.members.iter().filter(|member| self.is_near(member))
    }

    fn is_near(&self, member: &Member) -> bool {
        self.grower.budget.reaches(member.local.z, 1.0)
    }

    /// The chord beside a side, as far across it as the surface goes.
    fn chord_beyond(&self, side: [DVec2; 2]) -> Option<ClipCurve> {
        let [from, to] = side;
        let out = -(to - from).perp().normalize_or_zero();
        let beyond = |member: &Member| (member.local.truncate() - from).dot(out);
        let farthest = self.near().map(beyond).fold(0.0, f64::max);
        let moved = side.map(|end| end + farthest * out);
        let stands_out = (self.radii * out).length() - moved[0].dot(out);
        // Less than a rim may stand out by is not worth a cut.
        if stands_out > self.grower.budget.rim { Some(self.chord(moved)?.0) } else { None }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::budget::Budget;
    use super::super::polygon;
    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines as Given, cloud_surface};
    use crate::analyse::planted::{on_step, random};
    use crate::analyse::surface::Surface;
    use crate::fit::clip::Clips;
    use crate::model::cloud::Cloud;
    use glam::{DVec3, Vec3};

    const BOUND: f64 = 0.002;

    /// The discs over the points of a cloud, each with its point, with its edges given.
    fn discs(positions: Vec<Vec3>, edges: &[Vec<DVec3>]) -> Vec<(Vec3, Splat)> {
        let cloud = Cloud { positions, ..Cloud::default() };
        let (source, given) = (NormalSource::Estimate, Given::Given(edges));
        let surface = cloud_surface(&cloud, source, given, None, None, None, None).unwrap().surface;
        let grower =
            Grower::new(&surface, Budget::new(BOUND, Clips::Curved), &|splat, _| Some(splat.clone()));
        let mut region = Region::new(surface.points.len());
        let mut over = |piece: u32| polygon::over(&grower, piece, &mut region).unwrap().splat;
        (0..surface.pieces.len() as u32).map(|piece| (surface.middle(piece).as_vec3(), over(piece))).collect()
    }

    fn is_cut(splat: &Splat, uv: DVec2) -> bool {
        splat.clips.iter().any(|clip| clip.cuts(uv, splat.radii))
    }

    #[test]
    fn discs_end_where_faces_do() {
        // Three squares that meet along x, y and z.
        let place = |n: u64| {
            let (a, b) = (0.25 + 0.25 * random(2 * n), 0.25 + 0.25 * random(2 * n + 1));
            [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)][(n % 3) as usize].as_vec3()
        };
        let edges = DVec3::AXES.map(|axis| vec![DVec3::ZERO, 0.5 * axis]);
        let mut reached = [0.0_f64; 2];
        for (_, splat) in
            discs((0..9000).map(place).collect(), &edges).iter().filter(|(at, _)| at.max_element() < 0.4)
        {
            for n in 0..64 {
                let (sin, cos) = libm::sincos(0.1 * f64::from(n));
                let rim = DVec2::new(cos, sin) * splat.radii;
                let beyond = -(splat.center + splat.axes * rim.extend(0.0)).min_element() / BOUND;
                reached[0] = reached[0].max(beyond);
                if !is_cut(splat, rim) {
                    reached[1] = reached[1].max(beyond);
                }
            }
        }
        let most = Budget::new(1.0, Clips::Curved).clip.edge;
        assert!(reached[0] > 2.0 && reached[1] <= most, "{reached:?} bounds beyond, uncut and cut");
    }

    #[test]
    fn discs_beside_a_round_hole_reach_into_it_no_farther_than_the_face_around_goes() {
        const HOLE: f64 = 0.04;
        let around = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            HOLE * DVec3::new(cos, sin, 0.0)
        };
        let place = |n: u64| {
            let (a, b) = (random(2 * n), random(2 * n + 1));
            let face = DVec3::new(0.3 * a, 0.3 * b, 0.0);
            let wall = around(std::f64::consts::PI * a) - DVec3::new(0.0, 0.0, 0.1 * (b + 1.0));
            if n.is_multiple_of(4) || face.length() < HOLE { wall.as_vec3() } else { face.as_vec3() }
        };
        let rim: Vec<DVec3> = (0..=64).map(|n| around(std::f64::consts::TAU * f64::from(n) / 64.0)).collect();
        let discs = discs((0..4000).map(place).collect(), &[rim]);
        let beside = discs.iter().filter(|(at, _)| at.z == 0.0 && at.length() < 0.06);
        let (mut uncut, mut cut) = (0.0_f64, 0.0_f64);
        for (at, splat) in beside {
            for n in 0..64 {
                let (sin, cos) = libm::sincos(0.1 * f64::from(n));
                let reached = DVec2::new(cos, sin) * splat.radii;
                let into = (HOLE - (splat.center + splat.axes * reached.extend(0.0)).length()) / BOUND;
                uncut = uncut.max(into);
                if !is_cut(splat, reached) {
                    cut = cut.max(into);
                }
            }
            for (other, _) in discs.iter().filter(|(other, _)| other.z == 0.0 && other.distance(*at) < 0.01) {
                assert!(!is_cut(splat, splat.to_local(other.as_dvec3()).truncate()), "{other} over {at}");
            }
        }
        assert!(uncut > 4.0 && cut < 1.0, "{uncut} bounds into the hole, cut {cut}");
    }

    #[test]
    fn beside_an_edge_discs_are_as_slender_as_what_their_points_stand_for_and_fill_it() {
        // On a floor and a wall that meet along y points lie three times as far apart along it as across.
        let (across, along) = (0.004_f32, 0.012_f32);
        let place = |n: u16| {
            let (row, off) = (f32::from(n / 2 % 50) - 25.0, across * (f32::from(n / 100) + 0.5));
            let y = along * row;
            if n.is_multiple_of(2) { Vec3::new(-off, y, 0.0) } else { Vec3::new(0.0, y, -off) }
        };
        let edge = (-50..=50).map(|n| DVec3::new(0.0, 0.006 * f64::from(n), 0.0)).collect();
        let discs = discs((0..4000).map(place).collect(), &[edge]);
        let is_beside = |at: Vec3| at.z == 0.0 && at.x > -across && at.y.abs() < 0.2;
        let beside: Vec<&Splat> =
            discs.iter().filter(|(at, _)| is_beside(*at)).map(|(_, splat)| splat).collect();
        for splat in &beside {
            assert!(splat.radii.min_element() < 0.7 * splat.radii.max_element(), "{}", splat.radii);
        }
        for n in 0..2000 {
            let (x, y) = (-f64::from(across) * random(2 * n).abs(), 0.15 * random(2 * n + 1));
            let over = |splat: &&Splat| {
                let uv = splat.to_local(DVec3::new(x, y, 0.0)).truncate();
                splat.ellipse(uv) <= 1.0 && !is_cut(splat, uv)
            };
            assert!(beside.iter().any(over), "{x} {y}");
        }
        assert!(beside.len() > 30, "{}", beside.len());
    }

    #[test]
    fn nothing_of_a_face_is_cut_away_at_a_corner_that_points_into_it() {
        let edges = [DVec3::X, DVec3::Y].map(|axis| vec![DVec3::ZERO, 0.5 * axis]);
        let discs = discs((0..12_000).map(|n| on_step(n).0.as_vec3()).collect(), &edges);
        let floor: Vec<&(Vec3, Splat)> = discs.iter().filter(|(at, _)| at.z == 0.0).collect();
        let (mut cut, mut around) = (0, 0);
        for (at, splat) in floor.iter().filter(|(at, _)| at.truncate().abs().max_element() < 0.1) {
            cut += u32::from(!splat.clips.is_empty());
            for (other, _) in floor.iter().filter(|(other, _)| f64::from(other.distance(*at)) < splat.radii.x)
            {
                assert!(!is_cut(splat, splat.to_local(other.as_dvec3()).truncate()), "{other} over {at}");
                around += 1;
            }
        }
        assert!(cut > 5 && around > 500, "{cut} are cut, with {around} points around");
    }

    #[test]
    fn what_the_disc_is_not_near_may_be_cut_away_and_has_to_be() {
        let surface = Surface::default();
        let grower =
            Grower::new(&surface, Budget::new(BOUND, Clips::Curved), &|splat, _| Some(splat.clone()));
        let mut region = Region::new(2);
        let at = |x: f64, height: f64| DVec3::new(x, 0.0, height * BOUND);
        let chord = ClipCurve::chord(-1.0, 1.0).conic(DVec2::ONE);
        assert!(chord.cuts(DVec2::new(0.9, 0.0)) && !chord.cuts(DVec2::ZERO));
        for (height, cut, left) in [(0.5, false, false), (-9.0, true, true), (9.0, true, true)] {
            let mut told = |x: f64| {
                region.members = vec![DVec3::ZERO, at(x, height)]
                    .into_iter()
                    .zip(0..)
                    .map(|(local, point)| Member { point, local })
                    .collect();
                let (pose, place) = (Pose::default(), DVec2::ZERO);
                let lines = Lines { grower: &grower, pose, radii: DVec2::ONE, place, region: &region };
                (lines.keeps(&chord), lines.goes_astray(&[chord]))
            };
            assert_eq!(told(0.9), (cut, false), "across the chord, {height} bounds high");
            assert_eq!(told(0.2), (true, left), "on the disc's side, {height} bounds high");
        }
    }
}
