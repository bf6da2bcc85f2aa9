//! Which points of a cloud are joined by its surface, and how far each stands for it.
//!
//! Two points are joined if their normals agree, the way between them runs along the surface
//! and is not much longer than the local spacing; of those, the nearest in each eighth of the
//! tangent plane, which holds the graph together (Yao 1982) however the points are strewn.
//!
//! A point's margin is the distance to the farthest corner of its Voronoi cell in its tangent
//! plane, as far as feature lines leave it to its sheet: every place of the cell has this point within
//! the margin. So the margins fill the surface wherever no empty disc is larger than `GAP` spacings;
//! where one is, the surface has a hole.

use std::f64::consts::TAU;

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::cell::{Cell, Corners, Side};
use super::nearest::{NEAREST, Nearest, listed};
use super::surface::NONE;
use crate::model::discs::{End, Gap};

/// Normals of joined points agree by at least this cosine (60°).
const AGREE: f32 = 0.5;

/// The way between joined points leaves either tangent plane by less than this sine (45°).
const ALONG: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Joined points lie within this many spacings of either.
const FAR: f32 = 4.0;

/// An empty disc of a radius of more spacings than this is a hole. In an even random
/// sampling of ten million points about one disc is that large.
const GAP: f64 = 2.5;

/// A wedge without points wider than this (150°) lies beyond a border or in a hole: among sixteen others
/// strewn evenly about a point, one in two hundred has such a wedge by chance.
const WIDE: f64 = TAU * 5.0 / 12.0;

/// Sectors of the tangent plane.
pub const SECTORS: usize = 8;

/// Points of a cloud as the graph sees them, side by side.
#[derive(Clone, Copy, Debug)]
pub struct Sites<'a> {
    /// Positions, model units.
    pub positions: &'a [Vec3],
    /// Unit normals.
    pub normals: &'a [Vec3],
    /// Local spacings, model units.
    pub spacing: &'a [f32],
    /// The nearest others of each.
    pub nearest: &'a Nearest,
    /// Standard deviation of the points from their surface, model units; 0 where they show none.
    pub noise: f64,
}

/// What one point is joined to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joined {
    /// The nearest joined point of each sector of the tangent plane, or [`NONE`].
    pub sectors: [u32; SECTORS],
    /// How far the point stands for the surface, model units.
    pub margin: f32,
    /// Whether the cell is not closed within what a hole is wide, as at a border.
    pub open: bool,
    /// Where no point is joined to it, if that is wider than an even sampling leaves it.
    pub gap: Option<Gap>,
}

/// Whether points at a distance, with such spacings, are near enough for the surface to go from one
/// to the other.
#[must_use]
pub fn are_near(distance: f32, spacings: [f32; 2]) -> bool {
    distance <= FAR * spacings[0].min(spacings[1])
}

impl Sites<'_> {
    /// Whether the surface goes straight from one point to another.
    #[must_use]
    pub fn are_joined(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        let way = self.positions[b] - self.positions[a];
        let length = way.length();
        let (na, nb) = (self.normals[a], self.normals[b]);
        let near = are_near(length, [self.spacing[a], self.spacing[b]]);
        let slope = way.dot(na).abs().max(way.dot(nb).abs());
        near && na.dot(nb) >= AGREE && slope <= ALONG * length
    }

    /// What each point is joined to, as far as lines leave them on one sheet.
    #[must_use]
    pub fn join(&self, parted: &impl Parted) -> Vec<Joined> {
        let points = 0..self.positions.len() as u32;
        points.into_par_iter().map(|point| Around::of(self, point, parted).joined()).collect()
    }

    /// For each point whose sheet ends at a line nearby, in their order, the corners of what it stands for, model
    /// units: of its cell, or where that is open of as much of it as lies within its margin.
    #[must_use]
    pub fn cells(&self, parted: &impl Parted) -> Vec<(u32, Vec<Vec3>)> {
        let points = (0..self.positions.len() as u32).into_par_iter();
        let cell = |point| Some((point, Around::of(self, point, parted).cell()?));
        points.filter(|&point| parted.is_beside(point)).filter_map(cell).collect()
    }
}

/// How feature lines part the sheets of a cloud.
pub trait Parted: Sync {
    /// Whether a point lies beside a line.
    fn is_beside(&self, point: u32) -> bool;
    /// Whether a line passes between two points.
    fn parts(&self, a: u32, b: u32) -> bool;
    /// Pieces of lines at which the sheet of a point ends within a distance, model units.
    fn ends(&self, point: u32, reach: f64) -> Vec<End>;
}

/// No line parts anything.
#[derive(Clone, Copy, Debug)]
pub struct Whole;

impl Parted for Whole {
    fn is_beside(&self, _: u32) -> bool {
        false
    }

    fn parts(&self, _: u32, _: u32) -> bool {
        false
    }

    fn ends(&self, _: u32, _: f64) -> Vec<End> {
        Vec::new()
    }
}

/// A point and what is joined to it, in its tangent plane.
struct Around<'a> {
    sites: &'a Sites<'a>,
    point: usize,
    axes: [Vec3; 2],
    sectors: [u32; SECTORS],
    flat: [DVec2; NEAREST],
    count: usize,
    /// What ends its sheet.
    sides: Vec<Side>,
}

impl<'a> Around<'a> {
    fn of(sites: &'a Sites<'a>, point: u32, parted: &impl Parted) -> Self {
        let n = point as usize;
        let (right, up) = sites.normals[n].any_orthonormal_pair();
        let (sectors, flat) = ([NONE; SECTORS], [DVec2::ZERO; NEAREST]);
        let mut around =
            Self { sites, point: n, axes: [right, up], sectors, flat, count: 0, sides: Vec::new() };
        let others = listed(&sites.nearest[n]);
        for other in others.filter(|&other| sites.are_joined(point, other) && !parted.parts(point, other)) {
            let uv = around.flattened(sites.positions[other as usize] - sites.positions[n]);
            let slot = &mut around.sectors[sector(uv)];
            // They come nearest first.
            if *slot == NONE {
                *slot = other;
            }
            around.flat[around.count] = uv;
            around.count += 1;
        }
        let side = |end: End| Side {
            ends: end.ends.map(|end| around.flattened(end - sites.positions[n])),
            inward: around.flattened(end.inward),
        };
        around.sides = parted.ends(point, around.reach()).into_iter().map(side).collect();
        around
    }

    fn flattened(&self, way: Vec3) -> DVec2 {
        let [right, up] = self.axes;
        DVec2::new(f64::from(way.dot(right)), f64::from(way.dot(up)))
    }

    /// What lies as far belongs to a hole.
    fn reach(&self) -> f64 {
        GAP * f64::from(self.sites.spacing[self.point])
    }

    fn joined(&self) -> Joined {
        let [right, up] = self.axes;
        let (margin, open) = self.margin();
        let gap = widest_gap(&self.flat[..self.count]).map(|[middle, half]| Gap {
            outward: libm::cos(middle) as f32 * right + libm::sin(middle) as f32 * up,
            cosine: libm::cos(half) as f32,
        });
        Joined { sectors: self.sectors, margin: margin as f32, open, gap }
    }

    /// How far the point stands for the surface, and whether its cell goes on into a hole.
    fn margin(&self) -> (f64, bool) {
        let cell = self.cell_within(self.reach());
        let Corners { farthest, open } =
            if self.sides.is_empty() { cell.whole() } else { cell.within(&self.sides) };
        (farthest.unwrap_or(f64::from(self.sites.spacing[self.point])), open)
    }

    fn cell_within(&self, reach: f64) -> Cell {
        Cell::of(&self.flat[..self.count], reach)
    }

    /// The corners of what the point stands for, and the point, which may lie across the line; `None` where nothing
    /// ends its sheet, and where a line passes in the point's plane before one that it is joined to: there the cells of
    /// the points around do not fit together, and would leave cracks.
    fn cell(&self) -> Option<Vec<Vec3>> {
        if self.sides.is_empty() {
            return None;
        }
        let [right, up] = self.axes;
        let place = |uv: DVec2| self.sites.positions[self.point] + uv.x as f32 * right + uv.y as f32 * up;
        let (margin, open) = self.margin();
        let cell = self.cell_within(if open { margin } else { self.reach() });
        if cell.parts(&self.sides, &self.flat[..self.count]) {
            return None;
        }
        let corners = cell.reached(&self.sides);
        let near = |corner: DVec2| if open { corner.clamp_length_max(margin) } else { corner };
        Some(corners.into_iter().map(near).chain([DVec2::ZERO]).map(place).collect())
    }
}

/// Middle direction and half the angle of the widest wedge without any of `sites`, its tip at the origin, if
/// it is wider than [`WIDE`]; radians.
pub(super) fn widest_gap(sites: &[DVec2]) -> Option<[f64; 2]> {
    if !may_gape(sites) {
        return None;
    }
    let mut angles: Vec<f64> = sites.iter().map(|site| libm::atan2(site.y, site.x)).collect();
    angles.sort_unstable_by(f64::total_cmp);
    let first = angles.first().map_or(TAU, |first| first + TAU);
    let from = angles.last().map_or(0.0, |last| *last);
    let gaps = angles.windows(2).map(|pair| [pair[0], pair[1]]).chain([[from, first]]);
    let [from, to] = gaps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    (to - from > WIDE).then_some([0.5 * (from + to), 0.5 * (to - from)])
}

/// Whether two eighths of the plane side by side are empty, as in any wedge wider than 135°: around most
/// points none are, and no angle has to be computed.
fn may_gape(sites: &[DVec2]) -> bool {
    let mut seen = [false; SECTORS];
    sites.iter().for_each(|&site| seen[sector(site)] = true);
    (0..SECTORS).any(|n| !seen[TURN[n]] && !seen[TURN[(n + 1) % SECTORS]])
}

/// The sectors one after another around the origin.
const TURN: [usize; SECTORS] = [0, 4, 5, 1, 3, 7, 6, 2];

/// The eighth of the plane a place lies in.
fn sector(uv: DVec2) -> usize {
    let steep = uv.y.abs() > uv.x.abs();
    usize::from(uv.x < 0.0) + 2 * usize::from(uv.y < 0.0) + 4 * usize::from(steep)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::{lay, side_by_side};

    #[test]
    fn wedges_without_sites_are_told() {
        let hexagon: Vec<DVec2> =
            (0..6).map(|n| DVec2::from_angle(f64::from(n) * std::f64::consts::FRAC_PI_3)).collect();
        let half_turn = [DVec2::X, DVec2::Y, DVec2::NEG_X];
        let gap = widest_gap(&half_turn).map(|gap| gap.map(f64::to_degrees));
        assert!(
            gap.is_some_and(|[middle, half]| (middle - 270.0).abs() < 1e-9 && (half - 90.0).abs() < 1e-9)
        );
        assert_eq!((widest_gap(&hexagon), widest_gap(&[])), (None, Some([0.5 * TAU; 2])));
    }

    #[test]
    fn wherever_a_wedge_lies_its_angle_counts() {
        for n in 0..720 {
            let from = f64::from(n).to_radians() / 2.0;
            // Five sites, evenly over all but a wedge of 152° and over all but one of 148°.
            let sites = |wedge: f64| -> Vec<DVec2> {
                let step = (TAU - wedge.to_radians()) / 4.0;
                (0..5).map(|k| DVec2::from_angle(from + f64::from(k) * step)).collect()
            };
            let [_, half] = widest_gap(&sites(152.0)).unwrap();
            assert!((2.0 * half.to_degrees() - 152.0).abs() < 1e-9);
            assert_eq!(widest_gap(&sites(148.0)), None);
        }
    }

    #[test]
    fn margins_fill_a_random_sampling() {
        let value = |n: u64| (super::super::canonical::mix(n) >> 40) as f32 / (1 << 23) as f32 - 1.0;
        let positions: Vec<Vec3> =
            (0..3000).map(|n| Vec3::new(value(2 * n), value(2 * n + 1), 0.0)).collect();
        let (_, nearest, spacing) = lay(&positions);
        let normals = vec![Vec3::Z; positions.len()];
        let sites = side_by_side(&positions, &normals, &nearest, &spacing);
        let joined = sites.join(&Whole);
        for n in 0..4000 {
            let place = 0.9 * Vec3::new(value(90_000 + 2 * n), value(90_001 + 2 * n), 0.0);
            let covered = positions.iter().zip(&joined).any(|(p, j)| p.distance(place) <= j.margin * 1.0001);
            assert!(covered, "{place}");
        }
        let mean = joined.iter().map(|j| f64::from(j.margin)).sum::<f64>() / 3000.0;
        let mean_spacing = spacing.iter().map(|s| f64::from(*s)).sum::<f64>() / 3000.0;
        assert!(mean < 1.2 * mean_spacing, "{mean} {mean_spacing}");
    }
}
