//! How much of some lines lies along others: precision and recall of found feature lines.

use glam::DVec3;

use crate::analyse::segment_grid::SegmentGrid;

/// Samples a reach: the share is known to about a percent of the lines' own length.
const SAMPLES: f64 = 4.0;

/// More samples than this on one segment tell no more.
const MOST: usize = 4096;

/// The share of the length of `lines` that lies within `reach` of some of `others`; 1 for lines of
/// no length. All in model units.
#[must_use]
pub fn share_near(lines: &[Vec<DVec3>], others: &[Vec<DVec3>], reach: f64) -> f64 {
    let segments = |lines: &[Vec<DVec3>]| -> Vec<[DVec3; 2]> {
        lines.iter().flat_map(|line| line.windows(2)).map(|pair| [pair[0], pair[1]]).collect()
    };
    let grid = SegmentGrid::new(segments(others));
    let (mut whole, mut near) = (0.0, 0.0);
    for [a, b] in segments(lines) {
        let length = a.distance(b);
        let samples = ((SAMPLES * length / reach).ceil() as usize).clamp(1, MOST);
        let place = |n: usize| a.lerp(b, (n as f64 + 0.5) / samples as f64);
        let found = (0..samples).filter(|&n| grid.nearest(place(n), reach).is_some()).count();
        whole += length;
        near += length * found as f64 / samples as f64;
    }
    if whole > 0.0 { near / whole } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_line_is_half() {
        let line = |x: f64, y: f64| vec![vec![DVec3::new(0.0, y, 0.0), DVec3::new(x, y, 0.0)]];
        for (others, expected) in [(line(0.5, 0.0), 0.51), (line(1.0, 0.009), 1.0), (line(1.0, 0.02), 0.0)] {
            let found = share_near(&line(1.0, 0.0), &others, 0.01);
            assert!((found - expected).abs() < 5e-3, "{found} {expected}");
        }
        assert!((share_near(&[], &line(1.0, 0.0), 0.01) - 1.0).abs() < 1e-12);
        assert!(share_near(&line(1.0, 0.0), &[], 0.01) < 1e-12);
    }
}
