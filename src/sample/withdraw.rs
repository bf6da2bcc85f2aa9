//! Takes out splats that show beside the outline, and covers their pieces by others that do not.

use rayon::prelude::*;

use super::candidates::Regions;
use super::cover::{Cover, cost};
use super::grow::Grower;
use super::polygon;
use super::seal::{Make, grown, made_within};
use super::set_cover::{Alike, SetCover};
use super::settle::Candidate;
use crate::analyse::canonical::mix;
use crate::model::sight::Sight;

/// Pieces that splats are grown from side by side before it is seen which are still bare. Batches are of
/// the same size whatever the threads, so that the result is the same too.
const BATCH: usize = 16;

/// Shares of the budget for splats that are to stay inside the outline. A large face with many cuts may
/// have none at half the budget, but what stands out does so by little more than a pixel.
const NEARER: [f64; 9] = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.35, 0.25, 0.125];

/// Batches grown at most, besides one from the middle of each splat that is taken out: what would need
/// more is about as long as the outline itself.
const MOST_BATCHES: usize = 64;

/// So few pieces get splats of their own where nothing larger can be grown.
const FEW: usize = 16;

/// And more, up to this share of the splats: still more of them cost too much for what little shows. Of the smoothed
/// scans of a dragon at 0.3 % a tenth are asked for, and make the file half a percent larger.
const MOST_LEFT: f64 = 0.125;

impl Cover {
    /// Takes out the chosen splats that stop rays which pass beside the surface, and adds the cheapest
    /// known or grown that cover their pieces and stop no such ray, now or before; how many are out. Over
    /// pieces that no such splat covers, what stops the fewest of the rays stays for good.
    pub fn withdraw(&mut self, grower: &Grower, regions: &Regions, beside: &[Sight]) -> usize {
        self.beside.extend_from_slice(beside);
        let shows = |index: &usize| {
            !self.lasting.contains(index)
                && beside.iter().any(|ray| ray.is_stopped(&self.candidates[*index].splat))
        };
        let (shown, kept): (Vec<usize>, Vec<usize>) = self.chosen.par_iter().partition(|index| shows(index));
        if shown.is_empty() {
            return 0;
        }
        let bare = self.own(&shown);
        self.drop_chosen(&shown, kept);
        let mut offers = self.offers(&bare);
        let middles = middles(&self.candidates, &shown, grower);
        self.offer_at(&middles, grown, grower, regions, &bare, &mut offers);
        let left = self.offer_over(grower, regions, &bare, &mut offers);
        let most = MOST_LEFT * self.chosen.len() as f64;
        if left.len() <= FEW.max(most as usize) {
            self.offer_at(&left, polygon::over, grower, regions, &bare, &mut offers);
        }
        for index in self.cheapest(&offers, self.areas.len()) {
            self.add(index);
        }
        shown.into_iter().filter(|&index| !self.put_back(index, grower, regions)).count()
    }

    /// Puts a splat that was taken out back if nothing else covers some of its pieces; whether it did.
    ///
    /// Where the nearest splats over those pieces themselves stop fewer of the rays beside the surface, these
    /// are taken instead. What is taken stays for good.
    fn put_back(&mut self, index: usize, grower: &Grower, regions: &Regions) -> bool {
        let bare = |piece: &u32| self.times[*piece as usize] == 0;
        let own: Vec<u32> = self.candidates[index].pieces.iter().copied().filter(bare).collect();
        if own.is_empty() {
            return false;
        }
        let nearer = nearest_over(&own, grower, regions);
        let stopped = |candidates: &[Candidate]| {
            let stops = |ray: &&Sight| candidates.iter().any(|one| ray.is_stopped(&one.splat));
            self.beside.iter().filter(stops).count()
        };
        let fewer = |nearer: &Vec<Candidate>| {
            stopped(nearer) < stopped(std::slice::from_ref(&self.candidates[index]))
        };
        let Some(nearer) = nearer.filter(fewer) else {
            self.add(index);
            self.lasting.insert(index);
            return true;
        };
        for candidate in nearer {
            self.lasting.insert(self.candidates.len());
            self.choose(candidate);
        }
        false
    }

    /// Takes some off the list of the chosen, of which it leaves these.
    fn drop_chosen(&mut self, dropped: &[usize], kept: Vec<usize>) {
        for &piece in dropped.iter().flat_map(|&index| &self.candidates[index].pieces) {
            self.times[piece as usize] -= 1;
        }
        self.chosen = kept;
    }

    /// Candidates that stop no ray beside the surface, each with those of some pieces, ascending, that it
    /// covers, if any.
    fn offers(&self, bare: &[u32]) -> Vec<(usize, Vec<u32>)> {
        let numbered = self.candidates.par_iter().enumerate();
        let offers = numbered.map(|(index, candidate)| (index, common(&candidate.pieces, bare)));
        offers
            .filter(|(index, covered)| !covered.is_empty() && self.is_inside(&self.candidates[*index]))
            .collect()
    }

    /// Offers candidates grown over the pieces that none of the offers covers; those that are left.
    fn offer_over(
        &mut self,
        grower: &Grower,
        regions: &Regions,
        bare: &[u32],
        offers: &mut Vec<(usize, Vec<u32>)>,
    ) -> Vec<u32> {
        let mut covered: Vec<u32> = offers.iter().flat_map(|(_, pieces)| pieces).copied().collect();
        covered.sort_unstable();
        let mut open: Vec<u32> =
            bare.iter().copied().filter(|piece| covered.binary_search(piece).is_err()).collect();
        // Strewn: those beside each other are covered by one splat.
        open.sort_unstable_by_key(|&piece| mix(u64::from(piece)));
        let mut left = Vec::new();
        for _ in 0..MOST_BATCHES {
            let batch = open.split_off(open.len().saturating_sub(BATCH));
            let before = self.candidates.len();
            self.offer_at(&batch, grown, grower, regions, bare, offers);
            let made = &self.candidates[before..];
            let is_left = |piece: &u32| !made.iter().any(|one| one.pieces.binary_search(piece).is_ok());
            left.extend(batch.into_iter().filter(is_left));
            open.retain(is_left);
            // They are strewn: where all of them fail, the others would.
            if made.is_empty() {
                break;
            }
        }
        left.extend(open);
        left
    }

    /// Offers candidates made over some pieces.
    fn offer_at(
        &mut self,
        pieces: &[u32],
        make: Make,
        grower: &Grower,
        regions: &Regions,
        bare: &[u32],
        offers: &mut Vec<(usize, Vec<u32>)>,
    ) {
        let inside = |candidate: &Candidate| self.is_inside(candidate);
        let make = |&piece: &u32| made_within(&NEARER, grower, regions, (make, piece), inside);
        let made: Vec<Option<Candidate>> = pieces.par_iter().map(make).collect();
        for candidate in made.into_iter().flatten() {
            offers.push((self.candidates.len(), common(&candidate.pieces, bare)));
            self.candidates.push(candidate);
        }
    }

    /// Whether a candidate stops no ray beside the surface.
    pub(super) fn is_inside(&self, candidate: &Candidate) -> bool {
        !self.beside.iter().any(|ray| ray.is_stopped(&candidate.splat))
    }

    /// The cheapest candidates that do all, of so many things to do, that some do; each with what it does.
    pub(super) fn cheapest(&self, does: &[(usize, Vec<u32>)], all: usize) -> Vec<usize> {
        let costs = does.iter().map(|&(index, _)| cost(&self.candidates[index].splat)).collect();
        let lists: Vec<&[u32]> = does.iter().map(|(_, done)| done.as_slice()).collect();
        let problem = SetCover::of_decisive(costs, &Alike::of(&lists, all));
        let known = (0..does.len() as u32).collect();
        problem.cheaper(known).into_iter().map(|at| does[at as usize].0).collect()
    }
}

/// Splats over a few pieces themselves, as near to them as any; `None` for many.
fn nearest_over(pieces: &[u32], grower: &Grower, regions: &Regions) -> Option<Vec<Candidate>> {
    let least = &NEARER[NEARER.len() - 1..];
    let over = |&piece: &u32| made_within(least, grower, regions, (polygon::over, piece), |_| true);
    (pieces.len() <= FEW).then(|| pieces.iter().map(over).collect())?
}

/// For each of some candidates the piece in its middle.
fn middles(candidates: &[Candidate], some: &[usize], grower: &Grower) -> Vec<u32> {
    let middle = |&index: &usize| {
        let Candidate { splat, pieces, .. } = &candidates[index];
        let distance = |piece: u32| grower.surface.middle(piece).distance_squared(splat.center);
        pieces.iter().copied().min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    };
    some.iter().filter_map(middle).collect()
}

/// What two ascending lists have in common.
fn common(some: &[u32], others: &[u32]) -> Vec<u32> {
    some.iter().copied().filter(|piece| others.binary_search(piece).is_ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::surface::{NONE, Rows, Surface};
    use crate::fit::clip::Clips;
    use crate::model::splat::Splat;
    use crate::sample::budget::Budget;
    use crate::sample::cover::tests::candidate;
    use crate::sample::seal::tests::{fruitless, lone_spot};
    use glam::{DVec2, DVec3, Vec3};

    /// Discs in the plane at places on the x axis with radii, over some pieces; the first `chosen` are.
    fn cover(discs: &[(f64, f64, &[u32])], chosen: usize, pieces: usize) -> Cover {
        let disc = |&(x, radius, pieces): &(f64, f64, &[u32])| {
            let mut candidate = candidate(pieces);
            candidate.splat.center = x * DVec3::X;
            candidate.splat.radii = DVec2::splat(radius);
            candidate
        };
        let candidates = discs.iter().map(disc).collect();
        let mut cover =
            Cover { candidates, times: vec![0; pieces], areas: vec![1.0; pieces], ..Cover::default() };
        (0..chosen).for_each(|index| cover.add(index));
        cover
    }

    /// Seen from above at places on the x axis.
    fn beside(places: &[f64]) -> Vec<Sight> {
        let ray = |&x: &f64| Sight { at: x * DVec3::X, direction: DVec3::NEG_Z, beyond: f64::INFINITY };
        places.iter().map(ray).collect()
    }

    /// Where nothing can be grown.
    fn withdraw(cover: &mut Cover, places: &[f64]) -> usize {
        let surface = Surface {
            points: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            neighbours: Rows::placed(3, std::iter::empty),
            pieces: vec![[0, 1, 2]; cover.areas.len()],
            pieces_of: Rows::placed(3, std::iter::empty),
            border_next: vec![NONE; 3],
            border_prev: vec![NONE; 3],
            ..Surface::default()
        };
        cover.withdraw(&fruitless(&surface), &Regions::new(3), &beside(places))
    }

    #[test]
    fn what_shows_is_replaced_by_the_cheapest_that_do_not() {
        let discs: [(f64, f64, &[u32]); 5] =
            [(0.0, 2.0, &[0, 1]), (5.0, 1.0, &[2]), (0.0, 0.5, &[0]), (0.8, 0.5, &[1]), (0.5, 1.0, &[0, 1])];
        let mut cover = cover(&discs, 2, 3);
        assert_eq!(withdraw(&mut cover, &[-1.5]), 1);
        assert_eq!((cover.chosen.as_slice(), cover.times.as_slice()), (&[1, 4][..], &[1; 3][..]));
        assert_eq!(withdraw(&mut cover, &[1.45]), 1, "the ray before still counts");
        assert_eq!(cover.chosen, [1, 2, 3]);
        assert_eq!(withdraw(&mut cover, &[9.0]), 0, "no splat stops it");
    }

    #[test]
    fn what_nothing_else_covers_stays() {
        let discs: [(f64, f64, &[u32]); 3] = [(0.0, 2.0, &[0]), (0.0, 2.0, &[1, 2]), (0.0, 0.5, &[0])];
        let mut cover = cover(&discs, 2, 3);
        assert_eq!(withdraw(&mut cover, &[1.5]), 1, "one of the two stays");
        assert_eq!((cover.chosen.as_slice(), cover.times.as_slice()), (&[2, 1][..], &[1; 3][..]));
        cover.candidates.push(Candidate { pieces: vec![1, 2], ..cover.candidates[2].clone() });
        assert_eq!(withdraw(&mut cover, &[1.5]), 0, "and for good, whatever is laid out since");
    }

    #[test]
    fn where_all_show_those_that_show_least_stay() {
        let surface = lone_spot();
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = Grower::new(&surface, Budget::new(0.01, Clips::Curved), &round);
        let withdrawn =
            |cover: &mut Cover, places: &[f64]| cover.withdraw(&grower, &Regions::new(3), &beside(places));
        let mut wide = cover(&[(0.0, 2.0, &[0])], 1, 1);
        assert_eq!(withdrawn(&mut wide, &[-1.5, 0.05]), 1, "one of the point itself shows on one ray alone");
        let stays = wide.chosen.clone();
        assert!(wide.candidates[stays[0]].last_resort && wide.times == [1]);
        assert_eq!((withdrawn(&mut wide, &[0.06]), &wide.chosen), (0, &stays), "for good");
        let mut narrow = cover(&[(0.0, 0.1, &[0])], 1, 1);
        assert_eq!(
            (withdrawn(&mut narrow, &[0.05]), narrow.chosen.as_slice()),
            (0, &[0][..]),
            "none shows less"
        );
    }
}
