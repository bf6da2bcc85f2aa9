//! Closes the holes that a cover leaves where it is looked at from the side.
//!
//! Splats over neighbouring pieces overlap, but where one lies as low as it may and the next as high,
//! a ray at a slant can pass between them. How far they would have to overlap for no ray to pass grows
//! without bound towards level rays, so rays that do pass are closed one by one instead.

use rayon::prelude::*;

use super::candidates::Regions;
use super::cover::Cover;
use super::grow::Grower;
use super::polygon;
use super::region::Region;
use super::settle::Candidate;
use crate::analyse::canonical::mix;
use crate::analyse::surface::Surface;
use crate::model::sight::Sight;
use crate::model::splat::Splat;

/// Tasks for which splats are grown side by side before it is seen which are still open. Batches are
/// of the same size whatever the threads, so that the result is the same too.
const BATCH: usize = 16;

/// Shares of the budget for splats that are to stop a ray: one that may sink by all of it can pass below
/// a ray that grazes the surface. Below these, rounding takes what is left.
const NEARER: [f64; 3] = [1.0, 0.5, 0.25];

/// What some splat has to do.
pub trait Task: Sync {
    /// Whether a splat does it.
    fn is_done_by(&self, splat: &Splat) -> bool;
    /// The piece that one would cover which does it, if there is any.
    fn piece(&self, surface: &Surface) -> Option<u32>;
}

impl Task for Sight {
    fn is_done_by(&self, splat: &Splat) -> bool {
        self.is_stopped(splat)
    }

    /// That where the ray meets the surface.
    fn piece(&self, surface: &Surface) -> Option<u32> {
        let distance = |piece: u32| surface.distance_squared(piece, self.at);
        (0..surface.pieces.len() as u32).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    }
}

impl Cover {
    /// Adds the cheapest splats known that do some tasks, such as to stop rays, which none of the chosen does
    /// once stored, or such as grow where the tasks lie; how many. A task that not even these do stays open.
    pub fn seal<T: Task>(&mut self, grower: &Grower, regions: &Regions, tasks: &[T]) -> usize {
        if tasks.is_empty() {
            return 0;
        }
        let mut done = self.done_by_others(tasks);
        let mut open = undone(&done, tasks.len());
        while !open.is_empty() {
            let batch = open.split_off(open.len().saturating_sub(BATCH));
            let grown: Vec<Option<Candidate>> =
                batch.par_iter().map(|&task| self.grown_at(grower, regions, &tasks[task])).collect();
            for candidate in grown.into_iter().flatten() {
                open.retain(|&task| !tasks[task].is_done_by(&candidate.splat));
                done.push((self.candidates.len(), done_by(&candidate, tasks)));
                self.candidates.push(candidate);
            }
        }
        let added = self.cheapest(&done, tasks.len());
        for &index in &added {
            self.add(index);
        }
        added.len()
    }

    /// Candidates that are not chosen, each with the tasks it does, ascending, if any.
    fn done_by_others<T: Task>(&self, tasks: &[T]) -> Vec<(usize, Vec<u32>)> {
        let mut chosen = vec![false; self.candidates.len()];
        self.chosen.iter().for_each(|&index| chosen[index] = true);
        let others = self.candidates.par_iter().enumerate().filter(|&(index, _)| !chosen[index]);
        others
            .map(|(index, candidate)| (index, done_by(candidate, tasks)))
            .filter(|(index, done)| !done.is_empty() && self.is_inside(&self.candidates[*index]))
            .collect()
    }

    /// A splat grown where a task lies, the largest that does it, or else one over the piece there alone.
    fn grown_at<T: Task>(&self, grower: &Grower, regions: &Regions, task: &T) -> Option<Candidate> {
        let piece = task.piece(grower.surface)?;
        let serves = |made: &Candidate| task.is_done_by(&made.splat) && self.is_inside(made);
        let made = |make: Make| made_within(&NEARER, grower, regions, (make, piece), serves);
        made(grown).or_else(|| made(polygon::over)).or_else(|| made(polygon::wide))
    }
}

/// The tasks that a candidate does, ascending.
fn done_by<T: Task>(candidate: &Candidate, tasks: &[T]) -> Vec<u32> {
    let numbered = (0_u32..).zip(tasks);
    numbered.filter(|(_, task)| task.is_done_by(&candidate.splat)).map(|(n, _)| n).collect()
}

/// The tasks that no candidate does, strewn: one splat may do those next to each other.
fn undone(done: &[(usize, Vec<u32>)], tasks: usize) -> Vec<usize> {
    let mut open = vec![true; tasks];
    done.iter().flat_map(|(_, done)| done).for_each(|&task| open[task as usize] = false);
    let mut open: Vec<usize> = (0..tasks).filter(|&task| open[task]).collect();
    open.sort_unstable_by_key(|&task| mix(task as u64));
    open
}

/// The largest splat around a piece: [`Grower::grow`].
pub(super) fn grown(grower: &Grower<'_>, piece: u32, region: &mut Region) -> Option<Candidate> {
    grower.grow(piece, region)
}

/// A way to make a splat over a piece: [`grown`], [`polygon::over`] or [`polygon::wide`].
pub(super) type Make = fn(&Grower<'_>, u32, &mut Region) -> Option<Candidate>;

/// The splat made over a piece that serves once it is stored, within the first of some shares of the budget.
pub(super) fn made_within(
    shares: &[f64],
    grower: &Grower,
    regions: &Regions,
    (make, piece): (Make, u32),
    serves: impl Fn(&Candidate) -> bool,
) -> Option<Candidate> {
    shares.iter().find_map(|&share| {
        let nearer = Grower { budget: grower.budget.scaled(share), ..*grower };
        regions.with(|region| make(&nearer, piece, region)).map(|made| made.stored(grower)).filter(&serves)
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::analyse::surface::{NONE, Rows, Spot};
    use crate::fit::clip::Clips;
    use crate::model::clip_curve::ClipCurve;
    use crate::sample::budget::Budget;
    use crate::sample::cover::tests::candidate;
    use glam::{DVec2, DVec3, Vec3};

    /// Grows nothing, since nothing can be stored.
    pub(in crate::sample) fn fruitless(surface: &Surface) -> Grower<'_> {
        Grower::new(surface, Budget::new(0.01, Clips::Curved), &|_, _| None)
    }

    /// One point of a cloud, at the origin, that stands for 0.1 around it, joined to two that no splat reaches
    /// over together.
    pub(in crate::sample) fn lone_spot() -> Surface {
        Surface {
            points: vec![Vec3::ZERO, Vec3::new(0.09, 0.0, 0.05), Vec3::new(0.09, 0.0, -0.05)],
            places: vec![0, 1, 2],
            normals: vec![Vec3::Z; 3],
            neighbours: Rows::symmetric(3, |row| [1, 2].into_iter().filter(move |_| row == 0)),
            pieces: vec![[0; 3]],
            spots: vec![Spot { position: Vec3::ZERO, margin: 0.1 }],
            pieces_of: Rows::consecutive(&[1, 0, 0]),
            margin: vec![0.1, 0.0, 0.0],
            border_next: vec![NONE; 3],
            border_prev: vec![NONE; 3],
            ..Surface::default()
        }
    }

    /// Discs of a radius in the plane, at places on the x axis; the first is chosen.
    fn cover(discs: &[(f64, f64)]) -> Cover {
        let mut candidates = vec![candidate(&[0]); discs.len()];
        for (candidate, &(x, radius)) in candidates.iter_mut().zip(discs) {
            candidate.splat.center = x * DVec3::X;
            candidate.splat.radii = DVec2::splat(radius);
        }
        Cover { candidates, chosen: vec![0], times: vec![1], areas: vec![1.0], ..Cover::default() }
    }

    /// Seen from above at places on the x axis.
    fn sights(places: &[f64]) -> Vec<Sight> {
        let sight = |&x: &f64| Sight { at: x * DVec3::X, direction: DVec3::NEG_Z, beyond: 0.1 };
        places.iter().map(sight).collect()
    }

    fn seal(cover: &mut Cover, places: &[f64]) -> usize {
        let surface = Surface::default();
        cover.seal(&fruitless(&surface), &Regions::new(0), &sights(places))
    }

    #[test]
    fn the_fewest_that_stop_all_rays_are_added() {
        let mut cover = cover(&[(0.0, 1.0), (2.0, 0.2), (3.0, 0.2), (2.5, 0.7), (9.0, 1.0)]);
        assert_eq!((seal(&mut cover, &[2.0, 3.0]), cover.chosen.as_slice()), (1, &[0, 3][..]));
        assert_eq!(cover.times, [2]);
        assert_eq!((seal(&mut cover, &[2.1, 8.5]), cover.chosen.as_slice()), (2, &[0, 3, 1, 4][..]));
    }

    #[test]
    fn where_none_can_be_grown_a_piece_gets_one_of_its_own() {
        let surface = lone_spot();
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = Grower::new(&surface, Budget::new(0.01, Clips::Curved), &round);
        assert!(grown(&grower, 0, &mut Region::new(3)).is_none());
        let mut cover = cover(&[(3.0, 1.0)]);
        assert_eq!(cover.seal(&grower, &Regions::new(3), &sights(&[0.09])), 1);
        assert!(cover.candidates[cover.chosen[1]].last_resort);
    }

    #[test]
    fn splats_are_judged_as_they_are_stored() {
        let cut = |splat: &Splat, angle: f64| Splat {
            clips: vec![ClipCurve::chord(angle, std::f64::consts::PI - angle)],
            ..splat.clone()
        };
        let surface = lone_spot();
        let round = |splat: &Splat, _: u8| Some(cut(splat, 0.2));
        let grower = Grower::new(&surface, Budget::new(0.01, Clips::Curved), &round);
        let made = |_: &Grower<'_>, _: u32, _: &mut Region| {
            let whole = candidate(&[0]);
            Some(Candidate {
                splat: Splat { clips: vec![ClipCurve::chord(0.3, 2.0)], ..whole.splat },
                ..whole
            })
        };
        // Between the two chords.
        let keeps = |made: &Candidate| !made.splat.covers(DVec2::new(0.0, 0.25));
        assert!(made_within(&[1.0], &grower, &Regions::new(3), (made, 0), keeps).is_some());
        let mut cover = cover(&[(0.0, 1.0), (3.0, 1.0)]);
        cover.candidates[0].splat.clips = vec![ClipCurve::chord(0.3, 2.0)];
        let uncut = cover.candidates[1].splat.clone();
        cover.store(&grower);
        assert_eq!(cover.candidates[0].splat, cut(&cover.candidates[0].splat, 0.2));
        assert_eq!(cover.candidates[1].splat, uncut, "what was rounded and not cut is stored as it is");
    }

    #[test]
    fn a_ray_that_nothing_stops_stays_open() {
        let mut cover = cover(&[(0.0, 1.0), (2.0, 0.2)]);
        assert_eq!((seal(&mut cover, &[5.0]), seal(&mut cover, &[])), (0, 0));
        assert_eq!(cover.chosen, [0]);
    }
}
