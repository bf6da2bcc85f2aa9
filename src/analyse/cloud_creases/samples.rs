//! Places on creases, each found from the points around one point of the cloud.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::bowl;
use super::hinge::Hinge;
use super::plane::Moments;
use crate::analyse::nearest::{NEAREST, Nearest, Spacings, listed};

/// A place on a crease, model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Where.
    pub(super) place: DVec3,
    /// Unit vector along the crease, of either sign.
    pub(super) along: DVec3,
    /// Unit vector that halves the angle between the two sides: into a ridge, out of a groove.
    pub(super) between: DVec3,
    /// Cosine of the angle by which the surface turns.
    pub(super) turn: f64,
    /// As [`Hinge::rounded`], in a neighbourhood as large as noise calls for; 0 in one that is no larger than
    /// it is without, in which curved sides may count for more than the noise.
    pub(super) rounded: f64,
    /// As [`Hinge::scatter`], beyond what the noise may be: squares of the spacing.
    pub(super) left: f64,
    /// Whether its nearest points alone show it, and leave something to explain: near a corner they may lean on the
    /// third face.
    pub(super) doubtful: bool,
    /// Radius of the whole neighbourhood looked at, though its nearest points alone may show it.
    pub(super) size: f64,
}

/// Points that scatter about their plane by less than this share of the spacing, beyond what noise
/// does, lie on no crease: within half a spacing of one of 30° they scatter by 0.13, on a sphere of
/// eight spacings by 0.1.
const ROUGH: f64 = 0.1;

/// Of the variance that noise has, what few points show of it, at least: they fit their plane better
/// than they do the surface.
const ROUGH_NOISE: f64 = 0.7;

/// The same where noise calls for more than [`FEWEST`] points: by chance their scatter differs from that
/// of the noise by a tenth.
const ROUGH_AMONG_MANY: f64 = 1.1;

/// Points looked at around one: a few spacings in all directions.
const FEWEST: f64 = 32.0;

/// Of these the nearest, which are looked at alone where all show no crease: a third face may lie that near, such as
/// the other side of a wall of three spacings.
const CLOSE: usize = 20;

/// A hinge misses so few by less than this share of the spacing, root mean square, beyond what noise does: as curved
/// sides may be missed. One that leaves more to explain leans on points of a third face: without this bound, files of
/// abc-00000049 and of a rack with many edges are 3 to 5 % larger.
const UNEXPLAINED: f64 = 0.1;

/// A hinge that misses points by less than this share of the spacing, beyond what noise does, explains them.
const NOTHING: f64 = 0.01;

/// The most, so that the work stays bounded.
const MOST: f64 = 160.0;

/// The neighbourhood's radius in standard deviations of the noise, so that the slopes of half of it
/// are known to a few degrees.
const ABOVE_NOISE: f64 = 13.0;

/// Noise of more than this many spacings drowns what few points show.
const DROWNED: f64 = 1.0;

/// Points farther from either half plane than this many spacings are not explained by it...
pub(super) const CUTOFF: f64 = 0.5;

/// ... or than this many standard deviations of the noise.
pub(super) const STRAY: f64 = 3.0;

/// The share of the points that the two half planes must explain.
const EXPLAINED: f64 = 0.75;

/// The share of the points that either side must hold: half a neighbourhood whose middle lies off the
/// crease as far as it may holds 0.28.
const SIDE_SHARE: f64 = 0.15;

/// The number of points that either side must hold, so that its plane says more than its points: three
/// lie on one whatever they are of.
pub(super) const SIDE_POINTS: usize = 6;

/// Variance, in squares of the spacing, by which the points of a side must spread along it both
/// ways: those of half a disc of three spacings do by 0.7.
const SIDE_WIDTH: f64 = 0.15;

/// A crease is seen by points within this share of the neighbourhood's radius.
const BESIDE: f64 = 0.35;

/// How much better than a quadric a hinge must explain the points, where both miss them by noise
/// alone: the excess of the quadric's sum of squares over the hinge's mean square (a statistic of F).
const BETTER: f64 = 16.0;

/// The same where the hinge misses them by more than noise: the ratio of the excesses over it.
const BETTER_SHAPED: f64 = 3.0;

/// Two half planes that miss the points of a cloud without noise by more than this share of the
/// spacing are not the surface: a sphere of eight spacings they miss by about as much.
const LOOSE: f64 = 0.15;

/// Of the variance that noise has, what half planes may miss the points by, beyond that: chance adds
/// as much to the mean of 32 squares once in thirty times.
const LOOSE_NOISE: f64 = 1.5;

/// A quadric that misses the points by no more than this share of the spacing is as good as a hinge.
const EXACT: f64 = 0.03;

/// Surfaces that turn by more than this (cosine of 155°) are two sheets that touch.
const FOLDED: f64 = -0.906;

/// What samples are found from.
#[derive(Clone, Copy)]
pub struct Points<'a> {
    /// Where they are.
    pub laid: Spacings<'a>,
    /// The nearest others of each.
    pub nearest: &'a Nearest,
    /// Standard deviation of the points from their surface, model units.
    pub noise: f64,
}

impl Points<'_> {
    /// Whether noise calls for no more points than are looked at without it.
    pub(super) fn are_clear(&self) -> bool {
        self.count(self.usual_spacing()) == FEWEST as usize
    }

    /// Samples of all creases whose turn has a lesser cosine than `turn`, beside some of the points and in their
    /// order.
    pub(super) fn samples(&self, beside: impl IndexedParallelIterator<Item = u32>, turn: f64) -> Vec<Sample> {
        let count = self.count(self.usual_spacing());
        // Neighbourhoods overlap the more the larger they are.
        let stride = (count as f64 / FEWEST) as usize;
        let seeds = beside.step_by(stride.max(1)).map(|n| n as usize);
        seeds.filter(|&n| self.is_rough(n, stride > 1)).filter_map(|n| self.sample(n, turn)).collect()
    }

    /// The median spacing, model units.
    #[must_use]
    pub fn usual_spacing(&self) -> f64 {
        let mut spacings = self.laid.spacing.to_vec();
        let middle = spacings.len() / 2;
        match middle < spacings.len() {
            true => f64::from(*spacings.select_nth_unstable_by(middle, f32::total_cmp).1),
            false => 0.0,
        }
    }

    /// The place on the surface beside another; `None` where the points around lie as on no smooth one.
    #[must_use]
    pub fn foot(&self, place: DVec3) -> Option<DVec3> {
        let closest = self.laid.search.closest(place)? as usize;
        let count = self.count(f64::from(self.laid.spacing[closest]));
        let many = count as f64 > FEWEST;
        if self.is_rough(closest, many) {
            return None;
        }
        let around = self.laid.search.around(place.as_vec3(), if many { count } else { NEAREST });
        let at = |&n: &u32| self.laid.positions[n as usize].as_dvec3() - place;
        let plane = Moments::of(around.iter().map(at)).plane()?;
        Some(place + plane.middle.project_onto_normalized(plane.normal))
    }

    /// Whether the points around one, the nearest or `many`, lie about their plane as on no smooth surface.
    fn is_rough(&self, n: usize, many: bool) -> bool {
        let spacing = f64::from(self.laid.spacing[n]);
        let noise = self.noise / spacing;
        if !(spacing > 0.0 && noise < DROWNED) {
            return false;
        }
        let here = self.laid.positions[n].as_dvec3();
        let offset = |other: u32| (self.laid.positions[other as usize].as_dvec3() - here) / spacing;
        let (moments, share) = if many {
            let around = self.laid.search.around(self.laid.positions[n], self.count(spacing));
            (Moments::of(around.into_iter().map(offset)), ROUGH_AMONG_MANY)
        } else {
            let near = std::iter::once(DVec3::ZERO).chain(listed(&self.nearest[n]).map(offset));
            (Moments::of(near), ROUGH_NOISE)
        };
        moments.thickness() > ROUGH * ROUGH + share * noise * noise
    }

    /// The points looked at around a place.
    pub(super) fn around(&self, place: DVec3) -> Vec<u32> {
        self.laid.search.around(place.as_vec3(), self.count(self.laid.at(place)))
    }

    /// Where a point is.
    pub(super) fn at(&self, point: u32) -> DVec3 {
        self.laid.positions[point as usize].as_dvec3()
    }

    /// How many points are looked at where they lie so far apart.
    fn count(&self, spacing: f64) -> usize {
        let radius = ABOVE_NOISE * self.noise / spacing;
        (PI * radius * radius).clamp(FEWEST, MOST) as usize
    }

    /// The crease beside a point.
    fn sample(&self, n: usize, turn: f64) -> Option<Sample> {
        let spacing = f64::from(self.laid.spacing[n]);
        let here = self.laid.positions[n].as_dvec3();
        let around = self.laid.search.around(self.laid.positions[n], self.count(spacing));
        let offset = |&other: &u32| (self.laid.positions[other as usize].as_dvec3() - here) / spacing;
        let points: Vec<DVec3> = around.iter().map(offset).collect();
        let radius = (points.len() as f64 / PI).sqrt();
        let noise = self.noise / spacing;
        // A neighbourhood no larger than without noise has none of its points to spare.
        let many = points.len() > FEWEST as usize;
        let shown = |points: &[DVec3]| shown(points, noise, many, turn);
        let left = |hinge: &Hinge| hinge.scatter - LOOSE_NOISE * noise * noise;
        let close = || {
            shown(points.get(..CLOSE).filter(|_| !many)?)
                .filter(|hinge| left(hinge) <= UNEXPLAINED * UNEXPLAINED)
        };
        let all = shown(&points);
        let hinge = all.or_else(close)?;
        Some(Sample {
            place: here + spacing * hinge.foot,
            along: hinge.along,
            between: (hinge.inward[0] + hinge.inward[1]).normalize_or(hinge.normal()),
            turn: hinge.turn(),
            rounded: if many { hinge.rounded(&points, radius, cutoff(noise)) } else { 0.0 },
            left: left(&hinge),
            doubtful: all.is_none() && !is_nothing(left(&hinge)),
            size: radius * spacing,
        })
    }
}

/// Whether the points beside some samples, on the mean, leave nothing to explain.
pub(super) fn are_exact(samples: &[Sample]) -> bool {
    let left = samples.iter().map(|sample| sample.left.max(0.0)).sum::<f64>();
    is_nothing(left / samples.len() as f64)
}

/// Whether a mean square, of spacings, is none to speak of.
fn is_nothing(left: f64) -> bool {
    left <= NOTHING * NOTHING
}

/// The hinge that points show.
fn shown(points: &[DVec3], noise: f64, many: bool, turn: f64) -> Option<Hinge> {
    let radius = (points.len() as f64 / PI).sqrt();
    let cutoff = cutoff(noise);
    let normal = Moments::of(points.iter().copied()).plane()?.normal;
    let smooth = smooth(points, normal, radius, cutoff);
    if smooth < EXACT * EXACT + ROUGH_NOISE * noise * noise {
        return None;
    }
    let hinge = bent_as_shown(points, normal, cutoff, if many { noise } else { 0.0 })?;
    let sound =
        is_better(smooth, hinge.scatter, noise, points.len()) && is_sound(&hinge, points.len(), radius);
    (sound && is_turned(&hinge, turn)).then_some(hinge)
}

/// The distance, in spacings, beyond which a point that scatters by so many is not explained.
pub(super) fn cutoff(noise: f64) -> f64 {
    CUTOFF.max(STRAY * noise)
}

/// The hinge of least squares near points, whose sheets bend where the points show that they do.
pub(super) fn bent_as_shown(points: &[DVec3], normal: DVec3, cutoff: f64, noise: f64) -> Option<Hinge> {
    let flat = Hinge::fit(points, normal, cutoff, noise)?;
    let better = |bent: &Hinge| {
        (flat.scatter - bent.scatter) * points.len() as f64 > BETTER * bent.scatter.max(EXACT * EXACT)
    };
    Some(flat.bent(points, cutoff, noise).filter(better).unwrap_or(flat))
}

/// The mean square by which a quadric misses points, each by no more than the cutoff.
fn smooth(points: &[DVec3], normal: DVec3, radius: f64, cutoff: f64) -> f64 {
    bowl::scatter(points, normal, radius, cutoff).unwrap_or(cutoff * cutoff)
}

/// Whether a hinge tells of a crease whose turn has a lesser cosine than `turn`.
fn is_turned(hinge: &Hinge, turn: f64) -> bool {
    (FOLDED..turn).contains(&hinge.turn())
}

/// Whether a hinge explains points, in spacings, that lie beside a line, so that there is a crease.
pub(super) fn explains(hinge: &Hinge, points: &[DVec3], normal: DVec3, noise: f64, turn: f64) -> bool {
    let radius = points.iter().map(|p| p.length()).fold(0.0, f64::max);
    let smooth = smooth(points, normal, radius, cutoff(noise));
    is_better(smooth, hinge.scatter, noise, points.len())
        && is_held(hinge, points.len())
        && is_turned(hinge, turn)
}

/// Whether the mean square by which a hinge misses so many points is so much less than that of a
/// quadric that there is a crease; in squares of the spacing, as `noise` is in spacings.
fn is_better(quadric: f64, hinge: f64, noise: f64, points: usize) -> bool {
    let better = quadric - hinge - EXACT * EXACT;
    hinge < LOOSE * LOOSE + LOOSE_NOISE * noise * noise
        && better * points as f64 > BETTER * hinge
        && better > BETTER_SHAPED * (hinge - noise * noise)
}

/// Whether a hinge among so many points has enough of them on both sides, and lies beside their
/// middle.
fn is_sound(hinge: &Hinge, points: usize, radius: f64) -> bool {
    is_held(hinge, points)
        && hinge.width.into_iter().all(|width| width >= SIDE_WIDTH)
        && hinge.foot.length() <= BESIDE * radius
}

/// Whether a hinge explains enough of so many points, on both sides.
fn is_held(hinge: &Hinge, points: usize) -> bool {
    let share = |held: usize| held as f64 / points as f64;
    share(hinge.held[0] + hinge.held[1]) >= EXPLAINED
        && hinge.held.into_iter().all(|held| held >= SIDE_POINTS && share(held) >= SIDE_SHARE)
}
