//! Moves a directed outline outward, away from the surface on its left.

use glam::DVec2;

/// Where a mitre would be longer than this many offsets, a corner is cut off square.
const LONGEST_MITER: f64 = 4.0;

/// The outline with every side moved to its right by `by`, corners mitred.
///
/// A corner too sharp for a mitre becomes two: both sides go on by `by` past the vertex, as the
/// caps of strokes do, so that even a side that runs straight back keeps its distance from both.
/// Repeated points are dropped. A closed outline does not repeat its first point.
#[must_use]
pub fn outward(line: &[DVec2], closed: bool, by: f64) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = line.to_vec();
    points.dedup();
    if closed && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let count = points.len();
    if count < 2 {
        return points;
    }
    let side = |from: usize, to: usize| -(points[to] - points[from]).perp().normalize_or_zero();
    let mut moved = Vec::with_capacity(count);
    for (n, &point) in points.iter().enumerate() {
        let before = (n > 0 || closed).then(|| side((n + count - 1) % count, n));
        let after = (n + 1 < count || closed).then(|| side(n, (n + 1) % count));
        let (before, after) = (before.or(after), after.or(before));
        let (before, after) = (before.unwrap_or_default(), after.unwrap_or_default());
        // |before + after| / (1 + before · after) is the mitre's length, the root of 2 over this.
        let (sum, share) = (before + after, 1.0 + before.dot(after));
        let blunt = share * LONGEST_MITER * LONGEST_MITER >= 2.0;
        // Turning right, the outside is the narrow side, where a cap would lie on the surface.
        if blunt || before.perp_dot(after) < 0.0 {
            let miter = if share > 0.0 { sum / share } else { before };
            moved.push(point + by * miter.clamp_length_max(LONGEST_MITER));
        } else {
            moved.push(point + by * (before + before.perp()));
            moved.push(point + by * (after - after.perp()));
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_grows_on_all_sides() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let grown = outward(&square, true, 0.5);
        assert!(
            grown[0].distance(DVec2::splat(-0.5)) < 1e-12 && grown[2].distance(DVec2::splat(1.5)) < 1e-12
        );
    }

    #[test]
    fn a_line_there_and_back_gets_a_rectangle_around_it() {
        let line = [(0.0, 0.0), (1.0, 0.0), (3.0, 0.0)].map(|(x, y)| DVec2::new(x, y));
        let around = outward(&line, true, 0.5);
        for corner in [(-0.5, -0.5), (3.5, -0.5), (3.5, 0.5), (-0.5, 0.5)] {
            let corner = DVec2::from(corner);
            assert!(around.iter().any(|p| p.distance(corner) < 1e-12), "{corner} is not among {around:?}");
        }
    }
}
