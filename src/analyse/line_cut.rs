//! Cuts a cloud open along feature lines, so that each sheet has borders of its own.
//!
//! Each sheet of each segment gives one directed border with the sheet on its left. Where
//! borders meet they are linked as the sheet goes on from one to the next, round corners too;
//! linked ends are one point, unlinked ends points of their own.

mod gaps;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_graph::{Joined, Sites};
use super::line_network::Network;
use super::line_sheets::{Sheet, Sheets, too_near};
use super::nearest::listed;
use super::orient::Across;
use super::segment_grid::SegmentGrid;
use super::strips::put_among;
use super::surface::NONE;
use crate::model::discs::End;
use crate::model::polyline::nearest_on;

/// Borders are linked where their sheets' normals agree by at least this cosine (60°).
const AGREE: f64 = 0.5;

/// Points of a sheet that are joined to a segment's border whatever their distance, so that
/// no border hangs loose.
const JOINED: usize = 4;

/// An estimated normal that agrees less than this (cosine of 25°) with the sheet beside whose border its point
/// lies is of points of several sheets.
const MIXED: f32 = 0.906;

/// One that agrees less than this (cosine of 10°) may be, as beside a corner, or the sheet bends: the more of the
/// neighbours lie in the one plane or the other tell. Were all such taken for mixed, the thread of abc-00000049, of
/// 500,000 points, would show beside its outline.
const DOUBTFUL: f32 = 0.985;

/// The way from a corner to a point of a sheet around it leaves the sheet's plane by less than this sine (11°):
/// the sheet may bend a little, and other sheets of a corner turn away by more.
const AT_CORNER: f64 = 0.2;

/// The way to a neighbour in a plane leaves it by less than this sine (6°), well below what is doubtful.
const IN_PLANE: f32 = 0.1;

/// Points this many spacings from a line are joined to its border.
const BESIDE: f64 = 1.5;

/// The way from a point to a line that ends its sheet leaves the point's plane by less than this sine (45°).
const ALONG: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Lines are looked for this many spacings beyond what a disc may reach, so that whoever fits the points
/// around knows which are of the same sheet.
const SEEN: f32 = 1.0;

/// How far beyond its ends, in shares of its length or that of the next, a segment still parts sheets: a little
/// where the line goes on, so that nothing slips between two segments; not quite to the end where it does not,
/// since what lies there belongs to a third sheet.
const PARTS: (f64, f64) = (0.25, -0.1);

/// A border of one sheet along one segment.
#[derive(Clone, Copy, Debug)]
struct Border {
    segment: u32,
    sheet: usize,
    /// The nodes it runs from and to.
    ends: [u32; 2],
    /// Its points at those nodes.
    points: [u32; 2],
}

/// A cloud's feature lines with the sheets on all sides.
#[derive(Clone, Debug)]
pub struct LineCut {
    network: Network,
    /// Its segments.
    grid: SegmentGrid,
    sheets: Sheets,
    borders: Vec<Border>,
    /// For each segment, where its borders begin among all.
    first_border: Vec<u32>,
    /// Points on the lines, each of one sheet.
    pub points: Vec<LinePoint>,
}

/// A point on a line, of one of the sheets there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePoint {
    /// Its node: points of one node lie at one place.
    pub node: u32,
    /// Position, model units.
    pub position: Vec3,
    /// Unit normal of the sheet.
    pub normal: Vec3,
    /// A point of the cloud on the same sheet.
    pub like: u32,
}

impl LineCut {
    /// Finds the sheets along a network and their borders.
    #[must_use]
    pub fn new(network: Network, sites: &Sites) -> Self {
        let sheets = Sheets::find(&network, sites);
        let cut = Self::of(network, sheets);
        let gaps = cut.gaps(sites);
        if gaps.is_empty() { cut } else { cut.with(gaps) }
    }

    /// The same with more sheets at some segments.
    fn with(self, more: Vec<(u32, Sheet)>) -> Self {
        let Self { network, mut sheets, .. } = self;
        for (segment, sheet) in more {
            let own = &mut sheets.of[segment as usize];
            // Two gaps may be of one sheet.
            if gaps::lack(own, sheet.inward) {
                put_among(own, network.along(segment), sheet);
            }
        }
        Self::of(network, sheets)
    }

    /// The borders of sheets along a network.
    fn of(network: Network, sheets: Sheets) -> Self {
        let (mut borders, mut first_border) = (Vec::new(), Vec::new());
        for (segment, found) in (0_u32..).zip(&sheets.of) {
            first_border.push(borders.len() as u32);
            for (sheet, Sheet { inward, normal, .. }) in found.iter().enumerate() {
                let [a, b] = network.segments[segment as usize];
                // With the sheet on the left, normal × along looks into it.
                let forward = inward.cross(*normal).dot(network.along(segment)) > 0.0;
                let ends = if forward { [a, b] } else { [b, a] };
                borders.push(Border { segment, sheet, ends, points: [NONE; 2] });
            }
        }
        let segments = (0..network.segments.len() as u32).map(|segment| network.ends(segment));
        let grid = SegmentGrid::new(segments.collect());
        let mut cut = Self { network, grid, sheets, borders, first_border, points: Vec::new() };
        cut.link();
        cut
    }

    /// The same lines, with the sheets as the normals are now.
    #[must_use]
    pub fn again(self, sites: &Sites) -> Self {
        Self::new(self.network, sites)
    }

    /// Pairs of points on the two sheets of a segment, and whether their normals look to opposite sides.
    #[must_use]
    pub fn across(&self, sites: &Sites) -> Vec<Across> {
        let mut pairs = Vec::new();
        for (segment, sheets) in (0_u32..).zip(&self.sheets.of) {
            let [a, b] = sheets.as_slice() else { continue };
            let along = self.network.along(segment);
            // Round the line from the one sheet into the other, through what both bound.
            let facing = [along.cross(a.inward), b.inward.cross(along)];
            for points in a.points.iter().zip(&b.points).take(JOINED).map(|(&a, &b)| [a, b]) {
                let looks = |n: usize| sites.normals[points[n] as usize].as_dvec3().dot(facing[n]) < 0.0;
                pairs.push(Across { points, opposite: looks(0) != looks(1) });
            }
        }
        pairs
    }

    fn sheet(&self, border: &Border) -> &Sheet {
        &self.sheets.of[border.segment as usize][border.sheet]
    }

    /// The direction a border runs in.
    fn direction(&self, border: &Border) -> DVec3 {
        let along = self.network.along(border.segment);
        if border.ends[0] < border.ends[1] { along } else { -along }
    }

    /// Links borders at their ends and gives all ends points.
    fn link(&mut self) {
        let mut ends: Vec<(u32, bool, u32)> = Vec::with_capacity(2 * self.borders.len());
        for (border, index) in self.borders.iter().zip(0_u32..) {
            ends.extend([(border.ends[0], true, index), (border.ends[1], false, index)]);
        }
        ends.sort_unstable();
        for at_node in ends.chunk_by(|a, b| a.0 == b.0) {
            let split = at_node.partition_point(|end| !end.1);
            let (arriving, leaving) = at_node.split_at(split);
            let mut pairs = Vec::new();
            for arrive in arriving {
                let turns = leaving
                    .iter()
                    .filter_map(|leave| Some((self.turn(arrive.2, leave.2)?, arrive.2, leave.2)));
                pairs.extend(turns);
            }
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
            for (_, arrive, leave) in pairs {
                if self.borders[arrive as usize].points[1] == NONE
                    && self.borders[leave as usize].points[0] == NONE
                {
                    let point = self.add_point(at_node[0].0, &[arrive, leave]);
                    self.borders[arrive as usize].points[1] = point;
                    self.borders[leave as usize].points[0] = point;
                }
            }
        }
        for index in 0..self.borders.len() as u32 {
            for end in 0..2 {
                if self.borders[index as usize].points[end] == NONE {
                    let point = self.add_point(self.borders[index as usize].ends[end], &[index]);
                    self.borders[index as usize].points[end] = point;
                }
            }
        }
    }

    fn add_point(&mut self, node: u32, borders: &[u32]) -> u32 {
        let sheets = || borders.iter().map(|&border| self.sheet(&self.borders[border as usize]));
        let normal: DVec3 = sheets().map(|sheet| sheet.normal).sum();
        let like = sheets().find_map(|sheet| sheet.points.first().copied()).unwrap_or(0);
        let position = self.network.nodes[node as usize];
        let normal = normal.normalize_or(DVec3::Z).as_vec3();
        self.points.push(LinePoint { node, position, normal, like });
        self.points.len() as u32 - 1
    }

    /// How far the sheet on the left turns, clockwise, from a border that arrives at a node
    /// to one that leaves it; `None` where the sheets' normals disagree.
    ///
    /// Of all borders that leave, the sheet's next one turns least. A border that leaves
    /// along the line it came by turns all the way round.
    fn turn(&self, arrive: u32, leave: u32) -> Option<f64> {
        let (arrive, leave) = (&self.borders[arrive as usize], &self.borders[leave as usize]);
        let (from, to) = (self.sheet(arrive).normal, self.sheet(leave).normal);
        if from.dot(to) < AGREE {
            return None;
        }
        let normal = (from + to).normalize();
        let back = (-self.direction(arrive)).reject_from_normalized(normal);
        let onward = self.direction(leave).reject_from_normalized(normal);
        let left = libm::atan2(back.cross(onward).dot(normal), back.dot(onward));
        // Rounding must not make a full turn of none, nor none of a full turn.
        let none = arrive.segment == leave.segment || left.abs() < 1e-6;
        Some(if none { std::f64::consts::TAU } else { (-left).rem_euclid(std::f64::consts::TAU) })
    }

    /// Whether a point of the cloud lies beside a line.
    #[must_use]
    pub fn is_beside(&self, point: u32) -> bool {
        self.sheets.beside[point as usize].is_some()
    }

    /// Whether a point of the cloud lies too near to a line to have a direction from it.
    #[must_use]
    pub fn is_on(&self, sites: &Sites, point: u32) -> bool {
        let beside = self.sheets.beside[point as usize].as_ref();
        beside.is_some_and(|beside| beside.offset.length() <= too_near(sites, point as usize))
    }

    /// Whether the straight way between two points of the cloud crosses from sheet to sheet.
    #[must_use]
    pub fn parts(&self, sites: &Sites, a: u32, b: u32) -> bool {
        let beside = |n: u32| self.sheets.beside[n as usize].as_ref().map(|beside| beside.segment);
        let own = [a, b].map(beside);
        if own == [None; 2] {
            return false;
        }
        let points = [a, b].map(|n| sites.positions[n as usize].as_dvec3());
        let length = points[0].distance(points[1]);
        let mut near = Vec::new();
        for (own, point) in own.into_iter().zip(points) {
            near.extend(own.filter(|own| !near.contains(own)));
            self.network.follow(&mut near, point, length);
        }
        near.into_iter().any(|segment| self.segment_parts(segment, points))
    }

    fn segment_parts(&self, segment: u32, [p, q]: [DVec3; 2]) -> bool {
        let side = |point: DVec3| self.sheets.toward(&self.network, segment, point);
        if self.sheets.of[segment as usize].len() < 2 || side(p) == side(q) {
            return false;
        }
        let [a, b] = self.network.ends(segment);
        let (along, length) = (self.network.along(segment), a.distance(b));
        let place = |point: DVec3| {
            let along = (point - a).dot(along);
            (along / length, (point - a).length_squared() - along * along)
        };
        let ((tp, rp), (tq, rq)) = (place(p), place(q));
        let (rp, rq) = (rp.max(0.0).sqrt(), rq.max(0.0).sqrt());
        // Where the way passes the line: nearer to the place of the nearer point.
        let at = if rp + rq > 0.0 { (tp * rq + tq * rp) / (rp + rq) } else { 0.5 * (tp + tq) };
        let beyond = |end: usize| {
            let next = self.network.beyond(segment, self.network.segments[segment as usize][end]);
            if next == NONE { PARTS.1 } else { PARTS.0 * (self.network.length(next) / length).min(1.0) }
        };
        at > -beyond(0) && at < 1.0 + beyond(1)
    }

    /// The border of its own sheet that runs beside a point of the cloud.
    fn border_beside(&self, sites: &Sites, point: u32) -> Option<&Border> {
        self.border_within(sites, point, BESIDE * f64::from(sites.spacing[point as usize]))
    }

    fn border_within(&self, sites: &Sites, point: u32, reach: f64) -> Option<&Border> {
        let beside = self.sheets.beside[point as usize].as_ref()?;
        let position = sites.positions[point as usize].as_dvec3();
        let sheet = self.sheets.toward(&self.network, beside.segment, position)?;
        let border = self.first_border[beside.segment as usize] as usize + sheet;
        (beside.offset.length() <= reach && !beside.at_end).then(|| &self.borders[border])
    }

    /// The normal of a point, where it lies beside a border or a corner and its own mixes sheets: that of its sheet.
    #[must_use]
    pub fn mended(&self, sites: &Sites, point: u32, normal: Vec3) -> Vec3 {
        let beside = BESIDE * f64::from(sites.spacing[point as usize]);
        let reach = beside.max(too_near(sites, point as usize));
        let border = self.border_within(sites, point, reach).map(|border| self.sheet(border));
        let Some(sheet) = border.or_else(|| self.sheet_at_corner(sites, point, reach)) else { return normal };
        let (sheet, alike) = (sheet.normal.as_vec3(), sheet.normal.as_vec3().dot(normal));
        let is_mixed = || in_plane(sites, point, sheet) > in_plane(sites, point, normal);
        if alike < MIXED || alike < DOUBTFUL && is_mixed() { sheet } else { normal }
    }

    /// Of the sheets around the corner that is the nearest place of the lines to a point, within `reach`, the one
    /// in whose plane the point lies.
    fn sheet_at_corner(&self, sites: &Sites, point: u32, reach: f64) -> Option<&Sheet> {
        let beside = self.sheets.beside[point as usize].as_ref()?;
        if !beside.at_end || beside.offset.length() > reach {
            return None;
        }
        let from = |node: u32| {
            sites.positions[point as usize].as_dvec3() - self.network.nodes[node as usize].as_dvec3()
        };
        let [a, b] = self.network.segments[beside.segment as usize];
        let node = if from(b).length() < from(a).length() { b } else { a };
        let around = self.network.at_node.row(node);
        // Around the end of a line the surface turns from the one sheet into the other.
        if around.len() < 2 {
            return None;
        }
        let sheets = around.iter().flat_map(|&segment| &self.sheets.of[segment as usize]);
        let off = |sheet: &&Sheet| sheet.normal.dot(from(node)).abs();
        let sheet = sheets.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        (off(&sheet) <= AT_CORNER * from(node).length()).then_some(sheet)
    }

    /// Pairs of a point on a line and a point of the cloud that the surface joins.
    #[must_use]
    pub fn joins(&self, sites: &Sites) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        for border in &self.borders {
            let points = &self.sheet(border).points;
            let nearest = points.iter().take(JOINED);
            pairs.extend(nearest.flat_map(|&point| border.points.map(|end| (end, point))));
        }
        for point in 0..sites.positions.len() as u32 {
            if let Some(border) = self.border_beside(sites, point) {
                pairs.extend(border.points.map(|end| (end, point)));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Pairs of points on lines that follow each other, the sheet on the left.
    pub fn sides(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.borders.iter().map(|border| (border.points[0], border.points[1]))
    }

    /// For each of [`Self::sides`], whether it only carries a line on beyond its end.
    pub fn carried(&self) -> impl Iterator<Item = bool> + '_ {
        self.borders.iter().map(|border| self.network.is_carried(border.segment))
    }

    /// What ends the discs of points beside the lines: each point with a piece of line, in the order of the
    /// points. `joined` tells how far these stand for the surface.
    ///
    /// A segment ends the disc of a point that lies on one of its sheets: whose normal agrees with that
    /// sheet's, and whose plane the segment is near.
    #[must_use]
    pub fn ends(&self, sites: &Sites, joined: &[Joined]) -> Vec<(u32, End)> {
        let points = (0..sites.positions.len() as u32).into_par_iter();
        let ends = points.flat_map_iter(|point| {
            let reach = sites.spacing[point as usize].mul_add(SEEN, 2.0 * joined[point as usize].margin);
            self.ends_within(sites, point, f64::from(reach)).into_iter().map(move |end| (point, end))
        });
        ends.collect()
    }

    /// What ends the disc of a point within a distance from it, model units.
    #[must_use]
    pub fn ends_within(&self, sites: &Sites, point: u32, reach: f64) -> Vec<End> {
        if !self.is_beside(point) {
            return Vec::new();
        }
        let near = self.grid.within(sites.positions[point as usize].as_dvec3(), reach);
        near.into_iter().filter_map(|segment| self.end(sites, point, segment)).collect()
    }

    /// What a segment ends the disc of a point with, if it does.
    fn end(&self, sites: &Sites, point: u32, segment: u32) -> Option<End> {
        let center = sites.positions[point as usize].as_dvec3();
        let normal = sites.normals[point as usize].as_dvec3();
        let sheet = &self.sheets.of[segment as usize][self.sheets.toward(&self.network, segment, center)?];
        let ends = self.network.ends(segment);
        let way = nearest_on(ends[0], ends[1], center) - center;
        if sheet.normal.dot(normal) < AGREE || way.dot(normal).abs() > ALONG * way.length() {
            return None;
        }
        let flat = ends.map(|end| end - (end - center).dot(normal) * normal);
        let across = normal.cross(flat[1] - flat[0]).try_normalize()?;
        let inward = if across.dot(sheet.inward) < 0.0 { -across } else { across };
        Some(End { ends: flat.map(|end| end.as_vec3()), inward: inward.as_vec3() })
    }

    /// How many segments some sheet ends at, and their length, model units.
    #[must_use]
    pub fn found(&self) -> (usize, f64) {
        let lines = (0_u32..).zip(&self.sheets.of).filter(|&(segment, _)| !self.network.is_carried(segment));
        let found = lines.filter(|(_, sheets)| !sheets.is_empty());
        let lengths = found.map(|(segment, _)| self.network.length(segment));
        lengths.fold((0, 0.0), |(count, sum), length| (count + 1, sum + length))
    }
}

/// How many of its neighbours lie in the plane through a point.
fn in_plane(sites: &Sites, point: u32, normal: Vec3) -> usize {
    let here = sites.positions[point as usize];
    let ways = listed(&sites.nearest[point as usize]).map(|other| sites.positions[other as usize] - here);
    ways.filter(|way| way.dot(normal).abs() <= IN_PLANE * way.length()).count()
}

#[cfg(test)]
mod tests;
