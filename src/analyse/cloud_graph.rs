//! Which points of a cloud are joined by its surface, and how far each stands for it.
//!
//! Two points are joined if their normals agree, the way between them runs along the surface
//! and is not much longer than the local spacing; of those, the nearest in each eighth of the
//! tangent plane, which holds the graph together (Yao 1982) however the points are strewn.
//!
//! A point's margin is the distance to the farthest corner of its Voronoi cell in its tangent
//! plane: every place of the cell has this point within the margin. So the margins fill the
//! surface wherever no empty disc is larger than `GAP` spacings; where one is, the surface
//! has a hole.

use std::f64::consts::TAU;

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::nearest::{NEAREST, Nearest, listed};
use super::surface::NONE;
use crate::model::discs::Gap;

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

    /// What each point is joined to, but for pairs that `cut` keeps apart.
    #[must_use]
    pub fn join(&self, cut: &(impl Fn(u32, u32) -> bool + Sync)) -> Vec<Joined> {
        (0..self.positions.len() as u32).into_par_iter().map(|point| self.join_one(point, cut)).collect()
    }

    fn join_one(&self, point: u32, cut: &impl Fn(u32, u32) -> bool) -> Joined {
        let n = point as usize;
        let (right, up) = self.normals[n].any_orthonormal_pair();
        let mut sectors = [NONE; SECTORS];
        let mut flat = [DVec2::ZERO; NEAREST];
        let mut count = 0;
        let others = listed(&self.nearest[n]);
        for other in others.filter(|&other| self.are_joined(point, other) && !cut(point, other)) {
            let way = self.positions[other as usize] - self.positions[n];
            let uv = DVec2::new(f64::from(way.dot(right)), f64::from(way.dot(up)));
            let slot = &mut sectors[sector(uv)];
            // They come nearest first.
            if *slot == NONE {
                *slot = other;
            }
            flat[count] = uv;
            count += 1;
        }
        let spacing = f64::from(self.spacing[n]);
        let Corners { farthest, open } = farthest_corner(&flat[..count], GAP * spacing);
        let gap = widest_gap(&flat[..count]).map(|[middle, half]| Gap {
            outward: libm::cos(middle) as f32 * right + libm::sin(middle) as f32 * up,
            cosine: libm::cos(half) as f32,
        });
        Joined { sectors, margin: farthest.unwrap_or(spacing) as f32, open, gap }
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

/// Most corners a cell can have: a square cut by every neighbour.
const CORNERS: usize = 4 + NEAREST;

/// The corners of a cell, as far as they count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners {
    /// Distance of the farthest from the cell's own point; `None` where none counts.
    pub farthest: Option<f64>,
    /// Whether some do not count: the cell goes on into a hole.
    pub open: bool,
}

/// The corners of the Voronoi cell of the origin among `sites`; those farther than `reach` belong to holes
/// and do not count.
#[must_use]
pub fn farthest_corner(sites: &[DVec2], reach: f64) -> Corners {
    let (mut cell, mut cut) = (&mut [DVec2::ZERO; CORNERS], &mut [DVec2::ZERO; CORNERS]);
    let mut count = 4;
    for (corner, (x, y)) in cell.iter_mut().zip([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) {
        *corner = DVec2::new(x, y) * reach;
    }
    let (mut farthest, mut beyond) = (2.0 * reach * reach, [0.0; CORNERS]);
    for site in sites.iter().take(NEAREST) {
        // A site at more than twice the distance of every corner cuts none of them off.
        if site.length_squared() > 4.0 * farthest {
            continue;
        }
        // Places nearer to the site lie beyond the bisector, on its far side.
        for (beyond, corner) in beyond.iter_mut().zip(&cell[..count]) {
            *beyond = corner.dot(*site) - 0.5 * site.length_squared();
        }
        if beyond[..count].iter().all(|beyond| *beyond <= 0.0) {
            continue;
        }
        count = near_side(&cell[..count], &beyond, cut);
        std::mem::swap(&mut cell, &mut cut);
        farthest = cell[..count].iter().map(|corner| corner.length_squared()).fold(0.0, f64::max);
    }
    let corners = cell[..count].iter().map(|corner| corner.length());
    // Corners of the square itself, or on its sides, lie at least `reach` away.
    let near = |distance: &f64| *distance < reach * (1.0 - 1e-9);
    let open = corners.clone().any(|distance| !near(&distance));
    Corners { farthest: corners.filter(|distance| *distance > 0.0 && near(distance)).reduce(f64::max), open }
}

/// The part of a cell this side of a line, by how far its corners lie beyond it; how many corners that has.
fn near_side(cell: &[DVec2], beyond: &[f64], part: &mut [DVec2; CORNERS]) -> usize {
    let mut kept = 0;
    for n in 0..cell.len() {
        let next = if n + 1 < cell.len() { n + 1 } else { 0 };
        let (fa, fb) = (beyond[n], beyond[next]);
        if fa <= 0.0 && kept < CORNERS {
            part[kept] = cell[n];
            kept += 1;
        }
        if (fa < 0.0) != (fb < 0.0) && kept < CORNERS {
            part[kept] = cell[n].lerp(cell[next], fa / (fa - fb));
            kept += 1;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn corners_of_planted_cells() {
        let square: Vec<DVec2> = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1)]
            .map(|(x, y)| DVec2::new(x.into(), y.into()))
            .to_vec();
        let corner = |sites: &[DVec2]| farthest_corner(sites, 2.5).farthest;
        let open = |sites: &[DVec2]| farthest_corner(sites, 2.5).open;
        assert!((corner(&square).unwrap() - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12);
        let hexagon: Vec<DVec2> =
            (0..6).map(|n| DVec2::from_angle(f64::from(n) * std::f64::consts::FRAC_PI_3)).collect();
        assert!((corner(&hexagon).unwrap() - 1.0 / 3.0_f64.sqrt()).abs() < 1e-12);
        // At the border of a lattice only the corners on the inner side count.
        assert!(
            (corner(&[DVec2::X, DVec2::Y, -DVec2::X]).unwrap() - std::f64::consts::FRAC_1_SQRT_2).abs()
                < 1e-12
        );
        assert_eq!(corner(&[DVec2::X, -DVec2::X]), None, "a line of points bounds no cell");
        assert_eq!(corner(&[]), None);
        let half_turn = [DVec2::X, DVec2::Y, DVec2::NEG_X];
        let gap = widest_gap(&half_turn).map(|gap| gap.map(f64::to_degrees));
        assert!(
            gap.is_some_and(|[middle, half]| (middle - 270.0).abs() < 1e-9 && (half - 90.0).abs() < 1e-9)
        );
        assert_eq!((widest_gap(&hexagon), widest_gap(&[])), (None, Some([0.5 * TAU; 2])));
        assert!(!open(&square) && !open(&hexagon) && open(&hexagon[..3]) && open(&[]));
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
        let nearest = super::super::nearest::Search::new(&positions).unwrap().nearest();
        let spacing = super::super::nearest::spacing(&positions, &nearest);
        let normals = vec![Vec3::Z; positions.len()];
        let sites = Sites {
            positions: &positions,
            normals: &normals,
            spacing: &spacing,
            nearest: &nearest,
            noise: 0.0,
        };
        let joined = sites.join(&|_, _| false);
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
