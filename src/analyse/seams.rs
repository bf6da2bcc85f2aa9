//! Feature lines that run along a smooth surface: the seams of a modeller's patches, which part nothing.

use glam::DVec3;

use super::cloud_graph::Sites;
use super::given_lines::{SHARP_DEGREES, SMOOTH_DEGREES};
use super::line_network::{Network, Strand};
use super::line_sheets::{Beside, Sheet, beside_lines, sheets_of};
use super::segment_grid::SegmentGrid;

/// The share of a seam's segments that may look sharp: here and there points lie oddly.
const ODD: f64 = 0.1;

/// Noise turns the sheets of a segment by up to so many standard deviations.
const SURE: f64 = 2.0;

/// Given lines lie within this many lengths of the network's longest segment of what became of them.
const NEAR: f64 = 2.0;

/// The segments of a network that lie on seams, ascending: lines with a sheet on either side, which turn from one to
/// the other by no more than those of meshes may, on the median and nearly everywhere, noise aside.
#[must_use]
pub fn seams(network: &Network, sites: &Sites) -> Vec<u32> {
    let beside = beside_lines(network, sites);
    let reach = reaches(network, &beside);
    let strands = network.strands();
    let middles: Vec<&[u32]> = strands.iter().map(|strand| middle(network, strand, &reach)).collect();
    let mut tells = vec![false; network.segments.len()];
    middles.iter().flat_map(|middle| *middle).for_each(|&segment| tells[segment as usize] = true);
    let sheets = sheets_of(network, sites, &beside, |segment| tells[segment as usize]);
    let turns = |segment: &u32| turn(&sheets[*segment as usize], sites, &beside);
    let smooth = |middle: &[u32]| is_smooth(middle.iter().map(turns).collect());
    let seams = strands.iter().zip(middles).filter(|(_, middle)| smooth(middle));
    let mut segments: Vec<u32> = seams.flat_map(|(strand, _)| strand.segments.iter().copied()).collect();
    segments.sort_unstable();
    segments
}

/// How far from each segment points lie that are nearest to it, model units.
fn reaches(network: &Network, beside: &[Option<Beside>]) -> Vec<f64> {
    let mut reaches = vec![0.0; network.segments.len()];
    for beside in beside.iter().flatten() {
        let reach: &mut f64 = &mut reaches[beside.segment as usize];
        *reach = reach.max(beside.offset.length());
    }
    reaches
}

/// The segments of a strand that are farther from its ends than points beside it may be: there others that meet it
/// have sheets, too.
fn middle<'a>(network: &Network, strand: &'a Strand, reaches: &[f64]) -> &'a [u32] {
    let segments = strand.segments.as_slice();
    if strand.closed {
        return segments;
    }
    let reach = segments.iter().map(|&segment| reaches[segment as usize]).fold(0.0, f64::max);
    let beyond = |segments: &mut dyn Iterator<Item = &u32>| {
        let mut passed = 0.0;
        let near = segments.take_while(|&&segment| {
            passed += network.length(segment);
            passed < reach
        });
        near.count() + 1
    };
    let (from, short) = (beyond(&mut segments.iter()), beyond(&mut segments.iter().rev()));
    segments.get(from..segments.len().saturating_sub(short)).unwrap_or_default()
}

/// By how much two sheets turn at a segment more than noise alone may show, degrees; [`f64::MAX`] where they are not
/// two.
fn turn(sheets: &[Sheet], sites: &Sites, beside: &[Option<Beside>]) -> f64 {
    let [a, b] = sheets else { return f64::MAX };
    let turn = libm::acos((-a.inward.dot(b.inward)).clamp(-1.0, 1.0));
    // Of the mean of ways that lead to points, each noisy across the way.
    let variance = |sheet: &Sheet| {
        let offsets = sheet.points.iter().filter_map(|&point| beside[point as usize].as_ref());
        let sum: f64 = offsets.map(|beside| (sites.noise / beside.offset.length()).powi(2)).sum();
        sum / (sheet.points.len() as f64).powi(2)
    };
    (turn - SURE * (variance(a) + variance(b)).sqrt()).to_degrees()
}

/// Whether a line turns by so little at its segments.
fn is_smooth(mut turns: Vec<f64>) -> bool {
    turns.sort_by(f64::total_cmp);
    let at = |share: f64| turns.get((share * turns.len() as f64) as usize);
    at(0.5).is_some_and(|turn| *turn < SMOOTH_DEGREES)
        && at(1.0 - ODD).is_some_and(|turn| *turn < SHARP_DEGREES)
}

/// Lines (model units) less what became of the `seams` of a network.
#[must_use]
pub fn off_seams(lines: &[Vec<DVec3>], network: &Network, seams: &[u32]) -> Vec<Vec<DVec3>> {
    let segments: Vec<[DVec3; 2]> = (0..network.segments.len() as u32).map(|n| network.ends(n)).collect();
    let longest = segments.iter().map(|[a, b]| a.distance(*b)).fold(0.0, f64::max);
    let grid = SegmentGrid::new(segments);
    let is_seam = |a: DVec3, b: DVec3| {
        let nearest = grid.nearest(0.5 * (a + b), NEAR * longest);
        nearest.is_some_and(|nearest| seams.binary_search(&nearest.segment).is_ok())
    };
    // Runs of vertices whose sides lie on no seam.
    let runs = lines.iter().flat_map(|line| line.chunk_by(|&a, &b| !is_seam(a, b)));
    runs.filter(|run| run.len() > 1).map(<[DVec3]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::analyse::planted::{ROOF_STEP, fall, lay, roof, side_by_side, spaced};
    use crate::model::polyline::length;

    /// The length of a seam and of a crease of so many degrees that it runs onto, and of those parts of them that are
    /// taken for seams; points scatter by `noise`.
    fn told(degrees: f64, noise: f64) -> [[f64; 2]; 2] {
        // A roof along x, and a seam down its far side.
        let points = roof(degrees, noise);
        let (search, nearest, spacing) = lay(&points);
        let normals = vec![Vec3::Z; points.len()];
        let sites = Sites { noise, ..side_by_side(&points, &normals, &nearest, &spacing) };
        let at = |x: f64, y: f64| DVec3::new(x, y, fall(degrees, y));
        let crease = [at(-1.0, 0.0), at(1.0, 0.0)];
        let seam = [at(0.1, 0.0), at(0.1, 1.0)];
        let lines = [vec![crease[0], at(0.1, 0.0), crease[1]], seam.to_vec()];
        let network = Network::new(&lines, &spaced(&search, &points, &spacing));
        let seams = seams(&network, &sites);
        let left = length(&off_seams(&lines, &network, &seams));
        let of = |is_crease: bool| {
            let own = |segment: &u32| network.ends(*segment).iter().all(|end| end.y == 0.0) == is_crease;
            let all = (0..network.segments.len() as u32).filter(own);
            let found = seams.iter().copied().filter(own);
            [all.map(|n| network.length(n)).sum(), found.map(|n| network.length(n)).sum::<f64>()]
        };
        let [crease, seam] = [of(true), of(false)];
        assert!((left - crease[0] - seam[0] + crease[1] + seam[1]).abs() < 1e-6, "{left} left");
        [crease, seam]
    }

    #[test]
    fn a_seam_parts_nothing_and_a_crease_does() {
        for (degrees, noise) in [(60.0, 0.0), (12.0, 0.0), (60.0, 0.5 * ROOF_STEP), (20.0, 0.5 * ROOF_STEP)] {
            let [crease, seam] = told(degrees, noise);
            assert!(crease[1] == 0.0, "{degrees}°: {crease:?}");
            assert!((seam[0] - seam[1]).abs() < 1e-9, "{degrees}°: {seam:?}");
        }
        let [crease, _] = told(3.0, 0.0);
        assert!((crease[0] - crease[1]).abs() < 1e-9, "a crease of 3° is none: {crease:?}");
    }
}
