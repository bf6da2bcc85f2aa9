//! Feature lines that end inside the surface, carried on a little beyond.
//!
//! A splat at the end of a line is cut by it on one side only if there is a border to follow beyond
//! the end, too: else the walk over the surface comes around the end to the other side. So the
//! surface is cut a little farther, where nothing is to be seen of it.

use glam::DVec3;

use super::edges::Edges;
use super::weld::Welded;

/// Lines are carried on by this many error bounds: a splat that ends there covers more than it costs.
const CARRIED: f64 = 16.0;

/// And by this many edges at most.
const MOST: usize = 8;

/// They go on only along edges that bend from them by less than this (cosine of 45°).
const STRAIGHT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The edges, ascending, along which lines go on beyond their ends inside the surface.
#[must_use]
pub fn carried(welded: &Welded, edges: &Edges, marked: &[bool], max_error: f64) -> Vec<u32> {
    let ends = Ends::new(welded, edges, marked);
    let mut carried: Vec<u32> =
        ends.loose().flat_map(|(edge, end)| ends.path(edge, end, max_error)).collect();
    carried.sort_unstable();
    carried.dedup();
    carried
}

/// The edges of a mesh by the vertices they meet at.
struct Ends<'a> {
    welded: &'a Welded,
    edges: &'a Edges,
    marked: &'a [bool],
    /// Vertex and edge, sorted.
    at_vertex: Vec<(u32, u32)>,
}

impl<'a> Ends<'a> {
    fn new(welded: &'a Welded, edges: &'a Edges, marked: &'a [bool]) -> Self {
        let ends = edges.edges.iter().zip(0_u32..);
        let mut at_vertex: Vec<(u32, u32)> =
            ends.flat_map(|(edge, index)| edge.ends.map(|end| (end, index))).collect();
        at_vertex.sort_unstable();
        Self { welded, edges, marked, at_vertex }
    }

    fn around(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let from = self.at_vertex.partition_point(|entry| entry.0 < vertex);
        self.at_vertex[from..].iter().take_while(move |entry| entry.0 == vertex).map(|entry| entry.1)
    }

    /// Whether an edge bounds the surface, as a feature edge or because it ends there.
    fn bounds(&self, index: u32) -> bool {
        self.marked[index as usize] || self.edges.pair(&self.edges.edges[index as usize]).is_none()
    }

    /// Marked edges with an end where nothing else bounds the surface.
    fn loose(&self) -> impl Iterator<Item = (u32, u32)> {
        let marked = self.edges.edges.iter().zip(0_u32..).filter(|&(_, index)| self.marked[index as usize]);
        let ends = marked.flat_map(|(edge, index)| edge.ends.map(|end| (index, end)));
        ends.filter(|&(_, end)| self.around(end).filter(|&index| self.bounds(index)).count() == 1)
    }

    /// The edges that go on from an end, as straight as there are, until they meet a border.
    fn path(&self, edge: u32, end: u32, max_error: f64) -> Vec<u32> {
        let (mut path, mut edge, mut end, mut length) = (Vec::new(), edge, end, 0.0);
        while path.len() < MOST && length < CARRIED * max_error {
            let back = self.leaving(edge, end).normalize_or_zero();
            let others = self.around(end).filter(|&index| index != edge);
            let straight =
                others.map(|index| (self.leaving(index, end).normalize_or_zero().dot(-back), index));
            let best = straight.filter(|&(straight, _)| straight > STRAIGHT);
            let Some((_, next)) = best.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) else { break };
            length += self.leaving(next, end).length();
            path.push(next);
            (edge, end) = (next, self.beyond(next, end));
            if self.around(end).any(|index| self.bounds(index)) {
                break;
            }
        }
        path
    }

    /// The other end of an edge.
    fn beyond(&self, index: u32, vertex: u32) -> u32 {
        let [a, b] = self.edges.edges[index as usize].ends;
        if a == vertex { b } else { a }
    }

    /// An edge as it leaves a vertex.
    fn leaving(&self, index: u32, vertex: u32) -> DVec3 {
        let [from, to] = self.welded.places([vertex, self.beyond(index, vertex)]);
        to - from
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Steps along a side.
    const SIDE: u32 = 8;

    /// A square of unit cells, and which of its edges run along `y = 4` between two steps, or
    /// along `x = across`.
    fn square(along: std::ops::Range<u32>, across: Option<u32>) -> (Welded, Edges, Vec<bool>) {
        let row = SIDE + 1;
        let positions = (0..row * row).map(|n| Vec3::new((n % row) as f32, (n / row) as f32, 0.0));
        let cells = (0..SIDE * SIDE).map(|n| n / SIDE * row + n % SIDE);
        let triangles = cells.flat_map(|n| [[n, n + 1, n + row], [n + 1, n + row + 1, n + row]]);
        let welded =
            Welded { positions: positions.collect(), triangles: triangles.collect(), ..Welded::default() };
        let edges = Edges::of(&welded.triangles);
        let marked = |[a, b]: [u32; 2]| {
            let ((ax, ay), (bx, by)) = ((a % row, a / row), (b % row, b / row));
            let on = ay == 4 && by == 4 && along.contains(&ax.min(bx));
            on || (ax == bx && across == Some(ax))
        };
        let marked = edges.edges.iter().map(|edge| marked(edge.ends)).collect();
        (welded, edges, marked)
    }

    /// The steps along `y = 4` that a line is carried on by.
    fn steps(along: std::ops::Range<u32>, across: Option<u32>, max_error: f64) -> Vec<u32> {
        let (welded, edges, marked) = square(along, across);
        let ends = carried(&welded, &edges, &marked, max_error).into_iter();
        let ends = ends.map(|edge| edges.edges[edge as usize].ends);
        ends.inspect(|ends| assert!(ends.iter().all(|end| end / (SIDE + 1) == 4)))
            .map(|[a, b]| a.min(b) % (SIDE + 1))
            .collect()
    }

    #[test]
    fn lines_are_carried_on_from_loose_ends_alone() {
        assert_eq!(steps(0..4, None, 0.1), [4, 5], "as far as the bound asks");
        assert_eq!(steps(0..4, None, 1.0), [4, 5, 6, 7], "to the border");
        assert_eq!(steps(3..5, None, 0.06), [2, 5], "from both ends");
        assert_eq!(steps(0..4, Some(6), 1.0), [4, 5], "to another line");
        assert_eq!(steps(0..SIDE, None, 1.0), [0; 0], "a line from border to border");
    }
}
