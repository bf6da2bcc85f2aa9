//! Where a cloud's points lie too far apart to tell how its surface bends between them.
//!
//! Every place of the surface has a point within that point's margin, and splats that cover all points leave no
//! hole. How far they lie off the surface between the points is another matter: where normals turn from a point to the
//! next, the surface may be round or have a crease there, and the two differ by as much as the disc of a point lies off
//! the surface at its rim, its sagitta. Where that is below the bound, a splat that fits the points keeps it between
//! them as well; whoever bakes a cloud wants to know where it is not.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::model::discs::Disc;

/// Points around which a cloud's surface bends by more than a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sparse {
    /// How many there are.
    pub points: usize,
    /// The one around which it bends the most, model units.
    pub worst: DVec3,
    /// By how much there, model units.
    pub by: f64,
}

impl Sparse {
    /// Those of points with their discs whose sagittas are above a bound, model units; `None` where none is.
    pub(super) fn of(discs: impl IndexedParallelIterator<Item = (Vec3, Disc)>, bound: f64) -> Option<Self> {
        let bent = discs.filter_map(|(at, disc)| {
            let by = f64::from(disc.sagitta());
            (by > bound).then_some(Self { points: 1, worst: at.as_dvec3(), by })
        });
        bent.reduce_with(|a, b| {
            // Of points that bend alike the first, however they are split among threads.
            let worst = if b.by > a.by { b } else { a };
            Self { points: a.points + b.points, ..worst }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_whose_discs_bend_by_more_than_the_bound_are_counted_and_the_first_worst_is_told() {
        let disc = |turn: f32| Disc { margin: 0.2, turn, ..Disc::default() };
        let turns = [0.01, 0.3, 0.1, 0.3, 0.05];
        let discs: Vec<(Vec3, Disc)> =
            (0_u8..).zip(turns).map(|(n, turn)| (f32::from(n) * Vec3::X, disc(turn))).collect();
        let found = |bound: f64| Sparse::of(discs.clone().into_par_iter(), bound);
        let sparse = found(0.009);
        assert!(sparse.is_some_and(|sparse| sparse.points == 3 && sparse.worst == DVec3::X));
        assert!(sparse.is_some_and(|sparse| (sparse.by - 0.03).abs() < 1e-8));
        assert_eq!(found(0.031), None);
    }
}
