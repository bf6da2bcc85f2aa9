//! Where borders of one sheet end and begin again a little farther along the lines: its points there are too few or lie
//! too near to the lines to show it, as in the tip of a wedge between two lines.

use std::collections::BTreeSet;

use glam::DVec3;

use super::{AGREE, LineCut};
use crate::analyse::cloud_graph::Sites;
use crate::analyse::line_network::CROWD;
use crate::analyse::line_sheets::{SEPARATE, Sheet, WINDOW, nearest_first};

/// Segments that are looked at from where a border ends, at most: a gap has no more than [`WINDOW`], and at corners a
/// few lines each way are followed; in a thicket of lines the work at each end stays bounded.
const MOST_STEPS: usize = 64;

/// A segment on the way from where a border ends.
#[derive(Clone, Copy, Debug)]
struct Step {
    segment: u32,
    /// The node that it leads to.
    to: u32,
    /// The way it runs, with the sheet on the left.
    along: DVec3,
    /// The step before it, but for the first.
    before: Option<usize>,
    /// How many there are up to this.
    count: usize,
}

impl LineCut {
    /// What is lacking of sheets between borders that end and those that begin within a few segments, by segment.
    pub(super) fn gaps(&self, sites: &Sites) -> Vec<(u32, Sheet)> {
        let (ending, mut beginning) = self.loose();
        let mut lacking = Vec::new();
        for from in ending {
            let Some((steps, to)) = self.gap(from, &beginning) else { continue };
            beginning.remove(&to);
            let sheets = [from, to.1].map(|border| self.sheet(&self.borders[border as usize]));
            let between = |step: &Step| (step.segment, self.between(sites, step, sheets));
            lacking.extend(steps.iter().map(between));
        }
        lacking
    }

    /// The borders that end and those that begin where no other of their sheet goes on, the latter with their nodes.
    pub(super) fn loose(&self) -> (Vec<u32>, BTreeSet<(u32, u32)>) {
        let mut linked = [vec![false; self.points.len()], vec![false; self.points.len()]];
        for border in &self.borders {
            linked[0][border.points[0] as usize] = true;
            linked[1][border.points[1] as usize] = true;
        }
        let all = || 0..self.borders.len() as u32;
        let point = |border: u32, end: usize| self.borders[border as usize].points[end] as usize;
        let ending = all().filter(|&border| !linked[0][point(border, 1)]);
        let beginning = all().filter(|&border| !linked[1][point(border, 0)]);
        let beginning = beginning.map(|border| (self.borders[border as usize].ends[0], border));
        (ending.collect(), beginning.collect())
    }

    /// The shortest way along lines that lack the sheet from where a border ends to where another of them begins.
    fn gap(&self, from: u32, beginning: &BTreeSet<(u32, u32)>) -> Option<(Vec<Step>, (u32, u32))> {
        let border = &self.borders[from as usize];
        let normal = self.sheet(border).normal;
        let mut steps = Vec::new();
        self.step_on(&mut steps, None, [border.segment, border.ends[1]], normal);
        let mut at = 0;
        while at < steps.len().min(MOST_STEPS) {
            let Step { segment, to, count, .. } = steps[at];
            let goes_on = |&&(_, other): &&(u32, u32)| {
                let other = &self.borders[other as usize];
                other.segment != segment && self.sheet(other).normal.dot(normal) >= AGREE
            };
            if let Some(&next) = beginning.range((to, 0)..=(to, u32::MAX)).find(goes_on) {
                let back = std::iter::successors(Some(at), |&at| steps[at].before);
                return Some((back.map(|at| steps[at]).collect(), next));
            }
            if count < WINDOW {
                self.step_on(&mut steps, Some(at), [segment, to], normal);
            }
            at += 1;
        }
        None
    }

    /// Adds the segments beyond a segment's node that lack a sheet.
    fn step_on(
        &self,
        steps: &mut Vec<Step>,
        before: Option<usize>,
        [segment, node]: [u32; 2],
        normal: DVec3,
    ) {
        let around = self.network.at_node.row(node);
        if around.len() > CROWD {
            return;
        }
        let count = before.map_or(0, |before| steps[before].count) + 1;
        for &next in around.iter().filter(|&&next| next != segment) {
            let along = self.network.along_from(next, node);
            let is_new = steps.iter().all(|step| step.segment != next);
            if is_new && self.lacks(next, normal.cross(along).normalize_or_zero()) {
                steps.push(Step { segment: next, to: self.network.across(next, node), along, before, count });
            }
        }
    }

    fn lacks(&self, segment: u32, inward: DVec3) -> bool {
        lack(&self.sheets.of[segment as usize], inward)
    }

    /// The sheet at a segment between two where it shows.
    fn between(&self, sites: &Sites, step: &Step, sheets: [&Sheet; 2]) -> Sheet {
        let sum = sheets[0].normal + sheets[1].normal;
        let normal = sum.reject_from_normalized(step.along).normalize_or(sheets[0].normal);
        let mut points = [sheets[0].points.as_slice(), sheets[1].points.as_slice()].concat();
        points.sort_unstable();
        points.dedup();
        nearest_first(&self.network, sites, step.segment, &mut points);
        Sheet { inward: normal.cross(step.along), normal, points }
    }
}

/// Whether none of some sheets lies in a direction, or so near to that that it would be taken for the sheet there.
pub(super) fn lack(sheets: &[Sheet], inward: DVec3) -> bool {
    sheets.iter().all(|sheet| sheet.inward.dot(inward) <= libm::cos(SEPARATE))
}
