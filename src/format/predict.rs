//! What the splats already decoded say about the next one.
//!
//! A guess must come out the same in every decoder, so only `+ - * /`, square roots and
//! comparisons of 64-bit floats are used, in the order written.

use glam::{DVec2, DVec3};

use super::grid::Grids;
use super::lead::Lead;
use super::record::{ClipRecord, Record};
use super::{octahedral, turns};
use crate::model::splat::Splat;

/// How many splats back the nearest one is looked for.
pub const WINDOW: usize = 32;

/// A quadric's slope is trusted up to this many radii from its centre.
const TRUST: f64 = 2.0;

/// Guessed sagittas stay within the range of true ones.
const BEND_GUESS: i64 = 1 << 40;

/// A clip curve may follow one of so many before it,
pub const LEAD_WINDOW: usize = 512;

/// of those that pass nearest to its splat.
pub const LEADS: usize = 64;

/// The splats already carried.
#[derive(Clone, Debug, Default)]
pub struct History {
    records: Vec<Record>,
    splats: Vec<Splat>,
    leads: Vec<Lead>,
}

impl History {
    /// Adds a record.
    pub fn push(&mut self, record: Record, grids: &Grids) {
        let splat = grids.splat(&record);
        let lead = |clip: &ClipRecord| Lead::of(&splat, &grids.conic(clip, record.sizes), grids.budget);
        self.leads.extend(record.clips.iter().map(lead));
        self.records.push(record);
        self.splats.push(splat);
    }

    /// Of the last [`LEAD_WINDOW`] clip curves the [`LEADS`] that pass nearest to a place, the nearest first; the
    /// latest of equals.
    #[must_use]
    pub fn leads(&self, place: DVec3) -> Vec<&Lead> {
        let recent = &self.leads[self.leads.len().saturating_sub(LEAD_WINDOW)..];
        let mut away: Vec<(f64, usize)> =
            recent.iter().rev().map(|lead| lead.distance_squared(place)).zip(0..).collect();
        let order =
            |one: &(f64, usize), other: &(f64, usize)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
        if away.len() > LEADS {
            away.select_nth_unstable_by(LEADS, order);
            away.truncate(LEADS);
        }
        away.sort_unstable_by(order);
        away.into_iter().map(|(_, back)| &recent[recent.len() - 1 - back]).collect()
    }

    /// The splats.
    #[must_use]
    pub fn into_splats(self) -> Vec<Splat> {
        self.splats
    }

    /// The record before the next.
    #[must_use]
    pub fn last(&self) -> Option<&Record> {
        self.records.last()
    }

    /// A record by its number.
    #[must_use]
    pub fn record(&self, number: usize) -> &Record {
        &self.records[number]
    }

    /// A splat by its number.
    #[must_use]
    pub fn splat(&self, number: usize) -> &Splat {
        &self.splats[number]
    }

    /// Of the last [`WINDOW`] splats, the one whose centre is nearest; the latest of equals.
    #[must_use]
    pub fn nearest(&self, place: DVec3) -> Option<usize> {
        let mut best = None;
        let mut least = f64::INFINITY;
        for number in (self.splats.len().saturating_sub(WINDOW)..self.splats.len()).rev() {
            let d = self.splats[number].center - place;
            let square = d.x * d.x + d.y * d.y + d.z * d.z;
            if square < least {
                (best, least) = (Some(number), square);
            }
        }
        best
    }
}

/// The direction of a splat's normal field beside a place; not of unit length.
#[must_use]
pub fn normal_near(splat: &Splat, place: DVec3) -> DVec3 {
    let d = place - splat.center;
    let (i, j, k) = (splat.axes.x_axis, splat.axes.y_axis, splat.axes.z_axis);
    let across = |axis: DVec3, radius: f64| {
        let along = d.x * axis.x + d.y * axis.y + d.z * axis.z;
        along.max(-TRUST * radius).min(TRUST * radius)
    };
    let slope_u = 2.0 * splat.curvature.x * across(i, splat.radii.x);
    let slope_v = 2.0 * splat.curvature.y * across(j, splat.radii.y);
    k - slope_u * i - slope_v * j
}

/// The sagittas a splat's curvatures give over these radii, in steps of `step` (model units).
#[must_use]
pub fn bend_near(splat: &Splat, radii: DVec2, step: f64) -> [i64; 2] {
    // A float cast saturates, so a far-off guess is only a bad guess.
    let steps = |curvature: f64, radius: f64| (curvature * (radius * radius) / step + 0.5).floor() as i64;
    let clamped = |steps: i64| steps.clamp(-BEND_GUESS, BEND_GUESS);
    [clamped(steps(splat.curvature.x, radii.x)), clamped(steps(splat.curvature.y, radii.y))]
}

/// The turn that brings `i` of a frame about `k` next to a splat's `i`, in `2^bits` steps of
/// half a turn, rounded down.
#[must_use]
pub fn spin_near(splat: &Splat, k: DVec3, bits: u32) -> u64 {
    let (i0, j0) = octahedral::basis(k);
    let i = splat.axes.x_axis;
    let x = i.x * i0.x + i.y * i0.y + i.z * i0.z;
    let y = i.x * j0.x + i.y * j0.y + i.z * j0.z;
    let (x, y) = if y < 0.0 { (-x, -y) } else { (x, y) };
    // The last step whose direction is not beyond (x, y), by halving.
    let (mut low, mut high) = (0, 1_u64 << bits);
    while high - low > 1 {
        let middle = (low + high) / 2;
        let (sin, cos) = turns::sin_cos(middle, 2 << bits);
        if cos * y - sin * x >= 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::planted::{Random, on_bumpy};

    #[test]
    fn a_splat_guesses_itself() {
        let mut random = Random(2);
        for _ in 0..500 {
            let splat = on_bumpy(random.direction(), 1e-3, 30.0);
            let k = splat.axes.z_axis;
            assert!(normal_near(&splat, splat.center).distance(k) < 1e-15);
            let beside = DVec2::new(0.3, -0.2) * splat.radii;
            let guess = normal_near(&splat, splat.surface_point(beside)).normalize();
            assert!(guess.distance(splat.normal(beside)) < 1e-12);
            let step = 1e-4;
            let sagitta = splat.curvature * splat.radii * splat.radii / step;
            let steps = bend_near(&splat, splat.radii, step);
            assert!((sagitta - DVec2::new(steps[0] as f64, steps[1] as f64)).abs().max_element() <= 0.5);
            let (i0, j0) = octahedral::basis(k);
            let (sin, cos) = turns::sin_cos(spin_near(&splat, k, 12), 2 << 12);
            let i = cos * i0 + sin * j0;
            let off = i.cross(splat.axes.x_axis).length();
            assert!(off <= std::f64::consts::PI / 4096.0, "{off}");
        }
    }
}
