//! Faces between two feature lines that lie too close to each other for a cloud's points to show them.
//!
//! Lines that were drawn twice are made one before ([`super::doubled`]): such as still lie close bound a face of their own.
//! Its points lie too near to them, or are too few, to show which way it goes; the other line does.

use glam::DVec3;

use super::cloud_graph::Sites;
use super::doubled::PARALLEL;
use super::line_network::Network;
use super::line_sheets::{Beside, Sheet, nearest_first, window};
use super::segment_grid::SegmentGrid;
use super::surface::Rows;

/// Strips wider than this many spacings show themselves.
const WIDEST: f64 = 3.0;

/// A sheet that lies this way (cosine of 25°) is the strip.
const SAME: f64 = 0.906;

/// The way to a line that runs beside leads across by at least this share (sine of 60°): else that only carries on.
const BESIDE: f64 = 0.866;

/// Points of the strip leave it by less than this tangent (27°).
const ALONG: f64 = 0.5;

/// What bounds strips.
pub(super) struct Strips<'a> {
    network: &'a Network,
    sites: &'a Sites<'a>,
    beside: &'a [Option<Beside>],
    grid: SegmentGrid,
    /// The strand of each segment.
    strand: Vec<u32>,
    /// The points beside each.
    points: Rows,
}

impl<'a> Strips<'a> {
    pub(super) fn new(network: &'a Network, sites: &'a Sites<'a>, beside: &'a [Option<Beside>]) -> Self {
        let mut strand = vec![0; network.segments.len()];
        for (own, number) in network.strands().iter().zip(0..) {
            own.segments.iter().for_each(|&segment| strand[segment as usize] = number);
        }
        let by = |(n, beside): (usize, &Option<Beside>)| Some((beside.as_ref()?.segment, n as u32));
        let pairs = beside.iter().enumerate().filter_map(by).collect();
        let points = Rows::from_pairs(network.segments.len(), pairs);
        Self { network, sites, beside, grid: network.grid(), strand, points }
    }

    /// The strip that a segment bounds, if none of its sheets is that.
    pub(super) fn beyond(&self, segment: u32, sheets: &[Sheet]) -> Option<Sheet> {
        let [a, b] = self.network.ends(segment);
        let (middle, along) = (0.5 * (a + b), self.network.along(segment));
        let own = self.strand[segment as usize];
        let beside = |other: u32| {
            self.strand[other as usize] != own && self.network.along(other).dot(along).abs() > PARALLEL
        };
        let around = self.around(segment);
        let near = self.grid.nearest_of(middle, WIDEST * self.spacing(&around), beside)?;
        let way = near.point - middle;
        let across = way.reject_from_normalized(along);
        let inward = across.try_normalize()?;
        let is_beside = across.length() >= BESIDE * way.length();
        if !is_beside || sheets.iter().any(|sheet| sheet.inward.dot(inward) > SAME) {
            return None;
        }
        // The surface goes on from another sheet into the strip.
        let from = sheets.first()?;
        let side = along.cross(from.inward).dot(from.normal);
        let normal = -side.signum() * along.cross(inward);
        let is_on = |&point: &u32| {
            let way = self.beside[point as usize].as_ref().map_or(DVec3::ZERO, |beside| beside.offset);
            way.dot(normal).abs() < ALONG * way.dot(inward)
        };
        let points: Vec<u32> = around.into_iter().filter(is_on).collect();
        // None may lie between the rims of a slot.
        (!points.is_empty()).then_some(Sheet { inward, normal, points })
    }

    /// The points beside a segment and those that carry it on, the nearest to its middle first.
    fn around(&self, segment: u32) -> Vec<u32> {
        let near = window(self.network, segment).into_iter().flat_map(|near| self.points.row(near));
        let mut points: Vec<u32> = near.copied().collect();
        nearest_first(self.network, self.sites, segment, &mut points);
        points
    }

    /// The mean spacing of some points, model units; 0 of none.
    fn spacing(&self, points: &[u32]) -> f64 {
        let sum: f64 = points.iter().map(|&point| f64::from(self.sites.spacing[point as usize])).sum();
        sum / points.len().max(1) as f64
    }
}

/// Puts a sheet among those of a segment that runs a way, which stay in the order of their angle.
pub(super) fn put_among(sheets: &mut Vec<Sheet>, along: DVec3, sheet: Sheet) {
    let (right, up) = along.any_orthonormal_pair();
    let angle = |sheet: &Sheet| libm::atan2(sheet.inward.dot(up), sheet.inward.dot(right));
    sheets.push(sheet);
    sheets.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::analyse::line_sheets::Sheets;
    use crate::analyse::planted::{lay, random, side_by_side, spaced};

    #[test]
    fn a_face_narrower_than_its_points_show_is_told_by_its_lines() {
        // Along x a floor, a bevel of one and a half spacings and a wall; no point of the bevel lies farther from its lines
        // than a quarter of a spacing.
        let (step, half) = (0.02, 0.02);
        let bevel = DVec3::new(0.0, half, half).normalize();
        let place = |n: u64| {
            let (x, off) = (random(2 * n), 0.5 * (1.0 + random(2 * n + 1)));
            let bevelled = if n.is_multiple_of(2) {
                0.25 * step * off
            } else {
                2.0_f64.sqrt() * half - 0.25 * step * off
            };
            (match n % 40 {
                0 | 1 => DVec3::X * x + bevelled * bevel,
                n if n % 2 == 0 => DVec3::new(x, -0.3 * off, 0.0),
                _ => DVec3::new(x, half, half + 0.3 * off),
            })
            .as_vec3()
        };
        let positions: Vec<Vec3> = (0..3000).map(place).collect();
        let (search, nearest, spacing) = lay(&positions);
        let line = |at: DVec3| vec![at - 0.9 * DVec3::X, at + 0.9 * DVec3::X];
        let lines = [line(DVec3::ZERO), line(DVec3::new(0.0, half, half))];
        let network = Network::new(&lines, &spaced(&search, &positions, &spacing));
        let normals = vec![Vec3::new(0.0, -1.0, 1.0).normalize(); positions.len()];
        let sites = side_by_side(&positions, &normals, &nearest, &spacing);
        let sheets = Sheets::find(&network, &sites);
        let inner = (0..network.segments.len() as u32)
            .filter(|&segment| network.ends(segment).iter().all(|end| end.x.abs() < 0.7));
        let mut seen = 0;
        for segment in inner {
            let is_bevel = |sheet: &Sheet| {
                sheet.inward.dot(bevel).abs() > 0.95 && sheet.normal.dot(normals[0].as_dvec3()) > 0.95
            };
            let own = &sheets.of[segment as usize];
            assert!(own.len() == 2 && own.iter().any(is_bevel), "{segment}: {own:?}");
            seen += 1;
        }
        assert!(seen > 20);
    }
}
