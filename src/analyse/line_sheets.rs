//! The sheets of a cloud that meet at feature lines.
//!
//! Around each segment of a line the points fall, seen along it, into clusters of direction (`angles`):
//! one for each sheet of the surface that ends there.

mod angles;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_graph::Sites;
use super::line_network::Network;
use super::segment_grid::SegmentGrid;
use super::strips::{Strips, put_among};
use super::surface::Rows;
use crate::model::polyline::nearest_on;
pub(super) use angles::SEPARATE;

/// Points nearer than this many spacings to a line have no direction from it to speak of...
const TOO_NEAR: f64 = 0.3;

/// ... nor have those nearer than this many standard deviations of the noise, which turns the direction of
/// one there by 11°: sheets at right angles are told apart still.
const ABOVE_NOISE: f64 = 5.0;

/// Noisier points than this, in spacings, are taken for no noisier: how a surface goes on hardly shows.
const NOISIEST: f64 = 1.0;

/// Points within this many spacings beyond those show the sheets of a line...
const DEPTH: f64 = 2.7;

/// ... and points within this many of a line are told apart by them, where they meet sharply: at 36° they are two
/// spacings and a half apart there, beyond which few of a point's neighbours are on the other.
const TOLD_APART: f64 = 4.3;

/// Sheets meet sharply at an angle of less than this (cosine of 60°).
const SHARP: f64 = 0.5;

/// Points whose surface passes by a line lie farther from it than this share of the depth, where normals are of
/// one sheet...
const BY: f64 = 0.5;

/// ... their planes miss it by more than this sine of the way to it (45°)...
const PAST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// ... and they lie off the way that any sheet runs (cosine of 60°).
const OFF: f64 = 0.5;

/// Segments on either side, along the line, whose points vote too: four to eight spacings,
/// so that the wedge of a sheet that is left beside a corner still holds a few points.
pub(super) const WINDOW: usize = 8;

/// A point's nearest place on a line is where the line ends if it lies within this share of its distance from
/// there (11°): a line's last segment may slant a little, and face points that lie past its end.
const AT_END: f64 = 0.2;

/// Segments that turn away from the one in question by more than this (cosine of 30°) do not
/// vote.
const ALIGNED: f64 = 0.866;

/// A sheet that ends at a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Unit vector from the line into the sheet, perpendicular to the line.
    pub inward: DVec3,
    /// Unit normal of the sheet at the line, perpendicular to both.
    pub normal: DVec3,
    /// Points of the sheet, nearest to the middle of the segment first.
    pub points: Vec<u32>,
}

/// A point's nearest place on the lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// The segment.
    pub segment: u32,
    /// From the place to the point.
    pub offset: DVec3,
    /// Whether the place is, or nearly is, where a line ends or turns sharply.
    pub at_end: bool,
}

/// What lies beside the lines.
#[derive(Clone, Debug, Default)]
pub struct Sheets {
    /// For each segment its sheets, in the order of their angle.
    pub of: Vec<Vec<Sheet>>,
    /// For each point of the cloud near a line, where.
    pub beside: Vec<Option<Beside>>,
}

impl Sheets {
    /// Finds the sheets that meet at each segment of a network.
    #[must_use]
    pub fn find(network: &Network, sites: &Sites) -> Self {
        let told = |n: usize| depth(sites, n).max(TOLD_APART * f64::from(sites.spacing[n]));
        let mut beside = beside_within(network, sites, told);
        let mut of = sheets_of(network, sites, &beside, |_| true);
        let strips = Strips::new(network, sites, &beside);
        of.par_iter_mut().zip(0_u32..network.segments.len() as u32).for_each(|(sheets, segment)| {
            if let Some(strip) = strips.beyond(segment, sheets) {
                put_among(sheets, network.along(segment), strip);
            }
        });
        beside.par_iter_mut().enumerate().for_each(|(n, beside)| {
            *beside = beside.filter(|beside| {
                let sheets = &of[beside.segment as usize];
                let near = beside.offset.length() <= depth(sites, n);
                (near || meet_sharply(sheets)) && !(passes_by(sites, n, beside) && is_off(sheets, beside))
            });
        });
        Self { of, beside }
    }

    /// Which sheet of a segment lies in a direction from it; the nearest by angle.
    #[must_use]
    pub fn toward(&self, network: &Network, segment: u32, point: DVec3) -> Option<usize> {
        let along = network.along(segment);
        let [a, _] = network.ends(segment);
        let offset = (point - a).reject_from_normalized(along).normalize_or_zero();
        let sheets = self.of[segment as usize].iter().enumerate();
        let nearest = sheets.max_by(|a, b| {
            let (da, db) = (a.1.inward.dot(offset), b.1.inward.dot(offset));
            da.total_cmp(&db).then(b.0.cmp(&a.0))
        });
        nearest.map(|(index, _)| index)
    }
}

/// The nearest place on a network's lines of each point near enough to one to show its sheets.
#[must_use]
pub fn beside_lines(network: &Network, sites: &Sites) -> Vec<Option<Beside>> {
    beside_within(network, sites, |n| depth(sites, n))
}

/// The same of each point that has one within its reach, model units.
fn beside_within(
    network: &Network,
    sites: &Sites,
    reach: impl Fn(usize) -> f64 + Sync,
) -> Vec<Option<Beside>> {
    let ends = (0..network.segments.len() as u32).map(|segment| network.ends(segment)).collect();
    let grid = SegmentGrid::new(ends);
    let beside = |n: usize| {
        let point = sites.positions[n].as_dvec3();
        let near = grid.nearest(point, reach(n))?;
        Some(beside(network, near.segment, point))
    };
    (0..sites.positions.len()).into_par_iter().map(beside).collect()
}

/// The sheets that meet at each segment of a network, in the order of their angle, as the points beside some segments
/// tell them.
#[must_use]
pub fn sheets_of(
    network: &Network,
    sites: &Sites,
    beside: &[Option<Beside>],
    tells: impl Fn(u32) -> bool,
) -> Vec<Vec<Sheet>> {
    let votes = |(n, beside): (usize, &Option<Beside>)| {
        let beside = beside.as_ref().filter(|beside| !beside.at_end && tells(beside.segment))?;
        let away = beside.offset.length();
        let near = away > too_near(sites, n) && away <= depth(sites, n);
        (near && !passes_by(sites, n, beside)).then_some((beside.segment, n as u32))
    };
    let voters =
        Rows::from_pairs(network.segments.len(), beside.iter().enumerate().filter_map(votes).collect());
    let segments = (0..network.segments.len() as u32).into_par_iter();
    segments.map(|segment| sheets(network, sites, beside, &voters, segment)).collect()
}

/// Within how far of a line points show its sheets, model units.
fn depth(sites: &Sites, point: usize) -> f64 {
    too_near(sites, point) + DEPTH * f64::from(sites.spacing[point])
}

/// Whether a point beside a line is of a surface that passes by it, such as the other side of a thin wall: it lies
/// well off the line, and its tangent plane leads past that.
fn passes_by(sites: &Sites, point: usize, beside: &Beside) -> bool {
    let away = beside.offset.length();
    let height = beside.offset.dot(sites.normals[point].as_dvec3()).abs();
    away > BY * depth(sites, point) && height > PAST * away
}

/// Whether a point beside a line lies in the direction of none of the sheets there.
fn is_off(sheets: &[Sheet], beside: &Beside) -> bool {
    let way = beside.offset.normalize_or_zero();
    sheets.iter().all(|sheet| sheet.inward.dot(way) < OFF)
}

/// Within how far of a line a point has no direction from it, model units.
#[must_use]
pub fn too_near(sites: &Sites, point: usize) -> f64 {
    let spacing = f64::from(sites.spacing[point]);
    (TOO_NEAR * spacing).max(ABOVE_NOISE * sites.noise.min(NOISIEST * spacing))
}

fn beside(network: &Network, segment: u32, point: DVec3) -> Beside {
    let [a, b] = network.ends(segment);
    let place = nearest_on(a, b, point);
    let offset = point - place;
    let reach = AT_END * offset.length();
    let at_end =
        network.segments[segment as usize].iter().any(|&node| ends(network, segment, node, place, reach));
    Beside { segment, offset, at_end }
}

/// Whether a line ends or turns sharply within `reach` of a place on one of its segments, beyond a node of that.
/// One that others run into goes on.
fn ends(network: &Network, segment: u32, node: u32, place: DVec3, reach: f64) -> bool {
    let mut passed = 0;
    for (_, node) in network.through(segment, node).take(WINDOW) {
        if network.nodes[node as usize].as_dvec3().distance(place) > reach {
            return false;
        }
        passed += 1;
    }
    passed < WINDOW
}

/// The segments that carry one on in both directions, itself first.
pub(super) fn window(network: &Network, segment: u32) -> Vec<u32> {
    let along = network.along(segment);
    let mut found = vec![segment];
    for start in network.segments[segment as usize] {
        for (at, _) in network.onward(segment, start).skip(1).take(WINDOW) {
            if found.contains(&at) || network.along(at).dot(along).abs() < ALIGNED {
                break;
            }
            found.push(at);
        }
    }
    found
}

/// Whether some of the sheets of a segment meet sharply.
fn meet_sharply(sheets: &[Sheet]) -> bool {
    let with_before = |(n, sheet): (usize, &Sheet)| {
        sheets[..n].iter().any(|before| before.inward.dot(sheet.inward) > SHARP)
    };
    sheets.iter().enumerate().any(with_before)
}

/// Groups the points around a segment by their direction from it.
fn sheets(
    network: &Network,
    sites: &Sites,
    beside: &[Option<Beside>],
    voters: &Rows,
    segment: u32,
) -> Vec<Sheet> {
    let along = network.along(segment);
    let (right, up) = along.any_orthonormal_pair();
    let mut votes: Vec<angles::Vote> = window(network, segment)
        .into_iter()
        .flat_map(|near| voters.row(near).iter().copied())
        .filter_map(|point| {
            let offset = beside[point as usize].as_ref()?.offset;
            Some((libm::atan2(offset.dot(up), offset.dot(right)), point))
        })
        .collect();
    votes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    angles::sheets(&votes)
        .into_iter()
        .filter_map(|points| sheet(network, sites, beside, segment, points))
        .collect()
}

/// Sorts points by how near they are to the middle of a segment.
pub(super) fn nearest_first(network: &Network, sites: &Sites, segment: u32, points: &mut [u32]) {
    let [a, b] = network.ends(segment);
    let middle = 0.5 * (a + b);
    let distance = |point: u32| sites.positions[point as usize].as_dvec3().distance_squared(middle);
    points.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
}

/// The sheet that some points show.
fn sheet(
    network: &Network,
    sites: &Sites,
    beside: &[Option<Beside>],
    segment: u32,
    mut points: Vec<u32>,
) -> Option<Sheet> {
    let along = network.along(segment);
    nearest_first(network, sites, segment, &mut points);
    let directions = points.iter().filter_map(|&point| beside[point as usize].as_ref());
    let sum: DVec3 = directions.map(|b| b.offset.reject_from_normalized(along).normalize_or_zero()).sum();
    let inward = sum.try_normalize()?;
    let mean: Vec3 = points.iter().map(|&point| sites.normals[point as usize]).sum();
    let normal = along.cross(inward).try_normalize()?;
    let normal = if normal.dot(mean.as_dvec3()) < 0.0 { -normal } else { normal };
    Some(Sheet { inward, normal, points })
}
