//! Ends the growth of a splat: rounds it as the file will, judges it once more, cuts it.

use glam::DVec2;

use super::backing::backed;
use super::grow::{Domain, Grower};
use super::margin::disc_inside;
use super::region::{Member, Region};
use crate::fit::clip::Care;
use crate::fit::pose::Pose;
use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;
use crate::tolerance::FIT_SHARE;

/// A domain that does not hold when rounded shrinks by this factor, so many times.
const SHRINK: (f64, usize) = (0.95, 10);

/// A rounded splat may use the whole budget, less this share for the rounding of arithmetic.
const ROUNDED_SLACK: f64 = (1.0 - 1e-6) / FIT_SHARE;

/// A quadric whose sagittas are below this many budgets may do as a plane.
const FLAT_SAGITTA: f64 = 2.0;

/// A splat that keeps the budget, and what it covers.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The splat.
    pub splat: Splat,
    /// The pieces it covers, ascending.
    pub pieces: Vec<u32>,
    /// How many of the fit's six terms the points determined.
    pub rank: u8,
}

/// The splat of a grown domain, or of the largest smaller one that holds when rounded.
pub(super) fn settle(
    grower: &Grower,
    mut domain: Domain,
    seeds: &[u32],
    piece: u32,
    region: &mut Region,
) -> Option<Candidate> {
    let (shrink, tries) = SHRINK;
    for _ in 0..tries {
        let outer = grower.budget.padded(domain.radii);
        let sagitta = (domain.curvature * outer * outer).abs().max_element();
        let plane = (sagitta <= FLAT_SAGITTA * grower.budget.fit).then_some(DVec2::ZERO);
        let quadric = (domain.curvature != DVec2::ZERO).then_some(domain.curvature);
        for curvature in plane.into_iter().chain(quadric) {
            let found = rounded(grower, &domain.pose, outer, curvature)
                .and_then(|splat| finish(grower, splat, domain.rank, seeds, region))
                .filter(|candidate| candidate.pieces.binary_search(&piece).is_ok());
            if found.is_some() {
                return found;
            }
        }
        domain = grower.attempt(&domain.pose, domain.radii * shrink, seeds, region).ok()?;
    }
    None
}

/// A splat as it will be stored, not yet cut or coloured.
pub(super) fn rounded(grower: &Grower, pose: &Pose, radii: DVec2, curvature: DVec2) -> Option<Splat> {
    (grower.round)(&Splat {
        center: pose.center,
        axes: pose.axes,
        radii,
        curvature,
        clips: Vec::new(),
        color: [u8::MAX; 3],
    })
}

/// Judges and cuts a rounded splat; `None` if it does not keep the budget.
fn finish(
    grower: &Grower,
    mut splat: Splat,
    rank: u8,
    seeds: &[u32],
    region: &mut Region,
) -> Option<Candidate> {
    let pose = Pose { center: splat.center, axes: splat.axes };
    let kept = region.gather(grower.surface, &pose, splat.radii, seeds)
        && grower.keeps(&pose, splat.radii, splat.curvature, ROUNDED_SLACK, region);
    splat.clips = kept.then(|| grower.clips(&pose, splat.radii, Care::Nearest, region).ok())??;
    if !backed(grower, &pose, splat.radii, splat.curvature, &splat.clips, region) {
        return None;
    }
    let points = covered(grower, &splat, region);
    splat.color = mean_color(grower, &points);
    Some(Candidate { splat, pieces: pieces_within(grower, &points, region), rank })
}

/// The points well inside the domain and not cut away.
fn covered(grower: &Grower, splat: &Splat, region: &Region) -> Vec<u32> {
    let conics: Vec<Conic> = splat.clips.iter().map(|clip| clip.conic(splat.radii)).collect();
    let trusted = grower.budget.trusted(splat.radii);
    let inside = |member: &&Member| {
        let uv = member.local.truncate();
        disc_inside(uv, f64::from(grower.surface.margin[member.point as usize]), trusted)
            && !conics.iter().any(|conic| conic.cuts(uv))
    };
    region.members.iter().filter(inside).map(|member| member.point).collect()
}

/// The pieces all of whose corners are among some points, ascending.
fn pieces_within(grower: &Grower, points: &[u32], region: &mut Region) -> Vec<u32> {
    region.unmark();
    for &point in points {
        region.mark(point);
    }
    let surface = grower.surface;
    let mut pieces: Vec<u32> = points
        .iter()
        .flat_map(|&point| surface.pieces_of.row(point).iter().copied())
        .filter(|&piece| surface.pieces[piece as usize].iter().all(|&corner| region.marked(corner)))
        .collect();
    pieces.sort_unstable();
    pieces.dedup();
    pieces
}

/// The mean colour of some points; white where the surface has none.
fn mean_color(grower: &Grower, points: &[u32]) -> [u8; 3] {
    let colors = &grower.surface.colors;
    if colors.is_empty() || points.is_empty() {
        return [u8::MAX; 3];
    }
    let mut sums = [0_u64; 3];
    for &point in points {
        for (sum, channel) in sums.iter_mut().zip(colors[point as usize]) {
            *sum += u64::from(channel);
        }
    }
    let count = points.len() as u64;
    sums.map(|sum| ((sum + count / 2) / count) as u8)
}
