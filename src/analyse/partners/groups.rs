//! Whether the areas of a splat's partners unite or intersect.
//!
//! The paper decides for a whole set at once: where partners and splat are both concave or both
//! convex the areas unite, else they intersect (Fig. 5). Mixed sets are divided into groups that
//! are classified alone (Ivo 2020, Fig. 11). Here the same question is asked of two partners at
//! a time: if each cuts away the other's edge, neither may cut alone, and their areas intersect;
//! else they unite. Only partners that follow each other along the edge are asked: those on two
//! sides of a slot, or around two holes, have nothing to do with each other.

use glam::DVec3;

use super::Candidate;
use super::meeting::BESIDE;
use crate::analyse::sets::Sets;
use crate::model::partner::Group;

/// Partners whose surfaces keep within this many error bounds of each other's edges are one
/// surface. What is taken for an edge may go on beyond a corner by [`BESIDE`].
const ONE_SURFACE: f64 = BESIDE + 1.0;

/// Two edges follow each other if they come this near, in the larger of their spacings.
const FOLLOWS: f64 = 2.0;

/// The groups of a splat's partners, and how many were given up because they cut `feet` away,
/// which the splat must show.
pub(super) fn grouped(candidates: &[Candidate], feet: &[DVec3], max_error: f64) -> (Vec<Group>, usize) {
    let mut sets = Sets::new(candidates.len());
    for (a, one) in candidates.iter().enumerate() {
        for (b, other) in candidates.iter().enumerate().skip(a + 1) {
            if follow(one, other) && together(one, other, max_error) {
                sets.merge(a as u32, b as u32);
            }
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    let mut first: Vec<u32> = Vec::new();
    for (n, candidate) in candidates.iter().enumerate() {
        let root = sets.root(n as u32);
        match first.iter().position(|&other| other == root) {
            Some(at) => groups[at].push(candidate.partner),
            None => {
                first.push(root);
                groups.push(vec![candidate.partner]);
            }
        }
    }
    kept(groups, feet)
}

/// Whether the edges of two partners come near each other.
fn follow(one: &Candidate, other: &Candidate) -> bool {
    let gap = FOLLOWS * one.spacing.max(other.spacing);
    let near = |place: &DVec3| other.edge.iter().any(|next| next.distance_squared(*place) <= gap * gap);
    one.edge.iter().any(near)
}

/// Whether neither of two partners surely leaves the other's edge alone: each cuts some of it
/// away, or they are one surface there.
fn together(one: &Candidate, other: &Candidate, max_error: f64) -> bool {
    let limit = ONE_SURFACE * max_error;
    let spares = |by: &Candidate, of: &Candidate| {
        let beyond = of.edge.iter().map(|&place| by.partner.depth(place) + by.partner.outset);
        let (low, high) = beyond.fold((0.0_f64, 0.0_f64), |(low, high), to| (low.min(to), high.max(to)));
        low < -limit && high <= limit
    };
    !spares(one, other) && !spares(other, one)
}

/// The groups that cut nothing away that must be shown. Those that do are merged with each other
/// where that helps, else given up: then the splat reaches over that edge, as far as its ellipse.
fn kept(groups: Vec<Group>, feet: &[DVec3]) -> (Vec<Group>, usize) {
    let sound =
        |group: &Group| !feet.iter().any(|&foot| group.iter().all(|partner| partner.depth(foot) > 0.0));
    let (mut kept, mut bad): (Vec<Group>, Vec<Group>) = groups.into_iter().partition(sound);
    let mut given_up = 0;
    while let Some(group) = (!bad.is_empty()).then(|| bad.remove(0)) {
        let merged = |other: &Group| [group.as_slice(), other.as_slice()].concat();
        if let Some(at) = bad.iter().position(|other| sound(&merged(other))) {
            let other = bad.remove(at);
            kept.push(merged(&other));
        } else {
            given_up += 1;
        }
    }
    for group in &mut kept {
        group.sort_by_key(|partner| partner.splat);
    }
    kept.sort_by_key(|group| group[0].splat);
    (kept, given_up)
}
