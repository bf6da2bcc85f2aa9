//! What a candidate promises, in a heap that is brought up to date lazily.

use std::cmp::Ordering;

/// What it would gain to take a candidate, when that was last looked at.
pub(super) struct Gain {
    pub(super) gain: f64,
    pub(super) index: usize,
}

impl Ord for Gain {
    fn cmp(&self, other: &Self) -> Ordering {
        // Ties go to the lesser index, so that the choice is the same on every run.
        self.gain.total_cmp(&other.gain).then(other.index.cmp(&self.index))
    }
}

impl PartialOrd for Gain {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Gain {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Gain {}
