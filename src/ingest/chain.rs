//! Single edges to polylines.

/// Joins edges at the vertices where exactly two meet; lines of vertex numbers, each at least
/// two long. A closed line repeats its first vertex at the end. Loops of one vertex and
/// repeated edges are left out.
///
/// The result depends on the vertex numbers alone, not on the order or direction of the edges.
pub(crate) fn chain(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut both: Vec<[u32; 2]> =
        edges.iter().filter(|[a, b]| a != b).flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    both.sort_unstable();
    both.dedup();
    let mut walk = Walk { used: vec![false; both.len()], both: &both };
    let mut lines = Vec::new();
    // Ends and junctions first; what is left over then is closed loops.
    for ends_only in [true, false] {
        for (n, &[from, _]) in both.iter().enumerate() {
            if !walk.used[n] && (!ends_only || walk.range(from).len() != 2) {
                lines.push(walk.line(n));
            }
        }
    }
    lines
}

/// Every edge in both directions, sorted, and which directions are walked.
struct Walk<'a> {
    both: &'a [[u32; 2]],
    used: Vec<bool>,
}

impl Walk<'_> {
    /// Places of the edges that leave a vertex.
    fn range(&self, vertex: u32) -> std::ops::Range<usize> {
        let start = self.both.partition_point(|edge| edge[0] < vertex);
        start..self.both.partition_point(|edge| edge[0] <= vertex)
    }

    /// Walks from the edge at place `first` to the next end or junction, or round a loop.
    fn line(&mut self, first: usize) -> Vec<u32> {
        let [start, mut at] = self.both[first];
        let mut line = vec![start, at];
        self.mark(first);
        loop {
            let leaving = self.range(at);
            let next = leaving.clone().find(|&n| !self.used[n]);
            match next {
                Some(next) if leaving.len() == 2 => {
                    self.mark(next);
                    at = self.both[next][1];
                    line.push(at);
                }
                _ => return line,
            }
        }
    }

    fn mark(&mut self, place: usize) {
        let [a, b] = self.both[place];
        self.used[place] = true;
        if let Ok(back) = self.both.binary_search(&[b, a]) {
            self.used[back] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_lines_loops_and_junctions() {
        // A path 0-1-2-3, a loop 4-5-6 and a star at 9; given twice, backwards, with a loop 7-7.
        let edges =
            [[2, 1], [3, 2], [0, 1], [1, 0], [5, 4], [6, 5], [4, 6], [7, 7], [9, 8], [10, 9], [9, 11]];
        let lines = chain(&edges);
        let expected: [&[u32]; 5] = [&[0, 1, 2, 3], &[8, 9], &[9, 10], &[9, 11], &[4, 5, 6, 4]];
        assert_eq!(lines, expected);
        let reversed: Vec<_> = edges.iter().rev().map(|&[a, b]| [b, a]).collect();
        assert_eq!(chain(&reversed), lines);
    }
}
