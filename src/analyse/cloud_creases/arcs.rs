//! Circles on which a line goes on over a gap, as the rim of a hole does where some of its points fail in a row.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3};

use super::LONGEST;
use super::ends::End;
use super::plane::Moments;
use super::ridge::APART;

/// The last places before either end lie on the circle within this share of the size: those of two straight lines are
/// off by more.
const ON: f64 = 0.1;

/// A gap spans at most half a turn, and no more than what is seen of the circle before both ends does.
const WIDEST: f64 = PI;

/// Beside at least this share of the places along it the surface must not be smooth: the flat of a shaft may lie there.
const CREASED: f64 = 0.75;

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
        let near = a.place.distance(b.place) <= LONGEST * size;
        if !(near && a.is_apart(b) && a.stands && b.stands) {
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
        let short = arc.angle <= WIDEST.min(seen) && arc.angle * arc.radius <= LONGEST * size;
        (facing && short).then_some(arc)
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
        DVec2::new((way - height * self.normal()).length() - self.radius, height).length()
    }

    /// Whether it lies where the surface is not smooth.
    pub(super) fn is_creased(&self, smooth: &impl Fn(DVec3) -> bool) -> bool {
        let (mut creased, mut all) = (0, 0);
        for place in self.places() {
            creased += u32::from(!smooth(place));
            all += 1;
        }
        f64::from(creased) >= CREASED * f64::from(all)
    }

    /// Places along it, between its ends.
    pub(super) fn places(&self) -> impl Iterator<Item = DVec3> + use<> {
        let (arc, count) = (*self, (self.angle * self.radius / (APART * self.size)).ceil() as usize);
        (1..count.max(1)).map(move |n| {
            let (sin, cos) = libm::sincos(arc.angle * n as f64 / count as f64);
            arc.center + arc.radius * (cos * arc.axes[0] + sin * arc.axes[1])
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::corners::join;
    use super::super::ends::TAIL;
    use super::super::lines::Line;
    use super::*;

    /// Of a circle of radius 2 sizes what lies between two angles, degrees.
    fn rim(from: f64, to: f64) -> Line {
        let count = ((to - from).to_radians() * 2.0 / APART).ceil();
        let at = |n: u32| {
            let (sin, cos) = libm::sincos((from + (to - from) * f64::from(n) / count).to_radians());
            DVec3::new(2.0 * cos, 2.0 * sin, 1.0)
        };
        Line { places: (0..=count as u32).map(at).collect(), closed: false, size: 1.0 }
    }

    #[test]
    fn a_rim_with_a_gap_is_closed_on_its_circle_where_the_surface_is_not_smooth() {
        for (gap, smooth, closed) in
            [(80.0, false, true), (120.0, false, true), (120.0, true, false), (170.0, false, false)]
        {
            let mut lines = [rim(0.0, 360.0 - gap)];
            assert_eq!(join(&mut lines, &|_| smooth).unwrap().met, [[closed; 2]], "{gap}°, smooth: {smooth}");
            let places = &lines[0].places;
            for pair in places.windows(2) {
                let middle = pair[0].midpoint(pair[1]);
                let off = (middle.truncate().length() - 2.0).hypot(middle.z - 1.0);
                assert!(off < 0.015, "{gap}°: {middle}");
            }
            assert_eq!(places[0] == places[places.len() - 1], closed);
        }
    }

    #[test]
    fn two_straight_lines_go_on_on_no_circle() {
        let (sin, cos) = libm::sincos(0.6);
        let line = |way: DVec3| Line {
            places: (0..=30).map(|n| (0.7 + 0.3 * f64::from(n)) * way).collect(),
            closed: false,
            size: 1.0,
        };
        let lines = [line(DVec3::new(cos, sin, 0.0)), line(DVec3::new(cos, -sin, 0.0))];
        let tails = [0, 1].map(|n: usize| lines[n].places[..TAIL].to_vec());
        assert!(Arc::through([&tails[0], &tails[1]], 1.0).is_none());
    }
}
