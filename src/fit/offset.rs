//! Moves a directed outline outward, away from the surface on its left.

use glam::DVec2;

/// On the narrow side of a corner no mitre is longer than this many offsets.
const LONGEST_MITER: f64 = 4.0;

/// A polyline that turns by more than this at a vertex (sine of 15°) may have a corner there.
pub const CORNER_SINE: f64 = 0.26;

/// Whether a line turns left by more than `sine` between two directions: a convex corner of the surface.
#[must_use]
pub fn is_corner(before: DVec2, after: DVec2, sine: f64) -> bool {
    before.perp_dot(after) > sine || (before.dot(after) < 0.0 && before.perp_dot(after) > 0.0)
}

/// Whether a line turns sharply between two directions, to either side.
#[must_use]
pub fn turns_sharply(before: DVec2, after: DVec2) -> bool {
    is_corner(before, after, CORNER_SINE) || is_corner(after, before, CORNER_SINE)
}

/// The outline with every side moved to its right by `by`, or by less, corners mitred.
///
/// The more acute a corner is, the farther from it lies the mitre's tip, beyond a convex one or in the notch that a
/// concave one leaves. `beside` says by how much its sides
/// may be moved, `by` at most, where the mitre is so many times as long as that. Then all of both its
/// arms, as far as the next convex corners, are moved by no more: what one curve can follow, it still
/// can. Where `beside` says `None`, a convex corner becomes two: both sides go on by `by` past the vertex, as
/// the caps of strokes do, so that even a side that runs straight back keeps its distance from both.
/// Repeated points are dropped. A closed outline does not repeat its first point.
#[must_use]
pub fn outward(line: &[DVec2], closed: bool, by: f64, beside: impl Fn(f64) -> Option<f64>) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = line.to_vec();
    points.dedup();
    if closed && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 2 {
        return points;
    }
    let turns = turns(&points, closed);
    let moves = moves(&turns, by, &beside);
    let mut moved = Vec::with_capacity(points.len());
    for (&point, turn) in points.iter().zip(&turns) {
        let &Turn { before, after, sides } = turn;
        let [first, second] = sides.map(|side| moves[side]);
        if turn.is_convex() && beside(turn.miter()).is_none() {
            moved.push(point + first * before + by * before.perp());
            moved.push(point + second * after - by * after.perp());
        } else if (first - second).abs() > 0.0 {
            // They differ at corners alone: there the two lines, each moved, do meet.
            let sine = before.perp_dot(after);
            moved.push(point + (second * before.perp() - first * after.perp()) / sine);
        } else {
            moved.push(point + first * turn.mitered());
        }
    }
    moved
}

/// A vertex of an outline.
struct Turn {
    /// Unit normals, to the right of the sides before and after; both of the one side at an open end.
    before: DVec2,
    after: DVec2,
    /// The numbers of these sides.
    sides: [usize; 2],
}

impl Turn {
    fn is_convex(&self) -> bool {
        self.sides[0] != self.sides[1] && self.before.perp_dot(self.after) >= 0.0
    }

    /// How many times as long the mitre is as the sides are moved by.
    fn miter(&self) -> f64 {
        (2.0 / self.share()).sqrt()
    }

    /// The mitre of sides that are moved by one.
    fn mitered(&self) -> DVec2 {
        let share = self.share();
        let miter = if share > 0.0 { (self.before + self.after) / share } else { self.before };
        if self.is_convex() { miter } else { miter.clamp_length_max(LONGEST_MITER) }
    }

    /// `|before + after|` over this is the mitre's length, which is the root of 2 over this.
    fn share(&self) -> f64 {
        (1.0 + self.before.dot(self.after)).max(0.0)
    }

    /// Whether an arm ends here.
    fn ends_arm(&self) -> bool {
        self.sides[0] == self.sides[1] || is_corner(self.before, self.after, CORNER_SINE)
    }
}

/// The vertices of an outline of at least two.
fn turns(points: &[DVec2], closed: bool) -> Vec<Turn> {
    let count = points.len();
    let sides = if closed { count } else { count - 1 };
    let normals: Vec<DVec2> = (0..sides)
        .map(|side| -(points[(side + 1) % count] - points[side]).perp().normalize_or_zero())
        .collect();
    let turn = |n: usize| {
        let before = if closed { (n + sides - 1) % sides } else { n.saturating_sub(1) };
        let after = n.min(sides - 1);
        Turn { before: normals[before], after: normals[after], sides: [before, after] }
    };
    (0..count).map(turn).collect()
}

/// By how much each side is moved.
fn moves(turns: &[Turn], by: f64, beside: &impl Fn(f64) -> Option<f64>) -> Vec<f64> {
    let count = turns.len();
    let mut moves = vec![by; count];
    for (n, turn) in turns.iter().enumerate() {
        let Some(less) = beside(turn.miter()).filter(|less| *less < by) else { continue };
        // Both ways, vertex by vertex, as far as the arms go.
        for (way, side) in [(count - 1, 0), (1, 1)] {
            let mut at = n;
            loop {
                let side = turns[at].sides[side];
                moves[side] = moves[side].min(less);
                at = (at + way) % count;
                if at == n || turns[at].ends_arm() {
                    break;
                }
            }
        }
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the mitre, up to four times the move, sides are moved as far.
    fn alike(by: f64) -> impl Fn(f64) -> Option<f64> {
        move |miter| (miter <= 4.0).then_some(by)
    }

    #[test]
    fn a_square_grows_on_all_sides() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let grown = outward(&square, true, 0.5, alike(0.5));
        assert!(
            grown[0].distance(DVec2::splat(-0.5)) < 1e-12 && grown[2].distance(DVec2::splat(1.5)) < 1e-12
        );
    }

    #[test]
    fn a_line_there_and_back_gets_a_rectangle_around_it() {
        let line = [(0.0, 0.0), (1.0, 0.0), (3.0, 0.0)].map(|(x, y)| DVec2::new(x, y));
        let around = outward(&line, true, 0.5, alike(0.5));
        for corner in [(-0.5, -0.5), (3.5, -0.5), (3.5, 0.5), (-0.5, 0.5)] {
            let corner = DVec2::from(corner);
            assert!(around.iter().any(|p| p.distance(corner) < 1e-12), "{corner} is not among {around:?}");
        }
    }

    #[test]
    fn the_arms_of_an_acute_corner_are_moved_by_less_as_far_as_they_go() {
        // The tip of a kite, whose arms are of two sides each, then blunt corners.
        let kite = [(0.0, 0.0), (2.0, -1.0), (4.0, -2.0), (6.0, 0.0), (4.0, 2.0), (2.0, 1.0)];
        let kite = kite.map(DVec2::from);
        let most = 0.2;
        let moved = outward(&kite, true, 0.1, |miter| Some(f64::min(0.1, most / miter)));
        assert!(moved[0].distance(DVec2::new(-most, 0.0)) < 1e-12, "{moved:?}");
        let off = |n: usize, from: usize, to: usize| {
            let out = -(kite[to] - kite[from]).perp().normalize();
            (moved[n] - kite[from]).dot(out)
        };
        let arm = most * libm::sin(libm::atan(0.5));
        for (n, from, to) in [(0, 0, 1), (1, 0, 1), (2, 1, 2), (4, 4, 5), (5, 5, 0), (0, 5, 0)] {
            assert!((off(n, from, to) - arm).abs() < 1e-12, "side {from} to {to} at {n}");
        }
        for (n, from, to) in [(2, 2, 3), (3, 2, 3), (3, 3, 4), (4, 3, 4)] {
            assert!((off(n, from, to) - 0.1).abs() < 1e-12, "side {from} to {to} at {n}");
        }
    }

    #[test]
    fn an_open_line_s_arms_end_with_it_and_in_a_notch_they_are_moved_by_less_too() {
        let line = [(4.0, 2.0), (2.0, 1.0), (0.0, 0.0), (4.0, -2.0)].map(DVec2::from);
        let beside = |miter| Some(if miter > 2.0 { 0.05 } else { 0.1 });
        let moved = outward(&line, false, 0.1, beside);
        let up = DVec2::new(-1.0, 2.0).normalize();
        assert!(moved[0].distance(line[0] + 0.05 * up) < 1e-12 && moved.len() == 4, "{moved:?}");
        let back: Vec<DVec2> = line.iter().rev().copied().collect();
        let inside = outward(&back, false, 0.1, beside);
        assert!(inside[0].distance(back[0] + 0.05 * DVec2::new(1.0, 2.0).normalize()) < 1e-12, "{inside:?}");
    }
}
