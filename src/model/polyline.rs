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

impl Polylines {
    /// Number of segments over all lines.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.lines.iter().map(|line| line.len().saturating_sub(1)).sum()
    }
}
