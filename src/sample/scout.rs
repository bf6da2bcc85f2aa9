//! How far splats reach over each piece of a mesh, before any is chosen.
//!
//! A splat covers a piece whole or not at all, so of its domain a rim about a piece wide is lost. Pieces
//! that are small beside the splats over them lose less, but all pieces cost time: so first a few
//! splats are grown, and pieces are halved until they are small beside those.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::candidates::{Regions, Seeds};
use super::grow::{Domain, Grower};
use super::region::Region;
use crate::analyse::surface::NONE;

/// Edges of pieces are to be no longer than this share of the radius, in their direction, of the splat
/// over them. At 0.25 files of scans are up to 5 % smaller, and take up to 40 % longer to bake.
const EDGE_SHARE: f64 = 0.35;

/// A domain over fewer pieces than this lies on facets that bend by more than the bound. There a splat a
/// facet, cut along its sides, is cheapest, and halves of it would each take one.
const FEWEST: usize = 12;

/// Splats begun: domains grown, each over the middle of a piece.
#[derive(Default)]
pub struct Begun {
    pub(super) domains: Vec<(Domain, u32)>,
}

/// Domains over a surface, and which of them lies over each piece.
pub struct Scouted {
    domains: Vec<(Domain, u32)>,
    over: Vec<u32>,
}

impl Scouted {
    /// Whether an edge of a piece is long beside the domain over that.
    #[must_use]
    pub fn is_long(&self, piece: u32, way: DVec3) -> bool {
        self.domains.get(self.over[piece as usize] as usize).is_some_and(|(domain, _)| {
            let along = DVec2::new(domain.pose.axes.x_axis.dot(way), domain.pose.axes.y_axis.dot(way));
            (along / domain.radii).length() > EDGE_SHARE
        })
    }

    /// The domains as splats begun over a surface refined by this; `part_of` tells for each of its pieces
    /// of which piece it is a part.
    #[must_use]
    pub fn begun(self, part_of: &[u32]) -> Begun {
        let part = |piece: u32| part_of.partition_point(|&whole| whole < piece) as u32;
        Begun { domains: self.domains.into_iter().map(|(domain, piece)| (domain, part(piece))).collect() }
    }

    fn add(&mut self, domain: Domain, piece: u32, covered: &[u32]) {
        if covered.len() >= FEWEST {
            let area = |domain: &Domain| domain.radii.element_product();
            for &piece in covered {
                let over = &mut self.over[piece as usize];
                let other = self.domains.get(*over as usize);
                if other.is_none_or(|(other, _)| area(other) < area(&domain)) {
                    *over = self.domains.len() as u32;
                }
            }
        }
        self.domains.push((domain, piece));
    }
}

/// Grows domains until one covers every piece for which that succeeds.
///
/// `advance` is told how many pieces are done.
pub fn scout(grower: &Grower, regions: &Regions, mut advance: impl FnMut(usize)) -> Scouted {
    let pieces = grower.surface.pieces.len();
    let mut scouted = Scouted { domains: Vec::new(), over: vec![NONE; pieces] };
    let mut seeds = Seeds::over(pieces);
    while let Some(batch) = seeds.next_batch() {
        let grow = |&piece: &u32| {
            regions.with(|region| {
                let domain = grower.domain(piece, region)?;
                let covered = covered(grower, &domain, piece, region);
                Some((domain, piece, covered))
            })
        };
        let grown: Vec<Option<(Domain, u32, Vec<u32>)>> = batch.par_iter().map(grow).collect();
        for (domain, piece, covered) in grown.into_iter().flatten() {
            scouted.add(domain, piece, &covered);
            seeds.done(covered);
        }
        advance(seeds.passed());
    }
    scouted
}

/// The pieces whose corners a domain covers.
fn covered(grower: &Grower, domain: &Domain, piece: u32, region: &mut Region) -> Vec<u32> {
    let surface = grower.surface;
    if !region.gather(surface, &domain.pose, domain.radii, &surface.pieces[piece as usize]) {
        return Vec::new();
    }
    let near = region.members.iter().filter(|member| grower.near(domain.curvature, member.local, 1.0));
    let near: Vec<u32> = near.map(|member| member.point).collect();
    region.mark_only(&near);
    let mut pieces = surface.pieces_at(near.into_iter());
    pieces.retain(|&piece| region.marks_all(&surface.pieces[piece as usize]));
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn domain(radii: DVec2) -> Domain {
        Domain { radii, ..Domain::default() }
    }

    fn scouted(pieces: usize) -> Scouted {
        Scouted { domains: Vec::new(), over: vec![NONE; pieces] }
    }

    #[test]
    fn edges_are_as_long_as_the_splat_in_their_direction_allows() {
        let mut scouted = scouted(FEWEST + 1);
        let covered: Vec<u32> = (0..FEWEST as u32).collect();
        scouted.add(domain(DVec2::new(4.0, 1.0)), 0, &covered);
        let [along, across] = [DVec3::X, DVec3::Y].map(|way| 0.5 * way);
        assert!(!scouted.is_long(0, along) && scouted.is_long(0, across));
        assert!(!scouted.is_long(FEWEST as u32, 100.0 * across), "over this piece there is none");
        scouted.add(domain(DVec2::splat(3.0)), 0, &covered);
        assert!(!scouted.is_long(0, across), "the larger counts");
        scouted.add(domain(DVec2::splat(9.0)), 0, &covered[1..]);
        assert!(!scouted.is_long(1, across) && scouted.is_long(1, 3.0 * across), "but not over few pieces");
    }

    #[test]
    fn what_is_begun_starts_from_a_part_of_its_piece() {
        let mut scouted = scouted(3);
        (0..3).for_each(|piece| scouted.add(domain(DVec2::ONE), piece, &[piece]));
        let pieces = |begun: Begun| begun.domains.into_iter().map(|(_, piece)| piece).collect::<Vec<u32>>();
        assert_eq!(pieces(scouted.begun(&[0, 0, 0, 1, 2, 2])), [0, 3, 4]);
    }
}
