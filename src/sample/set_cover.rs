//! Weighted set covers: which candidates cover every piece at the least cost.
//!
//! Nobody finds the optimum in time, but prices on pieces, which an [`ascent`] finds, bound it from
//! below.

mod alike;
mod ascent;
mod decisive;

use crate::analyse::surface::Rows;
use alike::unlike;
use decisive::decisive;

/// Candidates and the pieces that are to be covered, each by one candidate at least.
pub(super) struct SetCover {
    /// For each candidate what it costs, above zero.
    costs: Vec<f64>,
    /// For each candidate the pieces it covers, ascending.
    sets: Rows,
    /// For each piece the candidates that cover it, ascending.
    covering: Rows,
    pieces: usize,
}

impl SetCover {
    /// The pieces that decide ([`decisive`]), numbered anew in their order: what covers these covers
    /// every piece that some candidate covers. `covered` lists the pieces of each candidate.
    pub(super) fn of_decisive(costs: Vec<f64>, covered: &[&[u32]], pieces: usize) -> Self {
        let unlike = unlike(covered, pieces);
        let covering = covering(covered, &unlike, pieces);
        let kept = decisive(&covering, unlike.len(), costs.len());
        Self::over(costs, kept.len(), |piece| covering.row(kept[piece as usize]).iter().copied())
    }

    /// Pieces each of which is covered by some candidates, ascending.
    fn over<I: Iterator<Item = u32>>(costs: Vec<f64>, pieces: usize, row: impl Fn(u32) -> I) -> Self {
        let covering = Rows::placed(pieces, || {
            (0..pieces as u32).flat_map(|piece| row(piece).map(move |index| (piece, index)))
        });
        let sets = Rows::placed(costs.len(), || {
            (0..pieces as u32).flat_map(|piece| covering.row(piece).iter().map(move |&index| (index, piece)))
        });
        Self { costs, sets, covering, pieces }
    }
}

/// For each of some of the pieces the candidates that cover it, ascending.
fn covering(covered: &[&[u32]], some: &[u32], pieces: usize) -> Rows {
    let mut places = vec![None; pieces];
    (0_u32..).zip(some).for_each(|(place, &piece)| places[piece as usize] = Some(place));
    Rows::placed(some.len(), || {
        let candidates = (0_u32..).zip(covered);
        candidates.flat_map(|(index, pieces)| {
            let kept = pieces.iter().filter_map(|&piece| places[piece as usize]);
            kept.map(move |place| (place, index))
        })
    })
}
