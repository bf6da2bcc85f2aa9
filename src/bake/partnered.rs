//! The last step of a bake without feature lines: splats are cut by their partners.
//!
//! Splats grow on each smooth sheet of the surface as they do for conics, which tell how far one
//! may reach over a sheet's end and still be cut there. The conics along feature lines are then
//! left out, and each splat is cut by those it meets across the line. Where the surface ends
//! without another beyond, as at a mesh's open border, there is no partner, and the conics stay.

use super::options::Options;
use super::piece_length;
use crate::analyse::creases::weak_cosine;
use crate::analyse::partners::{Rule, Shown, Tally, clip_partners};
use crate::analyse::surface::Surface;
use crate::model::splat::Splat;
use crate::sample::settle::Candidate;

/// A cloud's splats meet within this many of its margins of a point on the line between them.
const MARGINS: f64 = 2.0;

/// When two splats over a surface are partners. Angles are those at which its creases go on, so
/// that no crease is left without.
pub(super) fn rule(surface: &Surface, options: &Options, max_error: f64, diagonal: f64) -> Rule {
    let margin = surface.margin.iter().copied().fold(0.0, f32::max);
    let apart = piece_length(max_error, diagonal).max(MARGINS * f64::from(margin));
    Rule { agree: weak_cosine(options.edge_angle), max_error, beside: Some(apart) }
}

/// The splats of a cover, cut by their partners.
pub(super) fn partnered(chosen: Vec<Candidate>, surface: &Surface, rule: &Rule) -> (Vec<Splat>, Tally) {
    let shown: Vec<Shown> = chosen.iter().map(|one| shown(one, surface)).collect();
    let splats = chosen.into_iter().map(|one| Splat { clips: one.end_clips, ..one.splat });
    let mut splats: Vec<Splat> = splats.collect();
    let (groups, tally) = clip_partners(&splats, &shown, rule);
    for (splat, groups) in splats.iter_mut().zip(groups) {
        splat.partners = groups;
    }
    (splats, tally)
}

/// The corners of the pieces that a splat covers.
fn shown(one: &Candidate, surface: &Surface) -> Shown {
    let mut corners: Vec<u32> =
        one.pieces.iter().flat_map(|&piece| surface.pieces[piece as usize]).collect();
    corners.sort_unstable();
    corners.dedup();
    let place = |point: &u32| surface.point(*point);
    Shown {
        places: corners.iter().map(place).collect(),
        ends: corners.iter().filter(|&&point| surface.on_border(point)).map(place).collect(),
    }
}
