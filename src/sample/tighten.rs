//! Splats of a cover laid out anew, each for its share of the surface alone.
//!
//! While a cover is chosen, splats are as large as the bound allows: what one covers beside its own, another need not.
//! Once it is chosen, much is covered twice, and where splats reach farthest from their middles they lie farthest off.
//! So every piece goes to the splat in which it lies deepest, and each splat is fitted to what it got.

use rayon::prelude::*;

use super::candidates::Regions;
use super::cover::{Cover, cost};
use super::enclose::Need;
use super::grow::Grower;
use super::owners::Owners;
use super::region::Region;
use super::settle::Candidate;
use crate::analyse::surface::Surface;
use crate::fit::pose::Axes;

/// Times that pieces are shared out.
const ROUNDS: usize = 2;

/// Lays out the chosen for what each of them covers best, where that makes them smaller and no dearer.
pub(super) fn tighten(grower: &Grower, regions: &Regions, cover: &mut Cover) {
    let common = beside_last_resorts(cover, grower.surface);
    for _ in 0..ROUNDS {
        let owners = Owners::of(cover);
        let shares = owners.shares(cover, grower.surface, &common);
        let tighter = |&index: &usize| {
            regions.with(|region| tighter(&cover.candidates[index], shares.row(index as u32), grower, region))
        };
        let found: Vec<Option<Candidate>> = cover.chosen.par_iter().map(tighter).collect();
        let chosen = std::mem::take(&mut cover.chosen);
        for (index, found) in chosen.into_iter().zip(found) {
            match found {
                Some(found) => cover.replace(&[index], found),
                None => cover.chosen.push(index),
            }
        }
    }
}

/// Which pieces splats of last resort cover or touch. Their borders run where no line does, and whatever covers
/// them there hides them.
fn beside_last_resorts(cover: &Cover, surface: &Surface) -> Vec<bool> {
    let mut beside = vec![false; surface.pieces.len()];
    let chosen = cover.chosen.iter().map(|&index| &cover.candidates[index]);
    let pieces = chosen.filter(|candidate| candidate.last_resort).flat_map(|candidate| &candidate.pieces);
    let corners = pieces.flat_map(|&piece| surface.pieces[piece as usize]);
    for piece in surface.pieces_at(corners) {
        beside[piece as usize] = true;
    }
    beside
}

/// The smallest splat found for some of the pieces that one covers, if it is smaller than that and no dearer.
fn tighter(candidate: &Candidate, share: &[u32], grower: &Grower, region: &mut Region) -> Option<Candidate> {
    if candidate.last_resort {
        return None;
    }
    let smaller =
        |found: &Candidate| area(found) < area(candidate) && cost(&found.splat) <= cost(&candidate.splat);
    let need = Need::new(grower.surface, share.to_vec(), candidate.splat.axes)?;
    let found = Axes::ALL.into_iter().filter_map(|axes| need.enclosed(axes, grower, region));
    found.filter(smaller).min_by(|a, b| area(a).total_cmp(&area(b)))
}

/// That of its ellipse, over π.
fn area(candidate: &Candidate) -> f64 {
    candidate.splat.radii.element_product()
}

#[cfg(test)]
mod tests {
    use super::super::budget::Budget;
    use super::super::candidates::candidates;
    use super::super::exchange::tests::waves;
    use super::super::scout::Begun;
    use super::*;
    use crate::fit::clip::Clips;
    use crate::model::splat::Splat;

    #[test]
    fn splats_shrink_to_their_shares_and_all_stays_covered() {
        let surface = waves();
        let grower = Grower::new(&surface, Budget::new(0.004, Clips::Curved), &|splat: &Splat, _: u8| {
            Some(splat.clone())
        });
        let regions = Regions::new(surface.points.len());
        let candidates = candidates(&grower, &regions, &Begun::default(), 1, |_| ());
        let count = candidates.len();
        let mut cover = Cover { candidates, times: vec![0; surface.pieces.len()], ..Cover::default() };
        cover.areas = vec![1.0; cover.times.len()];
        (0..count).for_each(|index| cover.add(index));
        cover.drop_redundant();
        let areas = |cover: &Cover| cover.chosen.iter().map(|&one| area(&cover.candidates[one])).sum::<f64>();
        let covered = |cover: &Cover| cover.times.iter().filter(|&&times| times > 0).count();
        let (splats, spent, before, pieces) =
            (cover.chosen.len(), cover.cost(), areas(&cover), covered(&cover));
        tighten(&grower, &regions, &mut cover);
        assert!(areas(&cover) < 0.9 * before, "{} for {before}", areas(&cover));
        assert!(cover.chosen.len() == splats && cover.cost() <= spent && covered(&cover) == pieces);
    }
}
