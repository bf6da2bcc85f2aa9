//! Chains of samples as lines of places: which are long and sharp enough, and smoothed.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::links::Chain;
use super::samples::Sample;

/// Of a crease's samples at least this share turn by the whole angle asked for; the others carry it
/// on (hysteresis, after Canny 1986).
const SHARP_SHARE: f64 = 0.5;

/// A line whose samples are rounded by more than this, on the mean, is a bend. Those of creases are by -0.9 to
/// 0.15, since each point counts for the side it is nearer to; those of bends with a radius of six to twelve
/// standard deviations of the noise by 0.4 to 1.2.
const ROUNDED: f64 = 0.25;

/// A line of fewer samples is none.
const FEWEST: usize = 3;

/// Samples on either side of one through which its line is smoothed.
const WINDOW: usize = 4;

/// A line, model units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// Its places in order; the first is not repeated at the end.
    pub(super) places: Vec<DVec3>,
    /// Whether the last is followed by the first.
    pub(super) closed: bool,
    /// The mean radius of the neighbourhoods that showed it.
    pub(super) size: f64,
}

impl Line {
    /// The longest part of a chain of which enough turns by more than an angle whose cosine is `turn`, as a line; `None`
    /// if there is none, or it is a bend.
    ///
    /// A crease that fades away is so carried on for as long as it was sharp, and no farther.
    pub(super) fn of(chain: &Chain, turn: f64) -> Option<Self> {
        let part = sharp_part(&chain.samples, turn);
        let samples = &chain.samples[part];
        if samples.len() < FEWEST {
            return None;
        }
        let rounded = samples.iter().map(|sample| sample.rounded).sum::<f64>() / samples.len() as f64;
        if rounded > ROUNDED {
            return None;
        }
        let closed = chain.closed && samples.len() == chain.samples.len();
        Some(Self::along(&Chain { samples: samples.to_vec(), closed }))
    }

    /// A chain as a line, whatever it is of.
    pub(super) fn along(chain: &Chain) -> Self {
        let size = chain.samples.iter().map(|sample| sample.size).sum::<f64>() / chain.samples.len() as f64;
        let places: Vec<DVec3> = chain.samples.iter().map(|sample| sample.place).collect();
        Self { places: smoothed(&places, chain.closed), closed: chain.closed, size }
    }

    /// Its length.
    pub(super) fn length(&self) -> f64 {
        let open: f64 = self.places.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let gap = match (self.places.first(), self.places.last()) {
            (Some(first), Some(last)) if self.closed => first.distance(*last),
            _ => 0.0,
        };
        open + gap
    }

    /// Its places, the first repeated at the end if it is closed.
    pub(super) fn whole(mut self) -> Vec<DVec3> {
        let first = self.places.first().copied().filter(|_| self.closed);
        self.places.extend(first);
        self.places
    }
}

/// The longest run of samples, the first of several, of which at least [`SHARP_SHARE`] turn by more than an angle whose
/// cosine is `turn`.
fn sharp_part(samples: &[Sample], turn: f64) -> Range<usize> {
    let gain = |sample: &Sample| f64::from(u8::from(sample.turn <= turn)) - SHARP_SHARE;
    let mut sums = vec![0.0];
    for sample in samples {
        sums.push(sums[sums.len() - 1] + gain(sample));
    }
    // Where a run may begin: nothing before lies lower.
    let mut lows: Vec<usize> = Vec::new();
    for n in 0..sums.len() {
        if lows.last().is_none_or(|&low| sums[n] < sums[low]) {
            lows.push(n);
        }
    }
    let mut longest = 0..0;
    for end in (0..sums.len()).rev() {
        while let Some(&low) = lows.last()
            && sums[low] <= sums[end]
        {
            lows.pop();
            if low < end && end - low >= longest.len() {
                longest = low..end;
            }
        }
    }
    longest
}

/// Each place moved onto the parabola of least squares through those around (Savitzky and Golay
/// 1964), which shrinks no circle as means do.
fn smoothed(places: &[DVec3], closed: bool) -> Vec<DVec3> {
    let count = places.len();
    let half = WINDOW.min((count - 1) / 2);
    let at = |n: isize| places[n.rem_euclid(count as isize) as usize];
    (0..count as isize)
        .map(|n| {
            let (low, high) = match closed {
                true => (n - half as isize, n + half as isize),
                false => ((n - half as isize).max(0), (n + half as isize).min(count as isize - 1)),
            };
            let window: Vec<DVec3> = (low..=high).map(at).collect();
            parabola(&window, (n - low) as usize)
        })
        .collect()
}

/// The place on the parabola through some places at one of them.
fn parabola(window: &[DVec3], at: usize) -> DVec3 {
    let moved = Parabola::through(window, at).map_or(DVec3::ZERO, |parabola| parabola.place - window[at]);
    if moved.is_finite() { window[at] + moved } else { window[at] }
}

/// A parabola, by length of the way from one of its places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola {
    pub(super) place: DVec3,
    /// First and second derivative there.
    pub(super) slope: DVec3,
    pub(super) bend: DVec3,
    /// How far places lie off it, as a standard deviation: those it goes through do by less the fewer they are.
    pub(super) off: f64,
}

impl Parabola {
    /// That of least squares through some places, from one of them on; `None` of three or fewer, which are on theirs
    /// as they are.
    pub(super) fn through(window: &[DVec3], at: usize) -> Option<Self> {
        let mut way = vec![0.0; window.len()];
        for n in 1..window.len() {
            way[n] = way[n - 1] + window[n].distance(window[n - 1]);
        }
        let span = *way.last()?;
        let fitted = window.len() > 3 && span > 0.0;
        if !fitted {
            return None;
        }
        let term = |n: usize| {
            let t = (way[n] - way[at]) / span;
            DVec3::new(1.0, t, t * t)
        };
        let (mut square, mut sides) = (DMat3::ZERO, [DVec3::ZERO; 3]);
        for (n, place) in window.iter().enumerate() {
            let t = term(n);
            square += DMat3::from_cols(t.x * t, t.y * t, t.z * t);
            for (side, value) in sides.iter_mut().zip((*place - window[at]).to_array()) {
                *side += value * t;
            }
        }
        let inverse = square.inverse();
        // Of each coordinate: value, slope and half the bend, by span.
        let of = DMat3::from_cols_array_2d(&sides.map(|side| (inverse * side).to_array())).transpose();
        let off = |n: usize| (window[n] - window[at] - of * term(n)).length_squared();
        // Of a coordinate it has three terms, which take as many of the places' freedoms.
        let free = window.len() - 3;
        let off = ((0..window.len()).map(off).sum::<f64>() / free as f64).sqrt();
        let [place, slope, half] = [of.x_axis, of.y_axis, of.z_axis];
        Some(Self { place: window[at] + place, slope: slope / span, bend: 2.0 / (span * span) * half, off })
    }

    /// Its place and unit tangent so far ahead.
    pub(super) fn ahead(&self, way: f64) -> [DVec3; 2] {
        let place = self.place + way * self.slope + 0.5 * way * way * self.bend;
        [place, (self.slope + way * self.bend).normalize_or_zero()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::planted::random;

    /// A chain along x of samples that turn by so many degrees.
    fn chain(turns: impl Iterator<Item = f64>) -> Chain {
        let sample = |(n, turn): (usize, f64)| Sample {
            place: n as f64 * DVec3::X,
            along: DVec3::X,
            between: DVec3::Z,
            turn: libm::cos(turn.to_radians()),
            rounded: 0.0,
            left: 0.0,
            doubtful: false,
            size: 3.0,
        };
        Chain { samples: turns.enumerate().map(sample).collect(), closed: false }
    }

    #[test]
    fn a_crease_that_fades_goes_on_for_as_long_as_it_was_sharp() {
        let sharp = libm::cos(40_f64.to_radians());
        let line = |from: f64, to: f64, step: f64| {
            let count = ((to - from) / step) as usize;
            Line::of(&chain((0..=count).map(|n| from + step * n as f64)), sharp)
        };
        let ends = |line: Option<Line>| {
            line.map(|line| [line.places[0].x, line.places[line.places.len() - 1].x].map(f64::round))
        };
        assert_eq!(ends(line(31.0, 60.0, 1.0)), Some([0.0, 29.0]), "most of it is sharp");
        // The last 20 samples are, with which as many before them go.
        assert_eq!(ends(line(5.5, 44.75, 0.25)), Some([118.0, 157.0]));
        assert_eq!(ends(line(20.0, 39.0, 1.0)), None);
        assert_eq!(ends(line(20.0, 40.5, 1.0)), None, "two samples are no line");
    }

    #[test]
    fn the_longest_part_of_which_half_is_sharp_is_found() {
        let sharp = libm::cos(40_f64.to_radians());
        for case in 0..2000_u64 {
            let samples =
                chain((0..case % 12).map(|n| if random(12 * case + n) > 0.2 { 50.0 } else { 30.0 })).samples;
            let does = |part: &Range<usize>| {
                let turned = samples[part.clone()].iter().filter(|sample| sample.turn <= sharp).count();
                2 * turned >= part.len()
            };
            let all = (0..samples.len()).flat_map(|from| (from + 1..=samples.len()).map(move |to| from..to));
            let longest = all.filter(does).map(|part| part.len()).max().unwrap_or_default();
            let part = sharp_part(&samples, sharp);
            assert!(part.len() == longest && does(&part), "{case}: {part:?}");
        }
    }

    #[test]
    fn smoothing_keeps_circles_and_takes_scatter() {
        let circle = |n: usize, off: f64| {
            let (sin, cos) = libm::sincos(0.02 * std::f64::consts::PI * n as f64);
            (1.0 + off * if n.is_multiple_of(2) { 1.0 } else { -1.0 }) * DVec3::new(cos, sin, 0.0)
        };
        for (off, left) in [(0.0, 1e-4), (0.02, 5e-3)] {
            let places: Vec<DVec3> = (0..100).map(|n| circle(n, off)).collect();
            for place in smoothed(&places, true) {
                assert!((place.length() - 1.0).abs() < left, "{place}");
            }
            for place in &smoothed(&places, false)[5..95] {
                assert!((place.length() - 1.0).abs() < left, "{place}");
            }
        }
    }
}
