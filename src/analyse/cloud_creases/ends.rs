//! Ends of lines: which way they lead on, and what they may reach.

use glam::DVec3;

use super::LENGTHS;
use super::lines::{Line, Parabola};

/// How far beyond its last sample a line may be carried on, in its size: near a corner the third
/// face hides it...
pub(super) const AHEAD: f64 = 1.8;

/// ... for longer at a sharp one, at most so far...
const TO_SHARP_CORNER: f64 = 6.0;

/// The sine of half a right angle.
const HALF_RIGHT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// How far back from its last sample a line may be cut for a corner, in its size.
const BACK: f64 = 0.6;

/// How far from a corner a line that is carried on may pass, in its size.
const MISS: f64 = 0.4;

/// Ends face each other over a gap in one line if both lead to the other within this cosine (37°).
const FACING: f64 = 0.8;

/// A gap may be this wide, in the lesser size, if either line would stand by itself and they go straight on over
/// it within [`STRAIGHT`]: on a thread half a dozen points may fail in a row. Two short ones may be bumps in a row.
const GAP: f64 = 4.0;

/// Within this cosine (15°) the ends at a wide gap lead to each other.
const STRAIGHT: f64 = 0.966;

/// The way from an end of a line that does not bend is taken over this many of its places.
const TANGENT: usize = 4;

/// The last so many places of a line tell how it goes on...
pub(super) const TAIL: usize = 9;

/// ... which bends if they, taken together, tell so by more than so many times what they lie off their parabola.
const SURE: f64 = 2.5;

/// A line of fewer places than this does not close on itself at a corner.
const LOOP: usize = 8;

/// An end of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) line: usize,
    pub(super) last: bool,
    pub(super) place: DVec3,
    /// Unit vector that carries the line on.
    pub(super) outward: DVec3,
    /// How its line goes on, if it bends there.
    bend: Option<Parabola>,
    pub(super) size: f64,
    /// How many places its line has.
    places: usize,
    /// Whether its line, with what that goes on with over gaps, is long enough to be kept whatever its ends do.
    pub(super) stands: bool,
}

impl End {
    /// That of the line of a number, its last or its first.
    pub(super) fn of(line: usize, of: &Line, last: bool) -> Option<Self> {
        let tail = tail(of, last);
        let (place, bend) = (*tail.first()?, bend(&tail));
        let outward = bend.map_or(place - tail[TANGENT.min(tail.len() - 1)], |bend| bend.slope);
        Some(Self {
            line,
            last,
            place,
            outward: outward.try_normalize()?,
            bend,
            size: of.size,
            places: of.places.len(),
            stands: stands(of.length(), of.size),
        })
    }

    /// The line, a place and a unit vector, on which it goes on beside a place.
    pub(super) fn toward(&self, place: DVec3) -> [DVec3; 2] {
        let way = (place - self.place).dot(self.outward).max(0.0);
        self.bend.map_or([self.place, self.outward], |bend| bend.ahead(way))
    }

    /// The last places of its line, the end first.
    pub(super) fn tail(&self, lines: &[Line]) -> Vec<DVec3> {
        tail(&lines[self.line], self.last)
    }

    /// Whether another end is of another line, or of one long enough to close on itself.
    pub(super) fn is_apart(&self, other: &Self) -> bool {
        self.line != other.line || self.places >= LOOP
    }

    /// Whether this end and another are on both sides of a gap.
    pub(super) fn faces(&self, other: &Self) -> bool {
        let way = other.place - self.place;
        let length = way.length();
        let lead = way.dot(self.outward).min(-way.dot(other.outward));
        let size = self.size.min(other.size);
        let near = |reach: f64, cosine: f64| length <= reach * size && lead >= cosine * length;
        let wide = self.stands || other.stands;
        self.is_apart(other) && length > 0.0 && (near(AHEAD, FACING) || (wide && near(GAP, STRAIGHT)))
    }

    /// Whether a place is where the line may go on to, at most so many sizes ahead.
    pub(super) fn reaches(&self, place: DVec3, most: f64) -> bool {
        let way = place - self.place;
        let ahead = way.dot(self.outward);
        (-BACK * self.size..=most * self.size).contains(&ahead)
            && way.reject_from_normalized(self.outward).length() <= MISS * self.size
    }

    /// How far ahead a corner with another may lie, in its size, if one at right angles may so many sizes ahead: there
    /// the two are as near to each other as that leaves them.
    pub(super) fn corner_reach(&self, other: &Self, most: f64) -> f64 {
        let half = (0.5 * (1.0 - self.outward.dot(other.outward)).max(0.0)).sqrt();
        (most * (HALF_RIGHT / half).max(1.0)).min(TO_SHARP_CORNER)
    }

    /// Of some places the nearest that the line may go on to, at most so many sizes ahead.
    pub(super) fn nearest(&self, places: impl Iterator<Item = DVec3>, most: f64) -> Option<DVec3> {
        let reached = places.filter(|&place| self.reaches(place, most));
        reached.min_by(|a, b| a.distance(self.place).total_cmp(&b.distance(self.place)))
    }
}

/// The last places of a line, or its first, the outermost first.
fn tail(line: &Line, last: bool) -> Vec<DVec3> {
    let places = line.places.iter().copied();
    if last { places.rev().take(TAIL).collect() } else { places.take(TAIL).collect() }
}

/// The parabola on which a line leads on that bends, by its last places, the outermost first.
fn bend(tail: &[DVec3]) -> Option<Parabola> {
    let onward: Vec<DVec3> = tail.iter().rev().copied().collect();
    let parabola = Parabola::through(&onward, onward.len() - 1)?;
    let half = 0.5 * onward[0].distance(tail[0]);
    (0.5 * half * half * parabola.bend.length() > SURE * parabola.off).then_some(parabola)
}

/// Whether a line as long as that is kept whatever its ends do.
pub(super) fn stands(length: f64, size: f64) -> bool {
    length >= LENGTHS[2] * size
}
