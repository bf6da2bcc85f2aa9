//! Circles on which a line goes on over a gap, as the rim of a hole does where some of its points fail in a row.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat3, DVec2, DVec3};

use super::corners::{End, GAP};
use super::plane::Moments;

/// The last so many places before either end tell the circle.
pub(super) const TAIL: usize = 9;

/// They lie on it within this share of the size: those of two straight lines are off by more.
const ON: f64 = 0.1;

/// A gap spans at most this angle, and no more than what is seen of the circle before both ends does.
const WIDEST: f64 = FRAC_PI_2;

/// Places on it lie apart by this share of the size, as those of lines do.
const STEP: f64 = 0.32;

/// A circle's part from one end to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    center: DVec3,
    radius: f64,
    /// Unit vectors from the center to the first end, and along the arc there.
    axes: [DVec3; 2],
    /// The angle that it spans.
    angle: f64,
    /// That of the lines.
    size: f64,
}

impl Arc {
    /// That on which the line that ends at `a` goes on to `b`, if it is one; tails are the places before either, the
    /// end first.
    pub(super) fn between([a, b]: [&End; 2], tails: [&[DVec3]; 2]) -> Option<Self> {
        let size = a.size.min(b.size);
        if !(a.is_apart(b) && a.stands && b.stands && a.place.distance(b.place) <= GAP * size) {
            return None;
        }
        let mut arc = Self::through(tails, size)?;
        let ahead = |end: &End| end.outward.dot(arc.normal().cross(end.place - arc.center));
        let (sign, facing) = (ahead(a).signum(), ahead(a) * ahead(b) < 0.0);
        let first = (a.place - arc.center).reject_from_normalized(arc.normal()).try_normalize()?;
        arc.axes = [first, sign * arc.normal().cross(first)];
        let to = b.place - arc.center;
        arc.angle = libm::atan2(to.dot(arc.axes[1]), to.dot(arc.axes[0])).rem_euclid(TAU);
        let length = |tail: &[DVec3]| tail.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
        let seen = tails.map(length).iter().sum::<f64>() / arc.radius;
        (facing && arc.angle <= WIDEST.min(seen)).then_some(arc)
    }

    /// The circle of least squares (Kåsa 1976) through some places, if they lie on it, with any axes.
    fn through(tails: [&[DVec3]; 2], size: f64) -> Option<Self> {
        let all = || tails.iter().flat_map(|tail| tail.iter().copied());
        let plane = Moments::of(all()).plane()?;
        let (right, up) = plane.normal.any_orthonormal_pair();
        let flat =
            |place: DVec3| DVec2::new(right.dot(place - plane.middle), up.dot(place - plane.middle)) / size;
        let (mut square, mut side) = (DMat3::ZERO, DVec3::ZERO);
        for p in all().map(flat) {
            let term = p.extend(1.0);
            square += DMat3::from_cols(term.x * term, term.y * term, term);
            side += p.length_squared() * term;
        }
        // Of `|p|² = 2 c p + r² - |c|²`.
        let [x, y, rest] = (square.inverse() * side).to_array();
        let middle = 0.5 * DVec2::new(x, y);
        let radius = (rest + middle.length_squared()).sqrt();
        let arc = Self {
            center: plane.middle + size * (middle.x * right + middle.y * up),
            radius: size * radius,
            axes: [right, up],
            angle: 0.0,
            size,
        };
        (radius.is_finite() && all().all(|place| arc.off(place) <= ON * size)).then_some(arc)
    }

    /// Unit normal of its plane.
    fn normal(&self) -> DVec3 {
        self.axes[0].cross(self.axes[1])
    }

    /// How far a place lies off its circle.
    fn off(&self, place: DVec3) -> f64 {
        let (way, height) = (place - self.center, self.normal().dot(place - self.center));
        ((way - height * self.normal()).length() - self.radius).hypot(height)
    }

    /// Places along it, between its ends.
    pub(super) fn places(&self) -> impl Iterator<Item = DVec3> + use<> {
        let (arc, count) = (*self, (self.angle * self.radius / (STEP * self.size)).ceil() as usize);
        (1..count.max(1)).map(move |n| {
            let (sin, cos) = libm::sincos(arc.angle * n as f64 / count as f64);
            arc.center + arc.radius * (cos * arc.axes[0] + sin * arc.axes[1])
        })
    }
}
