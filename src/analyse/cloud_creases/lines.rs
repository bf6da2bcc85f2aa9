//! Chains of samples as lines of places: which are long and sharp enough, and smoothed.

use glam::{DMat3, DVec3};

use super::links::Chain;

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
    /// A chain as a line, if enough of it turns by more than an angle whose cosine is `turn`, and no bend.
    pub(super) fn of(chain: &Chain, turn: f64) -> Option<Self> {
        let count = chain.samples.len();
        let sharp = chain.samples.iter().filter(|sample| sample.turn <= turn).count();
        if count < FEWEST || (sharp as f64) < SHARP_SHARE * count as f64 {
            return None;
        }
        let rounded = chain.samples.iter().map(|sample| sample.rounded).sum::<f64>() / count as f64;
        if rounded > ROUNDED {
            return None;
        }
        Some(Self::along(chain))
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
