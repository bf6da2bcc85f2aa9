//! Feature lines that end inside the surface, carried on a little beyond.
//!
//! A splat at the end of a line is cut by it on one side only if there is a border to follow beyond
//! the end, too: else the walk over the surface comes around the end to the other side. So the
//! surface is cut a little farther, where nothing is to be seen of it.

use super::edge_paths::EdgePaths;
use super::edges::Edges;
use super::weld::Welded;

/// Lines are carried on by this many error bounds, since a splat beside the end must end where the
/// cut does. With 4 the teapot's file is 12 % larger; with 32 and 64 files are within 3 %, mostly larger.
const CARRIED: f64 = 16.0;

/// And by this many edges at most, so that a coarse bound carries no line across a dense mesh.
const MOST: usize = 8;

/// The edges, ascending, along which lines go on beyond their ends inside the surface.
#[must_use]
pub fn carried(welded: &Welded, edges: &Edges, marked: &[bool], max_error: f64) -> Vec<u32> {
    if !marked.contains(&true) {
        return Vec::new();
    }
    let ends = Ends { paths: EdgePaths::new(welded, edges, |_| true), edges, marked };
    let mut carried: Vec<u32> =
        ends.loose().flat_map(|(edge, end)| ends.path(edge, end, max_error)).collect();
    carried.sort_unstable();
    carried.dedup();
    carried
}

/// The ends of the lines along a mesh's edges.
struct Ends<'a> {
    paths: EdgePaths<'a>,
    edges: &'a Edges,
    marked: &'a [bool],
}

impl Ends<'_> {
    /// How many edges that bound the surface meet at a vertex.
    fn borders(&self, vertex: u32) -> usize {
        self.paths.bounding(vertex, self.marked).count()
    }

    /// Marked edges with an end where nothing else bounds the surface.
    fn loose(&self) -> impl Iterator<Item = (u32, u32)> {
        let marked = self.edges.edges.iter().zip(0_u32..).filter(|&(_, index)| self.marked[index as usize]);
        let ends = marked.flat_map(|(edge, index)| edge.ends.map(|end| (index, end)));
        ends.filter(|&(_, end)| self.borders(end) == 1)
    }

    /// The edges that go on from an end, as straight as there are, until they meet a border.
    fn path(&self, mut edge: u32, mut end: u32, max_error: f64) -> Vec<u32> {
        let (mut path, mut length) = (Vec::new(), 0.0);
        while path.len() < MOST && length < CARRIED * max_error {
            let Some(next) = self.paths.onward(edge, end) else { break };
            length += self.paths.length(next);
            path.push(next);
            (edge, end) = (next, self.paths.beyond(next, end));
            if self.borders(end) > 0 {
                break;
            }
        }
        path
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
