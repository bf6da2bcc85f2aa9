//! Where lines meet the border of a splat's ellipse.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

/// The part of a polyline inside an ellipse, from border to border.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The points; the first and last lie on the border unless the run is closed.
    pub points: Vec<DVec2>,
    /// Whether it is a loop that never meets the border; its first point is not repeated.
    pub closed: bool,
}

/// What ends on the border lies this share beyond it at most, squared: the rounding of sines.
const ON_BORDER: f64 = 1e-9;

/// Whether a point lies inside an ellipse or on its border.
#[must_use]
pub fn holds(point: DVec2, radii: DVec2) -> bool {
    (point / radii).length_squared() <= 1.0 + ON_BORDER
}

/// The parameters, ascending, at which the line through `a` and `b` meets the border.
#[must_use]
pub fn crossings(a: DVec2, b: DVec2, radii: DVec2) -> Option<(f64, f64)> {
    let (p, d) = (a / radii, (b - a) / radii);
    let (aa, half, c) = (d.length_squared(), p.dot(d), p.length_squared() - 1.0);
    let root = half * half - aa * c;
    if !(root > 0.0 && aa > 0.0) {
        return None;
    }
    // The stable pair of roots: no cancellation between -half and the root.
    let q = -(half + root.sqrt().copysign(half));
    let (s, t) = (q / aa, c / q);
    (s.is_finite() && t.is_finite()).then_some((s.min(t), s.max(t)))
}

/// Where the ray from an inner point along a direction leaves the ellipse.
#[must_use]
pub fn exit(from: DVec2, direction: DVec2, radii: DVec2) -> Option<DVec2> {
    let (_, t) = crossings(from, from + direction, radii)?;
    (t >= 0.0).then(|| from + t * direction)
}

/// Central angle of a point, radians in `[0, 2π)`.
#[must_use]
pub fn angle(point: DVec2) -> f64 {
    let angle = libm::atan2(point.y, point.x);
    if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
}

/// Cuts a polyline into the runs that lie inside an ellipse.
///
/// `None` if an open polyline begins or ends inside: it does not bound what lies there.
#[must_use]
pub fn runs(line: &[DVec2], closed: bool, radii: DVec2) -> Option<Vec<Run>> {
    let inside = |p: DVec2| (p / radii).length_squared() < 1.0;
    if closed {
        let Some(start) = line.iter().position(|&p| !inside(p)) else {
            return Some(vec![Run { points: line.to_vec(), closed: true }]);
        };
        let turned: Vec<DVec2> = (0..=line.len()).map(|n| line[(start + n) % line.len()]).collect();
        return runs(&turned, false, radii);
    }
    if line.first().is_some_and(|&p| inside(p)) || line.last().is_some_and(|&p| inside(p)) {
        return None;
    }
    let mut found = Vec::new();
    let mut open: Vec<DVec2> = Vec::new();
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let Some((enter, leave)) = crossings(a, b, radii) else { continue };
        if !inside(a) && enter > 0.0 && enter < 1.0 {
            open = vec![a.lerp(b, enter)];
        }
        if inside(b) {
            open.push(b);
        } else if !open.is_empty() {
            open.push(a.lerp(b, leave));
            found.push(Run { points: std::mem::take(&mut open), closed: false });
        }
    }
    Some(found)
}

/// Ways in which a box around places is laid: that of a strip is wider than need be by at most a sixtieth of its length.
const TURNS: u32 = 48;

/// No ellipse around places is more slender than this: those on a line have no width.
const SLENDEREST: f64 = 0.05;

/// The angle from `u` to the first axis of the box around places that has the least area.
#[must_use]
pub fn least_turn(places: &[DVec2]) -> f64 {
    let turns = (0..TURNS).map(|n| f64::from(n) / f64::from(TURNS) * FRAC_PI_2);
    let area = |turn: f64| {
        let (sin, cos) = libm::sincos(turn);
        let back = DVec2::new(cos, -sin);
        let [low, high] = bounds(places.iter().map(|&place| back.rotate(place)));
        (high - low).element_product()
    };
    let areas = turns.map(|turn| (area(turn), turn));
    areas.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, turn)| turn)
}

/// The centre and the radii of an ellipse along the axes around places, as slender as their box.
#[must_use]
pub fn around(places: &[DVec2]) -> (DVec2, DVec2) {
    let [low, high] = bounds(places.iter().copied());
    let (center, half) = (0.5 * (low + high), (0.5 * (high - low)).max(DVec2::splat(f64::MIN_POSITIVE)));
    let half = half.max(DVec2::splat(SLENDEREST * half.max_element()));
    let scale = places.iter().map(|&uv| ((uv - center) / half).length()).fold(0.0, f64::max);
    (center, scale * half)
}

/// The lowest and the highest corner of the box around places.
fn bounds(places: impl Iterator<Item = DVec2>) -> [DVec2; 2] {
    let none = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    places.fold(none, |[low, high], uv| [low.min(uv), high.max(uv)])
}

/// Steiner's ellipse, the least through three points, whose mean is its centre: the angle from
/// `u` to its first axis, and its radii.
///
/// With `S` the second moments of the corners it is `xᵀ S⁻¹ x = 2`.
#[must_use]
pub fn circumellipse(corners: [DVec2; 3]) -> (f64, DVec2) {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for uv in corners {
        xx += uv.x * uv.x / 3.0;
        xy += uv.x * uv.y / 3.0;
        yy += uv.y * uv.y / 3.0;
    }
    let theta = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let (mean, half) = (0.5 * (xx + yy), 0.5 * libm::hypot(xx - yy, 2.0 * xy));
    let radii = DVec2::new(mean + half, (mean - half).max(0.0)).map(|moment| (2.0 * moment).sqrt());
    (theta, radii)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zigzag_is_cut_into_its_inner_runs() {
        let line =
            [(-3.0, 0.5), (0.0, 0.5), (3.0, 0.5), (3.0, 0.0), (-3.0, -0.2)].map(|(x, y)| DVec2::new(x, y));
        let radii = DVec2::new(2.0, 1.0);
        let found = runs(&line, false, radii).unwrap_or_default();
        assert_eq!(found.iter().map(|run| run.points.len()).collect::<Vec<_>>(), [3, 2]);
        for run in &found {
            for end in [run.points[0], run.points[run.points.len() - 1]] {
                assert!(((end / radii).length() - 1.0).abs() < 1e-12);
            }
        }
        assert!(runs(&line[1..], false, radii).is_none(), "begins inside");
    }

    #[test]
    fn around_a_strip_that_lies_askew_an_ellipse_is_as_slender() {
        let back = DVec2::from_angle(0.3);
        let strip =
            [(2.0, 0.1), (-2.0, 0.1), (-2.0, -0.1), (2.0, -0.1)].map(|place| back.rotate(place.into()));
        let turn = least_turn(&strip);
        let turned = strip.map(|place| DVec2::from_angle(-turn).rotate(place));
        let (center, radii) = around(&turned);
        assert!(
            center.length() < 1e-9 && radii.min_element() < 0.1 * radii.max_element(),
            "{center} {radii}"
        );
        assert!(turned.iter().all(|&place| holds(place - center, radii)));
    }

    #[test]
    fn the_circumellipse_passes_through_the_corners() {
        let corners = [(2.0, 0.3), (-1.5, 0.1), (-0.5, -0.4)].map(DVec2::from);
        let (theta, radii) = circumellipse(corners);
        for corner in corners {
            let turned = DVec2::from_angle(-theta).rotate(corner);
            assert!(((turned / radii).length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_loop_inside_stays_a_loop() {
        let square = [(0.1, 0.1), (0.2, 0.1), (0.2, 0.2)].map(|(x, y)| DVec2::new(x, y));
        let found = runs(&square, true, DVec2::ONE).unwrap_or_default();
        assert!(found.len() == 1 && found[0].closed);
    }
}
