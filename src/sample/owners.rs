//! Which of the chosen splats cover each piece, and so which are neighbours.

use glam::DVec3;
use rayon::prelude::*;

use super::cover::Cover;
use crate::analyse::surface::{Rows, Surface};

/// For each piece, the chosen splats that cover it, in the order in which they were.
pub(super) struct Owners(Rows);

impl Owners {
    /// Those of a cover as it is now.
    pub(super) fn of(cover: &Cover) -> Self {
        let owned =
            |&index: &usize| cover.candidates[index].pieces.iter().map(move |&piece| (piece, index as u32));
        Self(Rows::placed(cover.times.len(), || cover.chosen.iter().flat_map(owned)))
    }

    /// Those of a piece.
    pub(super) fn of_piece(&self, piece: u32) -> &[u32] {
        self.0.row(piece)
    }

    /// For each candidate of the cover, those of [some](some_of) of its pieces that it alone covers, ascending; none if
    /// it is not chosen.
    pub(super) fn alone(&self, cover: &Cover) -> Rows {
        let alone = |&index: &usize| {
            let pieces = some_of(&cover.candidates[index].pieces);
            pieces.filter(|&piece| self.0.row(piece).len() == 1).map(move |piece| (index as u32, piece))
        };
        Rows::placed(cover.candidates.len(), || cover.chosen.iter().flat_map(alone))
    }

    /// For each candidate of the cover its share of the surface, ascending: the pieces whose middles lie deeper in
    /// it than in others, and what it covers of those that are `common`; none if it is not chosen.
    pub(super) fn shares(&self, cover: &Cover, surface: &Surface, common: &[bool]) -> Rows {
        let share = |owner: u32, middle: DVec3| {
            let splat = &cover.candidates[owner as usize].splat;
            splat.ellipse(splat.to_local(middle).truncate())
        };
        let deepest = |piece: u32| {
            let middle = surface.middle(piece);
            let shares = self.0.row(piece).iter().map(|&owner| (share(owner, middle), owner));
            shares.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, owner)| owner)
        };
        let pieces = 0..cover.times.len() as u32;
        let deepest: Vec<Option<u32>> = pieces.clone().into_par_iter().map(deepest).collect();
        let owned = |piece: u32| {
            let owners = self.0.row(piece).iter().copied();
            let deepest = deepest[piece as usize];
            let has = move |owner: &u32| common[piece as usize] || deepest == Some(*owner);
            owners.filter(has).map(move |owner| (owner, piece))
        };
        Rows::placed(cover.candidates.len(), || pieces.clone().flat_map(&owned))
    }

    /// Those of [some](some_of) of the pieces of one splat that no third covers beside it and another, ascending.
    pub(super) fn shared<'a>(
        &'a self,
        cover: &'a Cover,
        [one, other]: [usize; 2],
    ) -> impl Iterator<Item = u32> + 'a {
        let by_both = move |piece: &u32| {
            let row = self.0.row(*piece);
            row.len() == 2 && row.contains(&(other as u32))
        };
        some_of(&cover.candidates[one].pieces).filter(by_both)
    }

    /// Those that cover one of [some](some_of) of the pieces of a splat of the cover, the nearest centre first.
    pub(super) fn neighbours(&self, cover: &Cover, index: usize) -> Vec<usize> {
        let pieces = some_of(&cover.candidates[index].pieces);
        let mut near: Vec<u32> = pieces.flat_map(|piece| self.0.row(piece)).copied().collect();
        near.sort_unstable();
        near.dedup();
        let center = |of: usize| cover.candidates[of].splat.center;
        let away = |other: usize| center(other).distance_squared(center(index));
        let mut near: Vec<usize> =
            near.into_iter().map(|other| other as usize).filter(|&other| other != index).collect();
        near.sort_by(|&a, &b| away(a).total_cmp(&away(b)).then(a.cmp(&b)));
        near
    }
}

/// Of the pieces of a splat at most about so many are looked at where others are laid out for some of them. Each piece
/// of a dense cloud is one of its points, of which a splat may cover fifty thousand: the cover of four million takes 0.7
/// of the time that it does with all of them looked at, and the file is as small.
const MOST_LOOKED_AT: usize = 4096;

/// Some of the pieces of a splat, evenly strewn, ascending, and all where they are few: they lie along a space-filling
/// curve.
pub(super) fn some_of(pieces: &[u32]) -> impl Iterator<Item = u32> + '_ {
    pieces.iter().copied().step_by(pieces.len().div_ceil(MOST_LOOKED_AT).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::cover::tests::candidate;
    use glam::Vec3;

    #[test]
    fn what_splats_cover_alone_and_with_one_other() {
        let lists: [&[u32]; 4] = [&[0, 1, 2, 3], &[7], &[2, 3, 4], &[3, 5]];
        let mut cover = Cover { candidates: lists.map(candidate).to_vec(), ..Cover::default() };
        cover.times = vec![0; 6];
        cover.candidates[2].splat.center = DVec3::X;
        [0, 3, 2].into_iter().for_each(|index| cover.add(index));
        let owners = Owners::of(&cover);
        let alone = owners.alone(&cover);
        assert_eq!(
            [0, 1, 2, 3].map(|index| alone.row(index).to_vec()),
            [vec![0, 1], vec![], vec![4], vec![5]]
        );
        assert_eq!(owners.shared(&cover, [0, 2]).collect::<Vec<u32>>(), [2]);
        assert_eq!(owners.shared(&cover, [0, 3]).count(), 0, "a third covers that too");
        assert_eq!(owners.neighbours(&cover, 0), [3, 2], "the nearest first");
    }

    #[test]
    fn of_many_pieces_some_are_looked_at_over_all_of_them() {
        let many: Vec<u32> = (0..10_000).collect();
        assert_eq!(some_of(&many[..4096]).collect::<Vec<u32>>(), many[..4096]);
        let some: Vec<u32> = some_of(&many).collect();
        assert!(some.len() == 3334 && some.windows(2).all(|pair| pair[1] - pair[0] == 3), "{}", some.len());
        assert_eq!(some_of(&[]).count(), 0);
    }

    #[test]
    fn a_piece_goes_to_the_splat_that_it_lies_deepest_in_unless_it_is_common() {
        let at = |x: f32| Vec3::new(x, 0.0, 0.0);
        let surface = Surface {
            points: [0.0, 0.4, 0.6, 1.0].map(at).to_vec(),
            pieces: (0..4).map(|n| [n; 3]).collect(),
            ..Surface::default()
        };
        let lists: [&[u32]; 3] = [&[0, 1, 2], &[1], &[1, 2, 3]];
        let mut cover = Cover { candidates: lists.map(candidate).to_vec(), ..Cover::default() };
        cover.times = vec![0; 4];
        cover.candidates[2].splat.center = DVec3::X;
        [0, 2].into_iter().for_each(|index| cover.add(index));
        let shares = |common: &[bool]| {
            let shares = Owners::of(&cover).shares(&cover, &surface, common);
            [0, 1, 2].map(|of| shares.row(of).to_vec())
        };
        assert_eq!(shares(&[false; 4]), [vec![0, 1], vec![], vec![2, 3]]);
        assert_eq!(shares(&[false, true, false, false]), [vec![0, 1], vec![], vec![1, 2, 3]]);
    }
}
