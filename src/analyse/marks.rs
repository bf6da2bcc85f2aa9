//! A set of numbered things that is emptied at once, for walks that are made again and again.

/// Which of `0..n` a walk has met.
#[derive(Debug)]
pub struct Marks {
    /// The round in which each was marked last.
    stamps: Vec<u32>,
    round: u32,
}

impl Marks {
    /// None of `count` things is marked.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { stamps: vec![0; count], round: 1 }
    }

    /// Unmarks all.
    pub fn clear(&mut self) {
        if self.round == u32::MAX {
            self.stamps.fill(0);
            self.round = 0;
        }
        self.round += 1;
    }

    /// Marks one; whether it was new.
    pub fn insert(&mut self, index: u32) -> bool {
        std::mem::replace(&mut self.stamps[index as usize], self.round) != self.round
    }

    /// Whether one is marked.
    #[must_use]
    pub fn contains(&self, index: u32) -> bool {
        self.stamps[index as usize] == self.round
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_marked_is_forgotten_at_once_even_after_the_last_round() {
        let mut marks = Marks::new(3);
        assert!(marks.insert(1) && !marks.insert(1) && marks.contains(1) && !marks.contains(0));
        marks.round = u32::MAX - 1;
        for _ in 0..3 {
            marks.clear();
            assert!((0..3).all(|index| !marks.contains(index)));
            assert!(marks.insert(2) && marks.contains(2));
        }
    }
}
