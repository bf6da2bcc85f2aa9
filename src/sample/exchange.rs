//! Candidates that take from a neighbour what it alone covers, and leave to others what they alone do.
//!
//! [`super::moves`] makes the moves that pay at once. Mostly a splat can only be saved if several around
//! it shift, none of which pays alone. So for each splat and each of its neighbours others are laid out for
//! parts of what the two alone cover, and the choice made anew finds those that go together. Such are
//! the columns that a linear program lacks (Gilmore and Gomory 1961, "A linear programming approach
//! to the cutting-stock problem"), looked for by neighbourhood instead of by price.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::candidates::Regions;
use super::cover::Cover;
use super::enclose::Need;
use super::grow::Grower;
use super::owners::Owners;
use super::region::Region;
use super::set_cover::Alike;
use super::settle::Candidate;
use crate::analyse::canonical::mix;
use crate::analyse::surface::Rows;
use crate::fit::pose::Axes;

/// Which parts of what two splats alone cover one is laid out for: of its own, the nearest to the other's
/// centre; of the other's, the nearest to its own. The more it leaves, the more it takes. Four that leave
/// nothing made the cover of stanford-bunny 3 % dearer than these.
const SHARES: [(f64, f64); 4] = [(1.0, 0.3), (0.7, 0.5), (0.5, 0.8), (0.3, 1.0)];

/// A round that saves less than this share of the cover's cost is the last: each saves less than the one
/// before, half as much or so.
const WORTH: f64 = 0.002;

/// How much is tried.
struct Thoroughness {
    /// Times that splats are laid out, at most. At a tenth of a percent, with three neighbours, the first makes
    /// files 4 % smaller in the median and the bake a third to two thirds longer, the second them 2 to 3 % smaller
    /// again and takes a tenth, the third less than 1 % for half of that.
    rounds: usize,
    /// Neighbours that a splat exchanges with, the nearest first.
    neighbours: usize,
}

impl Thoroughness {
    fn of(effort: u8) -> Self {
        Self { rounds: usize::from(effort).saturating_sub(3), neighbours: usize::from(effort).div_ceil(2) }
    }
}

/// Lays out splats for other shares of the surface, and chooses anew, while that saves something.
pub(super) fn exchange(grower: &Grower, regions: &Regions, cover: &mut Cover, alike: &mut Alike, effort: u8) {
    let Thoroughness { rounds, neighbours } = Thoroughness::of(effort);
    let mut tried = BTreeSet::new();
    for _ in 0..rounds {
        let spent = cover.cost();
        for (key, found) in others(grower, regions, cover, neighbours, &tried) {
            tried.insert(key);
            cover.candidates.extend(found);
        }
        cover.rechoose(alike);
        if spent - cover.cost() < WORTH * spent {
            break;
        }
    }
}

/// Splats laid out for the needs around all those chosen that have not been tried, each under its key.
fn others(
    grower: &Grower,
    regions: &Regions,
    cover: &Cover,
    neighbours: usize,
    tried: &BTreeSet<u64>,
) -> Vec<(u64, Option<Candidate>)> {
    let owners = Owners::of(cover);
    let alone = owners.alone(cover);
    let around = |&index: &usize| {
        let layout = Layout { grower, cover, owners: &owners, alone: &alone, index };
        let others = owners.neighbours(cover, index).into_iter().take(neighbours);
        let needs = others.flat_map(|other| layout.needs(other));
        let new = needs.map(|need| (layout.key(&need), need)).filter(|(key, _)| !tried.contains(key));
        regions.with(|region| new.map(|(key, need)| (key, layout.covered(need, region))).collect())
    };
    let laid: Vec<Vec<_>> = cover.chosen.par_iter().map(around).collect();
    laid.into_iter().flatten().collect()
}

/// One splat of a cover, around which others are laid out.
struct Layout<'a> {
    grower: &'a Grower<'a>,
    cover: &'a Cover,
    owners: &'a Owners,
    /// For each candidate the pieces that it alone covers.
    alone: &'a Rows,
    index: usize,
}

impl Layout<'_> {
    /// The pieces, ascending, that splats are to cover in an exchange with another: the [`SHARES`] of what
    /// either alone covers, and all that only both do.
    fn needs(&self, other: usize) -> [Vec<u32>; SHARES.len()] {
        let (own, theirs) = (self.towards(self.index, other), self.towards(other, self.index));
        let shared: Vec<u32> = self.owners.shared(self.cover, [self.index, other]).collect();
        SHARES.map(|(kept, taken)| {
            let mut need: Vec<u32> =
                own.part(kept).chain(theirs.part(taken)).chain(shared.iter().copied()).collect();
            // Three runs that ascend, which a stable sort merges.
            need.sort();
            need
        })
    }

    /// What one splat alone covers, beside another.
    fn towards(&self, one: usize, other: usize) -> Towards<'_> {
        let center = self.cover.candidates[other].splat.center;
        let pieces = self.alone.row(one as u32);
        let away = |&piece: &u32| self.grower.surface.middle(piece).distance_squared(center);
        Towards::new(pieces, pieces.iter().map(away).collect())
    }

    /// A number that tells a need from others, laid out along the axes of this splat.
    fn key(&self, need: &[u32]) -> u64 {
        need.iter().fold(self.index as u64, |key, &piece| mix(key ^ u64::from(piece)))
    }

    fn covered(&self, need: Vec<u32>, region: &mut Region) -> Option<Candidate> {
        let axes = self.cover.candidates[self.index].splat.axes;
        // Boxes, where the principal axes will not do, make files 1 to 2 % smaller; where splats are moved and
        // merged they bring nothing.
        Need::new(self.grower.surface, need, axes)?.covered(&Axes::ALL, self.grower, region)
    }
}

/// Pieces, and how far each is from a place.
struct Towards<'a> {
    /// Ascending.
    pieces: &'a [u32],
    away: Vec<f64>,
    /// The same from the least to the greatest.
    ordered: Vec<f64>,
}

impl<'a> Towards<'a> {
    fn new(pieces: &'a [u32], away: Vec<f64>) -> Self {
        let mut ordered = away.clone();
        ordered.sort_unstable_by(f64::total_cmp);
        Self { pieces, away, ordered }
    }

    /// A share of the pieces, rounded up, those that are nearest, ascending; all as far as the last of them.
    fn part(&self, share: f64) -> impl Iterator<Item = u32> {
        let count = (share * self.pieces.len() as f64).ceil() as usize;
        let most = count.checked_sub(1).map_or(-1.0, |last| self.ordered[last]);
        let near = self.pieces.iter().zip(&self.away).filter(move |(_, away)| **away <= most);
        near.map(|(&piece, _)| piece)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::analyse::split::split;
    use crate::analyse::surface::Surface;
    use crate::analyse::weld::Welded;
    use crate::fit::clip::Clips;
    use crate::model::splat::Splat;
    use crate::sample::budget::Budget;
    use crate::sample::candidates::candidates;
    use crate::sample::cover::cover;
    use crate::sample::scout::Begun;
    use glam::Vec3;

    /// Vertices along each side of a sheet.
    const SIDE: u32 = 40;

    /// A sheet over the unit square, so high over each place.
    pub(in crate::sample) fn sheet(height: impl Fn(f64, f64) -> f64) -> Surface {
        let place = |n: u32| {
            let [x, y] = [n % SIDE, n / SIDE].map(|at| f64::from(at) / f64::from(SIDE - 1));
            Vec3::new(x as f32, y as f32, height(x, y) as f32)
        };
        let cells = (0..(SIDE - 1) * (SIDE - 1)).map(|n| n / (SIDE - 1) * SIDE + n % (SIDE - 1));
        let triangles: Vec<[u32; 3]> =
            cells.flat_map(|n| [[n, n + 1, n + SIDE], [n + 1, n + SIDE + 1, n + SIDE]]).collect();
        let positions = (0..SIDE * SIDE).map(place).collect();
        let sides = vec![false; 3 * triangles.len()];
        split(&Welded { positions, triangles, ..Welded::default() }, &sides)
    }

    /// One of waves.
    pub(in crate::sample) fn waves() -> Surface {
        sheet(|x, y| 0.04 * libm::sin(9.0 * x) * libm::cos(7.0 * y))
    }

    #[test]
    fn exchanging_makes_covers_cheaper_that_cover_as_much() {
        let surface = waves();
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let regions = Regions::new(surface.points.len());
        let (mut before, mut after) = (0.0, 0.0);
        for bound in [0.002, 0.003, 0.004, 0.006] {
            let grower = Grower::new(&surface, Budget::new(bound, Clips::Curved), &round);
            // The least effort exchanges nothing.
            let grown = candidates(&grower, &regions, &Begun::default(), 1, |_| ());
            let (mut cover, _) = cover(&grower, &regions, grown, 1);
            before += cover.cost();
            exchange(&grower, &regions, &mut cover, &mut Alike::new(surface.pieces.len()), 9);
            after += cover.cost();
            let mut covered = vec![false; surface.pieces.len()];
            for &piece in cover.chosen.iter().flat_map(|&index| &cover.candidates[index].pieces) {
                covered[piece as usize] = true;
            }
            assert!(covered.into_iter().all(|covered| covered));
        }
        assert!(after < 0.95 * before, "{after} for {before}");
    }

    #[test]
    fn a_part_is_what_lies_nearest() {
        let towards = Towards::new(&[2, 3, 5, 9], vec![4.0, 1.0, 3.0, 1.0]);
        let part = |share: f64| towards.part(share).collect::<Vec<u32>>();
        assert_eq!((part(1.0), part(0.7)), (vec![2, 3, 5, 9], vec![3, 5, 9]));
        assert_eq!((part(0.3), part(0.0)), (vec![3, 9], vec![]), "both that are as near");
        assert_eq!(Towards::new(&[], Vec::new()).part(1.0).count(), 0);
    }
}
