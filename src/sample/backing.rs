//! Whether a domain has the surface below it all around its rim.
//!
//! The walk over the surface tells where the surface is near, not where it is missing: where
//! it folds away inside an ellipse narrower than its triangles, the far end of the ellipse
//! would stand out into the air.

use glam::{DVec2, DVec3};

use super::budget::Budget;
use super::grow::Grower;
use super::region::Region;
use crate::analyse::surface::Surface;
use crate::fit::pose::{Pose, miss};
use crate::model::clip_curve::{ClipCurve, Conic, border_point, turn};
use crate::model::triangle::to_triangle;

/// Fewest and most places looked at around the rim.
const PLACES: (f64, f64) = (16.0, 192.0);

/// Between these, places lie this many rim budgets apart: what stands out between two of
/// them stands out by little.
const APART: f64 = 4.0;

/// Most places looked at over a cloud.
const MOST_PLACES: f64 = 1024.0;

/// Directions in which a place is compared with its surroundings.
const AROUND: usize = 8;

/// A cloud's surface is there if a point looked at lies within this many of its margins, and the
/// domain's pad. Every place of the surface has a point within one, but that point need not
/// be joined to those inside the domain.
const CLOUD_REACH: f64 = 1.5;

/// How closely cuts are looked at, and a cloud's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Quickly; a cloud by the points that stand for others, each as far as it does.
    Coarse,
    /// As they will be stored; a cloud by every point.
    Fine,
}

/// A splat over the surface around its rim, whatever it is cut by.
pub struct Backing<'a> {
    budget: &'a Budget,
    overhang: f64,
    outer: DVec2,
    curvature: DVec2,
    below: Below,
    /// The surface along the lines that the region reaches.
    along_lines: Below,
    /// For places at equal angles around the rim over a cloud, whether one of its points is in reach.
    near: Vec<bool>,
}

impl<'a> Backing<'a> {
    /// That of an ellipse in a pose, over what it reaches.
    #[must_use]
    pub fn of(
        grower: &'a Grower,
        pose: &Pose,
        outer: DVec2,
        curvature: DVec2,
        region: &Region,
        look: Look,
    ) -> Self {
        let outside = || region.rim.iter().map(|&(_, outside)| outside);
        let below = match (grower.surface.spots.is_empty(), look) {
            (true, _) => Below::triangles(grower.surface, pose, outside()),
            (false, Look::Coarse) => Below::points(grower.surface, pose, region),
            (false, Look::Fine) => Below::spots(grower, pose, outer, curvature, region),
        };
        let (budget, overhang) = (&grower.budget, grower.overhang);
        let cloud = !below.points.is_empty();
        let near = if cloud { below.near_rim(outer, budget.pad) } else { Vec::new() };
        let on_line = |point: &u32| grower.surface.on_border(*point);
        let along_lines = match grower.surface.spots.is_empty() {
            true => Below::triangles(grower.surface, pose, region.reached().filter(on_line)),
            false => Below::default(),
        };
        Self { budget, overhang, outer, curvature, below, along_lines, near }
    }

    /// Whether, at every place around the rim that clip curves do not cut away, the surface lies within
    /// the budget for rims.
    #[must_use]
    pub fn holds(&self, clips: &[ClipCurve]) -> bool {
        let conics: Vec<Conic> = clips.iter().map(|clip| clip.conic(self.outer)).collect();
        let cut = |uv: DVec2| conics.iter().any(|conic| conic.cuts(uv));
        let reach = self.budget.clip.reach();
        // Curves pass somewhat outside their lines: just inside a curve there is no surface.
        let beside_cut = |uv: DVec2| directions(AROUND).any(|direction| cut(uv + reach * direction));
        if !self.near.is_empty() {
            let rim = directions(self.near.len()).map(|direction| direction * self.outer);
            let mut bare = rim.zip(&self.near).filter(|&(uv, near)| !near && !cut(uv));
            return bare.all(|(uv, _)| beside_cut(uv));
        }
        let places = rim_places(self.outer, self.budget.rim).chain(between_cuts(clips, self.outer));
        places.filter(|&uv| !cut(uv)).all(|uv| {
            let height = (self.curvature * uv * uv).element_sum();
            // Where the curve that cuts beside it lies beyond the ellipse, there may be no line near.
            let is_close = || self.along_lines.is_within(self.budget.rim, uv.extend(height));
            self.below.near(uv, height, self.budget, self.overhang) || (beside_cut(uv) && is_close())
        })
    }
}

/// Places around an ellipse, close enough together that by its rim budget little stands out between.
pub(super) fn rim_places(radii: DVec2, budget: f64) -> impl Iterator<Item = DVec2> {
    let perimeter = std::f64::consts::PI * radii.element_sum();
    directions(place_count(perimeter, budget)).map(move |direction| direction * radii)
}

/// How many places to look at along a border of some length.
pub(super) fn place_count(length: f64, budget: f64) -> usize {
    (length / (APART * budget)).clamp(PLACES.0, PLACES.1) as usize
}

/// The middles of the border's arcs between the ends of clip curves, so that no arc that is
/// kept goes unseen.
pub(super) fn between_cuts(clips: &[ClipCurve], radii: DVec2) -> impl Iterator<Item = DVec2> {
    let mut ends: Vec<f64> = clips.iter().flat_map(|clip| [clip.alpha1, clip.alpha3]).collect();
    ends.sort_unstable_by(f64::total_cmp);
    let wrapped = ends.first().map(|first| first + std::f64::consts::TAU);
    let following: Vec<f64> = ends.iter().skip(1).copied().chain(wrapped).collect();
    ends.into_iter().zip(following).map(move |(a, b)| border_point(0.5 * (a + b), radii))
}

/// Unit vectors at equal angles.
fn directions(count: usize) -> impl Iterator<Item = DVec2> {
    (0..count).map(move |n| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * n as f64 / count as f64);
        DVec2::new(cos, sin)
    })
}

/// The surface around a region's rim, in splat coordinates.
#[derive(Default)]
pub(super) struct Below {
    triangles: Vec<Facet>,
    /// Single points and how far from each the surface goes on.
    points: Vec<(DVec2, f64)>,
}

/// A triangle in splat coordinates.
struct Facet {
    corners: [DVec3; 3],
    /// The box around it in the plane of `u` and `v`: most places lie outside, which is soon seen.
    low: DVec2,
    high: DVec2,
}

impl Facet {
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners.map(|corner| corner.truncate());
        Self { corners, low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    /// Its height over a place, if it lies over it.
    fn height_over(&self, uv: DVec2) -> Option<f64> {
        let is_near = uv.cmpge(self.low).all() && uv.cmple(self.high).all();
        if is_near { height_over(&self.corners, uv) } else { None }
    }
}

impl Below {
    /// The triangles of a mesh at some points.
    pub(super) fn triangles(surface: &Surface, pose: &Pose, points: impl Iterator<Item = u32>) -> Self {
        let corners = surface.pieces_at(points).into_iter().map(|piece| surface.pieces[piece as usize]);
        let local = |point: u32| pose.to_local(surface.point(point));
        Self { triangles: corners.map(|corners| Facet::new(corners.map(local))).collect(), ..Self::default() }
    }

    /// The points of a cloud that stand for others, and themselves.
    fn points(surface: &Surface, pose: &Pose, region: &Region) -> Self {
        let with_margin = region.reached().map(|point| (point, f64::from(surface.margin[point as usize])));
        let local = |point: u32| pose.to_local(surface.point(point)).truncate();
        let points = with_margin.filter(|&(_, margin)| margin > 0.0);
        let points = points.map(|(point, margin)| (local(point), CLOUD_REACH * margin));
        Self { points: points.collect(), ..Self::default() }
    }

    /// All points of a cloud that may come near the rim. What lies off the quadric by more than a rim
    /// may reaches less far to the side.
    fn spots(grower: &Grower, pose: &Pose, outer: DVec2, curvature: DVec2, region: &Region) -> Self {
        let surface = grower.surface;
        let near = region.reached().filter(|&point| {
            let reach = CLOUD_REACH * f64::from(surface.margin[point as usize]) + grower.budget.pad;
            least_distance(pose.to_local(surface.point(point)).truncate() / outer, outer) <= reach
        });
        let spots = near.flat_map(|point| surface.pieces_of.row(point)).filter_map(|&spot| {
            let spot = surface.spots[spot as usize];
            let local = pose.to_local(spot.position.as_dvec3());
            let reach = CLOUD_REACH * f64::from(spot.margin);
            let off = (miss(curvature, local) - grower.budget.rim).max(0.0);
            (off < reach).then(|| (local.truncate(), (reach * reach - off * off).sqrt()))
        });
        Self { points: spots.collect(), ..Self::default() }
    }

    /// Whether a triangle lies within the budget for rims of a height over a place, or within
    /// `overhang` beside it.
    pub(super) fn near(&self, uv: DVec2, height: f64, budget: &Budget, overhang: f64) -> bool {
        let over = |facet: &Facet| {
            facet.height_over(uv).is_some_and(|surface| budget.reaches(surface - height, 1.0))
        };
        self.triangles.iter().any(over) || (overhang > 0.0 && self.is_within(overhang, uv.extend(height)))
    }

    /// Whether a triangle comes so close to a place, in space.
    pub(super) fn is_within(&self, reach: f64, place: DVec3) -> bool {
        self.triangles.iter().any(|facet| to_triangle(facet.corners, place).length() <= reach)
    }
}

impl Below {
    /// Which of many places around the rim have a point of a cloud in reach.
    ///
    /// Places lie about a margin apart, so that nothing wider than the reach slips between.
    fn near_rim(&self, outer: DVec2, pad: f64) -> Vec<bool> {
        let finest = self.points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min) / CLOUD_REACH;
        let around = std::f64::consts::TAU * outer.max_element() / (finest + pad);
        let count = around.clamp(PLACES.0, MOST_PLACES) as usize;
        let rim: Vec<DVec2> = directions(count).map(|direction| direction * outer).collect();
        let mut near = vec![false; count];
        for &(point, reach) in &self.points {
            let reach = reach + pad;
            let flat = point / outer;
            if least_distance(flat, outer) > reach {
                continue;
            }
            let in_reach = |n: &usize| rim[*n].distance_squared(point) <= reach * reach;
            for angle in beside(flat, outer.x >= outer.y) {
                let turns = (angle / std::f64::consts::TAU).rem_euclid(1.0);
                let at = (turns * count as f64).round() as usize % count;
                (0..count).map(|n| (at + n) % count).take_while(in_reach).for_each(|n| near[n] = true);
                (1..count)
                    .map(|n| (at + count - n) % count)
                    .take_while(in_reach)
                    .for_each(|n| near[n] = true);
            }
        }
        near
    }
}

/// No place of the rim is nearer than this to a place, given divided by the radii.
fn least_distance(flat: DVec2, outer: DVec2) -> f64 {
    (1.0 - flat.length()).abs() * outer.min_element()
}

/// Where the rim passes nearest to a place, as angles of the unit circle that it is when
/// divided by the radii: outward, and, for a place near the long axis of a needle, straight
/// to both sides of it.
fn beside(flat: DVec2, long_u: bool) -> [f64; 3] {
    let outward = libm::atan2(flat.y, flat.x);
    if long_u {
        let side = libm::acos(flat.x.clamp(-1.0, 1.0));
        [outward, side, -side]
    } else {
        let side = libm::asin(flat.y.clamp(-1.0, 1.0));
        [outward, side, std::f64::consts::PI - side]
    }
}

/// The height of a triangle over a place, if it lies over it.
fn height_over(triangle: &[DVec3; 3], uv: DVec2) -> Option<f64> {
    let [a, b, c] = triangle.map(|corner| corner.truncate());
    let (wa, wb, wc) = (turn(uv, b, c), turn(a, uv, c), turn(a, b, uv));
    let area = wa + wb + wc;
    let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
    (inside && area != 0.0).then(|| (wa * triangle[0].z + wb * triangle[1].z + wc * triangle[2].z) / area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::clip::Clips;

    #[test]
    fn heights_are_those_of_the_triangle() {
        let triangle = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(2.0, 0.0, 3.0), DVec3::new(0.0, 2.0, 1.0)];
        assert_eq!(height_over(&triangle, DVec2::new(0.5, 0.5)), Some(1.5));
        assert_eq!(height_over(&triangle, DVec2::new(1.5, 1.5)), None);
    }

    #[test]
    fn a_rim_stands_out_beside_a_triangle_by_no_more_than_it_may() {
        let triangles = vec![Facet::new([DVec3::ZERO, DVec3::NEG_X, DVec3::NEG_Y])];
        let below = Below { triangles, ..Below::default() };
        let budget = Budget { rim: 0.2, ..Budget::new(0.1, Clips::Curved) };
        let near =
            |u: f64, height: f64, overhang: f64| below.near(DVec2::new(u, 0.0), height, &budget, overhang);
        assert!(near(-0.1, 0.2, 0.0) && !near(-0.1, 0.3, 0.0), "over it the rim's budget counts");
        assert!(near(-0.1, -0.2, 0.0) && !near(-0.1, -0.3, 0.0), "and below it");
        assert!(!near(0.3, 0.0, 0.0) && near(0.3, 0.39, 0.5) && !near(0.3, 0.41, 0.5), "beside it, space");
    }

    #[test]
    fn what_a_curve_would_cut_beyond_a_needle_is_no_excuse_for_its_end() {
        let budget = Budget::new(0.1, Clips::Curved);
        // Nearly all of what it cuts lies above the ellipse, and goes on along all of that.
        let clip = ClipCurve { alpha1: 2.917, alpha3: 2.956, p2: DVec2::new(-0.344, 0.075), rho: 1.0 };
        let holds = |apex: f64| {
            let wedge = [DVec3::new(apex, 0.0, 0.0), DVec3::new(1.4, -1.5, 0.0), DVec3::new(1.4, 1.5, 0.0)];
            let [below, along_lines] =
                [(); 2].map(|()| Below { triangles: vec![Facet::new(wedge)], ..Below::default() });
            let outer = DVec2::new(0.575, 0.06);
            let (overhang, curvature, near) = (0.0, DVec2::ZERO, Vec::new());
            Backing { budget: &budget, overhang, outer, curvature, below, along_lines, near }.holds(&[clip])
        };
        assert!(holds(-0.5) && !holds(-0.313));
    }
}
