//! The last step of a bake without feature lines: splats are cut by their partners.
//!
//! Splats grow on each smooth sheet of the surface as they do for conics, which tell how far one
//! may reach over a sheet's end and still be cut there. The conics along feature lines are then
//! left out, and each splat is cut by those it meets across the line. Where the surface ends
//! without another beyond, as at a mesh's open border, there is no partner, and the conics stay.

use super::options::Options;
use crate::analyse::creases::weak_cosine;
use crate::analyse::partners::{Rule, Shown, Tally, clip_partners};
use crate::analyse::surface::Surface;
use crate::model::splat::Splat;
use crate::sample::settle::Candidate;

/// When two splats are partners. Angles are those at which creases go on, so that no crease is
/// left without.
pub(super) fn rule(options: &Options, max_error: f64) -> Rule {
    Rule { agree: weak_cosine(options.edge_angle), max_error }
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
    let place = |point: u32| surface.point(point);
    let sides = corners.iter().map(|&from| (from, surface.border_next[from as usize]));
    let ends = sides.filter(|(_, to)| corners.binary_search(to).is_ok());
    Shown {
        places: corners.iter().map(|&point| place(point)).collect(),
        ends: Some(ends.map(|(from, to)| [place(from), place(to)]).collect()),
    }
}
