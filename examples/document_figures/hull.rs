//! The convex hull of points in the plane.

use glam::DVec2;
use qsplat::model::clip_curve::turn;

/// Which points are corners of the convex hull of all (Andrew's monotone chain, 1979).
pub fn hull(points: &[DVec2]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&a, &b| {
        let (p, q) = (points[a], points[b]);
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(a.cmp(&b))
    });
    let mut corners = chain(points, order.iter().copied());
    corners.extend(chain(points, order.iter().rev().copied()));
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// The corners below the sorted points, from the first to the last.
fn chain(points: &[DVec2], order: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut corners: Vec<usize> = Vec::new();
    for next in order {
        while let [.., a, b] = corners[..]
            && turn(points[a], points[b], points[next]) <= 0.0
        {
            corners.pop();
        }
        corners.push(next);
    }
    corners
}
