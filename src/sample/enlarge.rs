//! Enlarges a domain as long as it keeps the budget and reaches more of the surface.
//!
//! First it grows as a whole, then along each axis to both sides, at last to one side alone: where the
//! surface bends away, or splats cannot be cut along a border, on one side of a seed, the others may go on.
//! For this files of seven models and clouds are up to 8 % smaller, 3 % in the mean, in about the same time.

use glam::{DVec2, DVec3};

use super::grow::{Domain, Grower};
use super::region::Region;
use crate::fit::clip::Clips;
use crate::fit::pose::Pose;

/// Factors by which a round domain grows, each while it succeeds.
const ROUND_STEPS: [f64; 3] = [1.5, 1.2, 1.07];

/// The factor by which one radius grows, while it succeeds. With finer ones after it, which leave less to grow to
/// one side, files are 2 % larger.
const STRETCH_STEP: f64 = 1.6;

/// Shares of a radius by which a domain goes on to one side, each while it succeeds. A third step, of 0.1, makes
/// files no smaller; nor do domains that give up half of what they gain, or as much, on the other side.
const SIDE_STEPS: [f64; 2] = [0.5, 0.2];

/// The sides of a domain.
const SIDES: [DVec2; 4] = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];

/// Steps of growth that may pass before a new point of the surface is reached.
const PATIENCE: usize = 4;

/// No radius grows beyond this, in model units: the model lies within `[-1, 1]³`.
const LONGEST_RADIUS: f64 = 4.0;

/// A splat that partners cut reaches at most this many times as far along each axis as what it
/// covers: all of it beyond a line shows that no partner cuts, and they are made for places near
/// the line. (An ellipse around a rectangle reaches 1.42 times as far.)
const MOST_REACH: f64 = 3.0;

impl Grower<'_> {
    /// A domain grown as long as it keeps the budget and reaches more of the surface.
    pub(super) fn enlarged(&self, least: Domain, seeds: &[u32], region: &mut Region) -> Domain {
        let around = self.grown_around(least, seeds, region);
        self.grown_aside(around, seeds, region)
    }

    /// The same around its centre: as a whole, then along each axis.
    pub(super) fn grown_around(&self, mut best: Domain, seeds: &[u32], region: &mut Region) -> Domain {
        for step in ROUND_STEPS {
            while self.grows(&mut best, DVec2::splat(step), seeds, region) {}
        }
        let [along, across] = [DVec2::new(STRETCH_STEP, 1.0), DVec2::new(1.0, STRETCH_STEP)];
        while self.grows(&mut best, along, seeds, region) || self.grows(&mut best, across, seeds, region) {}
        best
    }

    /// The same to each side by itself.
    pub(super) fn grown_aside(&self, mut best: Domain, seeds: &[u32], region: &mut Region) -> Domain {
        for share in SIDE_STEPS {
            let mut open = SIDES.to_vec();
            while !open.is_empty() {
                open.retain(|side| self.goes_on(&mut best, share * side, seeds, region));
            }
        }
        best
    }

    /// Whether a domain grows by these factors of its radii.
    fn grows(&self, best: &mut Domain, factors: DVec2, seeds: &[u32], region: &mut Region) -> bool {
        let mut grown = best.clone();
        // A domain that grows over nothing but what is cut away gains nothing, but the next point of the
        // surface may lie a few steps off.
        for _ in 0..PATIENCE {
            let Some(domain) = self.larger(&grown, &grown.pose, grown.radii * factors, seeds, region) else {
                return false;
            };
            grown = domain;
            if grown.members > best.members {
                *best = grown;
                return true;
            }
        }
        false
    }

    /// Whether a domain goes on to one side, by shares of its radii; where it ends on the other, it stays.
    fn goes_on(&self, best: &mut Domain, side: DVec2, seeds: &[u32], region: &mut Region) -> bool {
        let shift = 0.5 * side * best.radii;
        let pose = moved(best, shift);
        match self.larger(best, &pose, best.radii + shift.abs(), seeds, region) {
            Some(domain) if domain.members > best.members => {
                *best = domain;
                true
            }
            _ => false,
        }
    }

    /// A domain at another pose, with larger radii, if these are not too large and it keeps the budget.
    fn larger(
        &self,
        grown: &Domain,
        pose: &Pose,
        radii: DVec2,
        seeds: &[u32],
        region: &mut Region,
    ) -> Option<Domain> {
        let too_large = radii.max_element() > LONGEST_RADIUS || self.overreaches(radii, grown);
        if too_large { None } else { self.attempt(pose, radii, seeds, region).ok() }
    }

    /// Whether a domain would grow too far beyond what it covers for its partners to cut it.
    fn overreaches(&self, radii: DVec2, grown: &Domain) -> bool {
        let beyond = (radii - MOST_REACH * grown.extent).cmpgt(DVec2::ZERO) & radii.cmpgt(grown.radii);
        self.budget.clip.clips == Clips::Partners && beyond.any()
    }
}

/// The pose of a domain with its centre moved over its quadric.
fn moved(Domain { pose, curvature, .. }: &Domain, shift: DVec2) -> Pose {
    let lift: DVec3 = shift.extend((curvature * shift * shift).element_sum());
    Pose { center: pose.center + pose.axes * lift, axes: pose.axes }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::model::splat::Splat;
    use crate::sample::budget::Budget;
    use crate::sample::exchange::tests::sheet;

    /// Where a sheet folds: along a row of its points.
    const FOLD: f64 = 27.0 / 39.0;

    /// How steeply. Over gentler folds splats bend a little, which ends their growth to the other side early.
    const SLOPE: f64 = 5.0;

    #[test]
    fn seeds_beside_a_fold_grow_over_all_that_lies_on_their_side() {
        // No line follows the fold.
        let surface = sheet(|x, _| SLOPE * (x - FOLD).max(0.0));
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = Grower::new(&surface, Budget::new(0.004, Clips::Curved), &round);
        let pieces = 0..surface.pieces.len() as u32;
        let beside = pieces.clone().filter(|&piece| surface.middle(piece).x < FOLD).count();
        for seed in [0.3, 0.5, 0.7].map(|y| DVec3::new(FOLD - 0.1, y, 0.0)) {
            let far = |piece: u32| surface.middle(piece).distance(seed);
            let piece = pieces.clone().min_by(|&a, &b| far(a).total_cmp(&far(b))).unwrap();
            let grown = grower.grow(piece, &mut Region::new(surface.points.len())).unwrap();
            // Around its centre alone each grows over less than a third of these.
            assert!(grown.pieces.len() > 9 * beside / 10, "{} of {beside} from {seed}", grown.pieces.len());
        }
    }
}
