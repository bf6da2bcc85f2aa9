//! The last step of a bake without feature lines: splats are cut by their partners.
//!
//! Splats grow on each smooth sheet of the surface as they do for conics, which tell how far one
//! may reach over a sheet's end and still be cut there. The conics along feature lines are then
//! left out, and each splat is cut by those it meets across the line. Where the surface ends
//! without another beyond, as at a mesh's open border, there is no partner, and the conics stay.

use glam::DVec3;
use rayon::prelude::*;

use super::options::Options;
use crate::analyse::creases::weak_cosine;
use crate::analyse::partners::{Rule, Shown, Tally, clip_partners};
use crate::analyse::surface::{NONE, Surface};
use crate::model::splat::Splat;
use crate::sample::settle::Candidate;

/// When two splats are partners. Angles are those at which creases go on, so that no crease is
/// left without.
pub(super) fn rule(options: &Options, max_error: f64) -> Rule {
    Rule { agree: weak_cosine(options.edge_angle), max_error }
}

/// A border lies on a splat's sheet within this many error bounds of its quadric: what a rim may
/// stray, and the half of that again.
const ON_SHEET: f64 = 3.0;

/// And where the surface's normal turns from the splat's by less than this (cosine of 60 degrees):
/// farther, it is the other side of a thin wall, or of a sharp edge.
const FACING: f64 = 0.5;

/// The splats of a cover, cut by their partners.
pub(super) fn partnered(chosen: Vec<Candidate>, surface: &Surface, rule: &Rule) -> (Vec<Splat>, Tally) {
    let borders = borders(surface);
    let shown = |one: &Candidate| Shown {
        places: places(one, surface),
        ends: Some(ends(&one.splat, surface, &borders, rule.max_error)),
    };
    let shown: Vec<Shown> = chosen.par_iter().map(shown).collect();
    let splats = chosen.into_iter().map(|one| Splat { clips: one.end_clips, ..one.splat });
    let mut splats: Vec<Splat> = splats.collect();
    let (groups, tally) = clip_partners(&splats, &shown, rule);
    for (splat, groups) in splats.iter_mut().zip(groups) {
        splat.partners = groups;
    }
    (splats, tally)
}

/// The corners of the pieces that a splat covers.
fn places(one: &Candidate, surface: &Surface) -> Vec<DVec3> {
    let mut corners: Vec<u32> = one.pieces.iter().flat_map(|&piece| surface.pieces[piece as usize]).collect();
    corners.sort_unstable();
    corners.dedup();
    corners.into_iter().map(|point| surface.point(point)).collect()
}

/// The points at which a side of a border starts, and where it goes on; not where a line is only
/// carried on.
fn borders(surface: &Surface) -> Vec<[u32; 2]> {
    let sides = (0..).zip(&surface.border_next);
    let sides = sides.filter(|&(from, &next)| next != NONE && !surface.is_carried(from));
    sides.map(|(from, &next)| [from, next]).collect()
}

/// The sides of borders that a splat reaches over its sheet. These are more than those of the
/// pieces that it covers: it may reach over others' to where the sheet ends.
fn ends(splat: &Splat, surface: &Surface, borders: &[[u32; 2]], max_error: f64) -> Vec<[DVec3; 2]> {
    let reached = |point: u32| {
        let local = splat.to_local(surface.point(point));
        let uv = local.truncate();
        splat.ellipse(uv) <= 1.0
            && (local.z - splat.height(uv)).abs() <= ON_SHEET * max_error
            && surface.normal(point).dot(splat.normal(uv)) >= FACING
    };
    let sides = borders.iter().filter(|side| side.iter().any(|&point| reached(point)));
    sides.map(|side| side.map(|point| surface.point(point))).collect()
}
