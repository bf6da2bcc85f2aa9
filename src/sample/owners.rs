//! Which of the chosen splats cover each piece, and so which are neighbours.

use super::cover::Cover;
use crate::analyse::surface::Rows;

/// For each piece, the chosen splats that cover it, in the order in which they were.
pub(super) struct Owners(Rows);

impl Owners {
    /// Those of a cover as it is now.
    pub(super) fn of(cover: &Cover) -> Self {
        let owned =
            |&index: &usize| cover.candidates[index].pieces.iter().map(move |&piece| (piece, index as u32));
        Self(Rows::placed(cover.times.len(), || cover.chosen.iter().flat_map(owned)))
    }

    /// For each candidate of the cover, the pieces that it alone covers, ascending; none if it is not chosen.
    pub(super) fn alone(&self, cover: &Cover) -> Rows {
        let pieces = 0..cover.times.len() as u32;
        Rows::placed(cover.candidates.len(), || {
            pieces.clone().filter_map(|piece| match self.0.row(piece) {
                &[owner] => Some((owner, piece)),
                _ => None,
            })
        })
    }

    /// The pieces of one splat that no third covers beside it and another, ascending.
    pub(super) fn shared<'a>(
        &'a self,
        cover: &'a Cover,
        [one, other]: [usize; 2],
    ) -> impl Iterator<Item = u32> + 'a {
        let by_both = move |piece: &u32| {
            let row = self.0.row(*piece);
            row.len() == 2 && row.contains(&(other as u32))
        };
        cover.candidates[one].pieces.iter().copied().filter(by_both)
    }

    /// Those that cover some of what one splat of the cover covers, the nearest centre first.
    pub(super) fn neighbours(&self, cover: &Cover, index: usize) -> Vec<usize> {
        let pieces = cover.candidates[index].pieces.iter();
        let mut near: Vec<u32> = pieces.flat_map(|&piece| self.0.row(piece)).copied().collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::cover::tests::candidate;
    use glam::DVec3;

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
}
