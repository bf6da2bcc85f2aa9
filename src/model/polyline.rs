//! Feature lines as they were read.

use glam::DVec3;

/// Polylines in *input* coordinates (64 bits): where the surface has sharp edges or ends.
///
/// A closed line repeats its first point at the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polylines {
    /// Each line's points in order, at least two.
    pub lines: Vec<Vec<DVec3>>,
}

/// Whether a line ends where it begins.
#[must_use]
pub fn is_closed(line: &[DVec3]) -> bool {
    line.len() > 2 && line.first() == line.last()
}

impl Polylines {
    /// Number of segments over all lines.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.lines.iter().map(|line| line.len().saturating_sub(1)).sum()
    }

    /// Length of all lines, in input units.
    #[must_use]
    pub fn length(&self) -> f64 {
        let segments = self.lines.iter().flat_map(|line| line.windows(2));
        segments.map(|pair| pair[0].distance(pair[1])).fold(0.0, |sum, length| sum + length)
    }
}
