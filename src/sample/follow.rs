//! Follows the feature lines wherever no chosen splat is cut along them.
//!
//! Splats are cut along a line where it runs through their ellipses. One that ends just before a line, or just
//! beyond, is bounded by its rim there, and so may the next: nothing says that any border passes a place of the
//! line. Where none does within the bound, a splat is added that is cut there.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::budget::Budget;
use super::candidates::Regions;
use super::cover::Cover;
use super::grow::Grower;
use super::owners::Owners;
use super::seal::Task;
use crate::analyse::surface::{NONE, Rows, Surface};
use crate::fit::ellipse::holds;
use crate::model::polyline::{nearest_on, straightened};
use crate::model::splat::Splat;

/// Places looked at along lines, and along borders, lie this share of the tolerance for edges apart.
const STEP: f64 = 0.25;

/// Borders are taken for chains of straight lines that leave them by at most this share of the tolerance.
const STRAIGHT: f64 = 0.01;

/// A place of a feature line that a clipped border has to pass within `reach`.
struct Followed {
    at: DVec3,
    /// Where the side begins that it lies on.
    from: u32,
    reach: f64,
}

impl Task for Followed {
    fn is_done_by(&self, splat: &Splat) -> bool {
        self.is_near(splat) && passes(&borders(splat, self.reach), self.at, self.reach)
    }

    /// That beside the side.
    fn piece(&self, surface: &Surface) -> Option<u32> {
        let to = surface.border_next[self.from as usize];
        let beside = |piece: &u32| surface.pieces[*piece as usize].contains(&to);
        let mut at = surface.pieces_of.row(self.from).iter().copied();
        at.clone().find(beside).or_else(|| at.next())
    }
}

impl Followed {
    /// Whether a splat is cut, and so near that its border may be.
    fn is_near(&self, splat: &Splat) -> bool {
        let reach = splat.bounding_radius() + self.reach;
        !splat.clips.is_empty() && splat.center.distance_squared(self.at) <= reach * reach
    }
}

impl Cover {
    /// Adds splats that are cut along lines where none of the chosen is, once stored; how many. Where none can be
    /// added the line is left as it is.
    pub fn follow(&mut self, grower: &Grower, regions: &Regions) -> usize {
        let bare = self.bare(grower);
        self.seal(grower, regions, &bare)
    }

    /// Places of lines that no border of the chosen passes.
    fn bare(&self, grower: &Grower) -> Vec<Followed> {
        let (surface, Budget { clip, stored, .. }) = (grower.surface, &grower.budget);
        let mut bordered = vec![Vec::new(); self.candidates.len()];
        let own = |&index: &usize| (index, borders(&self.candidates[index].splat, clip.edge));
        let chosen: Vec<_> = self.chosen.par_iter().map(own).collect();
        chosen.into_iter().for_each(|(index, borders)| bordered[index] = borders);
        let passed = |place: &Followed, by: usize| {
            place.is_near(&self.candidates[by].splat) && passes(&bordered[by], place.at, stored.edge)
        };
        // Not every place has a point: there may be more of them.
        let count = surface.places.iter().max().map_or(0, |&last| last as usize + 1);
        let (owners, joined) = (Owners::of(self), Rows::grouped(count, &surface.places));
        let of_side = |from: u32| {
            let beside = beside(surface, &owners, &joined, from);
            let is_bare = move |place: &Followed| !beside.iter().any(|&by| passed(place, by as usize));
            places(surface, from, clip.edge).filter(is_bare)
        };
        let left: Vec<Followed> =
            (0..surface.points.len() as u32).into_par_iter().flat_map_iter(of_side).collect();
        // Nearly all are passed by what lies beside them.
        left.into_par_iter().filter(|place| !self.chosen.iter().any(|&by| passed(place, by))).collect()
    }
}

/// The chosen that cover some of what lies at the ends of a side, on any sheet, ascending; none where no side
/// begins.
fn beside(surface: &Surface, owners: &Owners, joined: &Rows, from: u32) -> Vec<u32> {
    let to = surface.border_next[from as usize];
    let ends = [from, to].into_iter().filter(|_| to != NONE);
    let points = ends.flat_map(|end| joined.row(surface.places[end as usize])).copied();
    let mut owning: Vec<u32> =
        surface.pieces_at(points).into_iter().flat_map(|piece| owners.of_piece(piece)).copied().collect();
    owning.sort_unstable();
    owning.dedup();
    owning
}

/// The clipped borders of a splat, for a tolerance.
fn borders(splat: &Splat, tolerance: f64) -> Vec<[DVec3; 2]> {
    let conics = splat.conics();
    let mut found = Vec::new();
    for (own, conic) in conics.iter().enumerate() {
        let cuts = |uv: DVec2| conics.iter().enumerate().any(|(n, conic)| n != own && conic.cuts(uv));
        let place = |uv: DVec2| (holds(uv, splat.radii) && !cuts(uv)).then(|| splat.surface_point(uv));
        let places: Vec<Option<DVec3>> = conic.walk(STEP * tolerance).into_iter().map(place).collect();
        for run in places.split(Option::is_none).filter(|run| !run.is_empty()) {
            let run: Vec<DVec3> = run.iter().flatten().copied().collect();
            let line = straightened(&run, STRAIGHT * tolerance);
            found.extend(line.windows(2).map(|ends| [ends[0], ends[1]]));
        }
    }
    found
}

/// Whether borders pass a place within a reach.
fn passes(borders: &[[DVec3; 2]], place: DVec3, reach: f64) -> bool {
    borders.iter().any(|&[a, b]| nearest_on(a, b, place).distance_squared(place) <= reach * reach)
}

/// Places along the side of a line that starts at a point; none where a line is only carried on.
fn places(surface: &Surface, from: u32, reach: f64) -> impl Iterator<Item = Followed> + use<> {
    let to = surface.border_next[from as usize];
    let side =
        (to != NONE && !surface.is_carried(from)).then(|| [from, to].map(|point| surface.point(point)));
    side.into_iter().flat_map(move |[a, b]| {
        let count = (a.distance(b) / (STEP * reach)).ceil().max(1.0);
        (0..=count as u32).map(move |n| Followed { at: a.lerp(b, f64::from(n) / count), from, reach })
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::edges::Edges;
    use crate::analyse::split::split;
    use crate::analyse::weld::Welded;
    use crate::fit::clip::Clips;
    use crate::sample::cover::cover;
    use glam::Vec3;

    /// A square of four sides, open all around.
    fn square() -> Surface {
        let positions = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let welded = Welded { positions: positions.to_vec(), triangles, ..Welded::default() };
        split(&welded, &vec![false; Edges::of(&welded.triangles).edges.len()])
    }

    #[test]
    fn lines_are_followed_where_no_border_passes_and_only_there() {
        let surface = square();
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = Grower::new(&surface, Budget::new(0.01, Clips::Curved), &round);
        let regions = Regions::new(surface.points.len());
        let grown = regions.with(|region| grower.grow(0, region)).unwrap();
        let (mut cover, _) = cover(&grower, &regions, vec![grown], 5);
        assert_eq!(cover.follow(&grower, &regions), 0, "it is cut all around");
        for &index in &cover.chosen {
            cover.candidates[index].splat.clips.retain(|clip| clip.ends(DVec2::ONE).0.x < 0.0);
        }
        assert!(cover.follow(&grower, &regions) > 0, "some sides are left to the rim");
        assert_eq!(cover.follow(&grower, &regions), 0, "and followed now");
    }
}
