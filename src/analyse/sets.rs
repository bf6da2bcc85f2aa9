//! Disjoint sets (Galler and Fischer 1964), with halving of paths.

/// Sets that merge, over `0..len`.
pub struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    /// `len` sets of one member each.
    #[must_use]
    pub fn new(len: usize) -> Self {
        Self { parent: (0..len as u32).collect() }
    }

    /// The least member of a member's set.
    pub fn root(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let up = self.parent[x as usize];
            self.parent[x as usize] = self.parent[up as usize];
            x = self.parent[x as usize];
        }
        x
    }

    /// Joins two sets. The least member becomes the root, so that roots do not depend on the order of merges.
    pub fn merge(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high as usize] = low;
    }
}
