//! `edge`: how well the clipped borders of the splats follow the feature lines.

use glam::DVec3;
use rayon::prelude::*;

use super::border::Kind;
use super::box_tree::BoxTree;
use super::covered::{AT_EDGE, Insides};
use super::measures::Distances;
use super::patch::Patch;
use super::spread::{self, Sample};
use crate::model::asset::Asset;
use crate::model::polyline::nearest_on;

/// Samples along the longer of lines and borders: as many as make steps far shorter than any
/// splat.
const MOST: usize = 100_000;

/// Borders are taken for chains of straight lines that leave them by at most this share of the
/// error bound.
const CHORD_SHARE: f64 = 0.01;

/// Error bounds within which a splat's clipped border touches a line.
const TOUCH: f64 = 2.0;

/// Lines that one piece of a border becomes, at most.
const MOST_CHORDS: f64 = 64.0;

type Line = [DVec3; 2];

/// The two-sided distance between feature lines and the splats' clipped borders, model units.
///
/// The borders are the parts of the clip curves that lie inside their splat's ellipse and are not
/// cut away by its other curves, of all splats that touch a line with any of them. Where such a part
/// runs through the inside of another splat, it bounds nothing that shows, as beyond the end of a
/// line, and is left out: well inside, or, farther from every line than splats may be cut, anywhere
/// inside. Samples lie equally spaced, at the same step, along the lines and along all borders; `rms` and `p99` are over both together. Each is compared with the nearest of
/// the other kind, wherever that lies: an edge that no splat is cut at is as far off as the next
/// border. Where nothing at all is cut, every sample of the lines is one diagonal off.
///
/// `None` where the lines have no length, so that there is nothing to follow, and where splats are
/// cut by clip partners, whose edges are no curves of a border.
#[must_use]
pub fn edge(asset: &Asset, lines: &[Vec<DVec3>]) -> Option<Distances> {
    if asset.splats.iter().any(|splat| !splat.partners.is_empty()) {
        return None;
    }
    let lines: Vec<Line> =
        lines.iter().flat_map(|line| line.windows(2)).map(|ends| [ends[0], ends[1]]).collect();
    let borders: Vec<Vec<Line>> =
        asset.splats.par_iter().map(|splat| borders(&Patch::new(splat), asset.max_error)).collect();
    let (borders, owners) = touching(borders, &lines, TOUCH * asset.max_error);
    let step = length(&lines).max(length(&borders)) / MOST as f64;
    let on_lines: Vec<DVec3> = spaced(&lines, step).into_iter().map(|(place, _)| place).collect();
    if on_lines.is_empty() {
        return None;
    }
    let mut samples: Vec<(DVec3, Sample)> =
        on_lines.iter().copied().zip(one_sided(&on_lines, &borders, asset.diagonal)).collect();
    let (bordering, owners): (Vec<DVec3>, Vec<u32>) =
        spaced(&borders, step).into_iter().map(|(place, border)| (place, owners[border])).unzip();
    let off = one_sided(&bordering, &lines, asset.diagonal);
    let insides = Insides::new(asset);
    let shows = |((sample, &place), &own): ((Sample, &DVec3), &u32)| {
        let at_edge = sample.0 <= AT_EDGE * asset.max_error;
        (!insides.hold(place, own, at_edge)).then_some((place, sample))
    };
    samples.par_extend(off.into_par_iter().zip(&bordering).zip(&owners).filter_map(shows));
    Some(spread::placed(&samples, None))
}

/// The borders of those splats whose own come this close to a line, and whose each is.
fn touching(borders: Vec<Vec<Line>>, lines: &[Line], reach: f64) -> (Vec<Line>, Vec<u32>) {
    let tree = tree(lines);
    let near = |place: &DVec3| {
        tree.nearest(*place, reach, |line, _| Some((distance(lines[line as usize], *place), ()))).is_some()
    };
    let touches = |borders: &Vec<Line>| spaced(borders, reach).iter().any(|(place, _)| near(place));
    let splats = (0..borders.len() as u32).into_par_iter().zip(borders);
    let touching = splats.filter(|(_, borders)| touches(borders));
    touching.flat_map_iter(|(splat, borders)| borders.into_iter().map(move |line| (line, splat))).unzip()
}

/// The clipped borders of a patch as straight lines.
fn borders(patch: &Patch<'_>, max_error: f64) -> Vec<Line> {
    let clipped = patch.border.iter().filter(|segment| segment.kind == Kind::Clip);
    let chords = clipped.flat_map(|segment| {
        // The deviation falls with the square of the number of chords.
        let count = libm::sqrt(segment.reach / (CHORD_SHARE * max_error)).ceil().clamp(1.0, MOST_CHORDS);
        let at = move |n: usize| {
            let local = segment.lifted(patch.splat.curvature, n as f64 / count).0;
            patch.splat.to_model(local)
        };
        (0..count as usize).map(move |n| [at(n), at(n + 1)])
    });
    chords.collect()
}

fn length(lines: &[Line]) -> f64 {
    lines.iter().map(|[a, b]| a.distance(*b)).sum()
}

/// Places at equal steps along lines, laid end to end, each with the line it is on; at least one if
/// they have any length.
fn spaced(lines: &[Line], step: f64) -> Vec<(DVec3, usize)> {
    let total = length(lines);
    if total.is_nan() || total <= 0.0 {
        return Vec::new();
    }
    let count = ((total / step).round() as usize).clamp(1, MOST);
    let place = |n: usize| (n as f64 + 0.5) / count as f64 * total;
    let (mut places, mut before) = (Vec::with_capacity(count), 0.0);
    for (line, &[a, b]) in lines.iter().enumerate() {
        let along = a.distance(b);
        while places.len() < count && place(places.len()) <= before + along && along > 0.0 {
            places.push((a.lerp(b, (place(places.len()) - before) / along), line));
        }
        before += along;
    }
    places
}

/// Distances from places to the nearest line, `far` where there is none.
fn one_sided(places: &[DVec3], lines: &[Line], far: f64) -> Vec<Sample> {
    let tree = tree(lines);
    let sample = |&place: &DVec3| {
        let to = |line: u32, _: f64| Some((distance(lines[line as usize], place), ()));
        (tree.nearest(place, f64::INFINITY, to).map_or(far, |found| found.distance), 1.0)
    };
    places.par_iter().map(sample).collect()
}

fn tree(lines: &[Line]) -> BoxTree {
    BoxTree::new(lines.iter().map(|[a, b]| Some((a.min(*b), a.max(*b)))))
}

fn distance([a, b]: Line, place: DVec3) -> f64 {
    nearest_on(a, b, place).distance(place)
}

#[cfg(test)]
#[path = "edge_tests.rs"]
mod tests;
