//! Creases between places where lines end, as short as a few neighbourhoods: there third faces at both ends leave few
//! samples or none, or some points in a row show none by chance, but the two ends are known.

use glam::DVec3;
use rayon::prelude::*;

use super::LONGEST;
use super::corners::search;
use super::lines::Line;
use super::plane::Moments;
use super::samples::{Points, bent_as_shown, cutoff, explains};
use crate::error::Result;

/// Ends looked at around one, and places of lines around one of an arm.
const LOOKED_AT: usize = 16;

/// Points within this share of the size count: its two faces alone, unless one is narrower.
const BESIDE: f64 = 0.75;

/// Points of third faces lie within this share of the size of the ends.
const THIRD: f64 = 0.25;

/// Of a short arm at most this share of its length is taken for that of its ends, so that half of it counts.
const END_SHARE: f64 = 0.25;

/// Places along an arm around which points are looked for lie so far apart, in its size.
const STEP: f64 = 0.5;

/// An arm's faces have points beside it all along: by chance so much of its length is empty, in its size.
const EMPTY: f64 = 1.0;

/// The crease that its points show passes its ends within this share of its size.
const MISS: f64 = 0.2;

/// An arm that passes a line, or a third end, within this share of its size runs along it, or crosses it...
const CLEAR: f64 = 0.4;

/// ... but for what lies within this share of its size of its own.
const AT_END: f64 = 0.6;

/// Where lines end, together or one alone.
#[derive(Clone, Copy, Debug)]
struct End {
    place: DVec3,
    /// That of the lines, on the mean.
    size: f64,
}

/// The creases between ends of some lines at which the surface turns by more than an angle whose cosine is `turn`.
///
/// # Errors
/// [`crate::Error::Internal`] should the neighbour search not take the ends.
pub(super) fn between_ends(lines: &[Line], points: &Points<'_>, turn: f64) -> Result<Vec<Line>> {
    let ends = ends(lines);
    let Some(near) = search(ends.iter().map(|end| end.place))? else { return Ok(Vec::new()) };
    let pairs = (0..ends.len()).into_par_iter().flat_map_iter(|n| {
        let others = near.around(ends[n].place.as_vec3(), LOOKED_AT).into_iter().map(|other| other as usize);
        others.filter(move |&other| other > n).map(move |other| (n, other))
    });
    let places: Vec<DVec3> = lines.iter().flat_map(|line| line.places.iter().copied()).collect();
    let Some(along_lines) = search(places.iter().copied())? else { return Ok(Vec::new()) };
    let is_clear = |arm: &Arm| {
        let near = arm.steps().flat_map(|step| along_lines.around(step.as_vec3(), LOOKED_AT));
        !near.into_iter().any(|place| arm.passes(places[place as usize]))
    };
    let arms = pairs.filter_map(|(a, b)| Arm::of(ends[a], ends[b]));
    let found = arms.filter(is_clear).filter_map(|arm| Some((arm, arm.crease(points, turn)?)));
    let mut found: Vec<(Arm, Vec<DVec3>)> = found.collect();
    let key = |arm: &Arm| arm.ends.map(|end| end.to_array().map(f64::to_bits));
    found.sort_unstable_by_key(|(arm, _)| key(arm));
    Ok(found.into_iter().map(|(arm, places)| Line { places, closed: false, size: arm.size }).collect())
}

/// Where some lines end, in an order that depends on their places alone.
fn ends(lines: &[Line]) -> Vec<End> {
    let open = lines.iter().filter(|line| !line.closed);
    let of = |line: &Line, end: &DVec3| (end.to_array().map(f64::to_bits), line.size.to_bits());
    let ends = open
        .flat_map(|line| [line.places.first(), line.places.last()].map(|end| end.map(|end| of(line, end))));
    let mut ends: Vec<([u64; 3], u64)> = ends.flatten().collect();
    ends.sort_unstable();
    let end = |ends: &[([u64; 3], u64)]| End {
        place: DVec3::from_array(ends[0].0.map(f64::from_bits)),
        size: ends.iter().map(|end| f64::from_bits(end.1)).sum::<f64>() / ends.len() as f64,
    };
    ends.chunk_by(|a, b| a.0 == b.0).map(end).collect()
}

/// What may be a crease, straight or bent a little.
#[derive(Clone, Copy, Debug)]
struct Arm {
    ends: [DVec3; 2],
    size: f64,
}

impl Arm {
    /// From end to end, unless they are too far apart.
    fn of(a: End, b: End) -> Option<Self> {
        let arm = Self { ends: [a.place, b.place], size: 0.5 * (a.size + b.size) };
        (arm.length() <= LONGEST * arm.size && arm.length() > 0.0).then_some(arm)
    }

    fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    fn along(&self) -> DVec3 {
        (self.ends[1] - self.ends[0]) / self.length()
    }

    /// Places along it, a step apart or less, without the ends.
    fn steps(&self) -> impl Iterator<Item = DVec3> + use<> {
        let ([a, b], count) = (self.ends, (self.length() / (STEP * self.size)).ceil() as usize);
        (1..=count).map(move |n| a.lerp(b, (n as f64 - 0.5) / count as f64))
    }

    /// How far along it a place lies, and how far beside.
    fn place(&self, place: DVec3) -> (f64, f64) {
        let (way, along) = (place - self.ends[0], self.along());
        (way.dot(along), way.reject_from_normalized(along).length())
    }

    /// Whether so far along it is farther than a share of its size from both ends.
    fn between(&self, share: f64, along: f64) -> bool {
        let end = (share * self.size).min(END_SHARE * self.length());
        (end..=self.length() - end).contains(&along)
    }

    /// Whether it passes a place, other than near its ends.
    fn passes(&self, place: DVec3) -> bool {
        let (along, beside) = self.place(place);
        self.between(AT_END, along) && beside <= CLEAR * self.size
    }

    /// The points beside it, ascending.
    fn beside(&self, points: &Points<'_>) -> Vec<u32> {
        let around = self.steps().flat_map(|step| points.around(step));
        let mut beside: Vec<u32> = around
            .filter(|&point| {
                let (along, beside) = self.place(points.at(point));
                self.between(THIRD, along) && beside <= BESIDE * self.size
            })
            .collect();
        beside.sort_unstable();
        beside.dedup();
        beside
    }

    /// The places of the crease, from end to end, that the points beside it show: two half planes that meet there.
    fn crease(&self, points: &Points<'_>, turn: f64) -> Option<Vec<DVec3>> {
        let middle = self.ends[0].midpoint(self.ends[1]);
        let (_, spacing) = points.laid.near(middle)?;
        let noise = points.noise / spacing;
        let local: Vec<DVec3> =
            self.beside(points).iter().map(|&point| (points.at(point) - middle) / spacing).collect();
        let normal = Moments::of(local.iter().copied()).plane()?.normal;
        let hinge = bent_as_shown(&local, normal, cutoff(noise), noise)?;
        let off = self.ends.map(|end| spacing * hinge.off((end - middle) / spacing));
        let is_lined = |side: usize| {
            let on = local.iter().filter(|&&p| hinge.side(p) == side);
            self.is_lined(on.map(|&p| middle + spacing * p))
        };
        let creased = off.into_iter().all(|off| off.length() <= MISS * self.size)
            && explains(&hinge, &local, normal, noise, turn)
            && [0, 1].into_iter().all(is_lined);
        // What its ends are off the hinge is shared out along it.
        let place = |at: f64| {
            let straight = (self.ends[0].lerp(self.ends[1], at) - middle) / spacing;
            middle + spacing * hinge.beside(straight) + off[0].lerp(off[1], at)
        };
        creased.then(|| {
            let inner = if hinge.is_bent() { self.steps().count() } else { 0 };
            let inner = (1..inner).map(|n| place(n as f64 / inner as f64));
            std::iter::once(self.ends[0]).chain(inner).chain([self.ends[1]]).collect()
        })
    }

    /// Whether some places lie all along it.
    fn is_lined(&self, places: impl Iterator<Item = DVec3>) -> bool {
        let mut along: Vec<f64> =
            places.map(|place| self.place(place).0).chain([0.0, self.length()]).collect();
        along.sort_unstable_by(f64::total_cmp);
        along.windows(2).all(|pair| pair[1] - pair[0] <= EMPTY * self.size)
    }
}
