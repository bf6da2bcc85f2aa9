//! Which edges of a mesh meet at a vertex, and which of them carries another straight on.

use glam::DVec3;

use super::edges::Edges;
use super::surface::Rows;
use super::weld::Welded;

/// An edge goes on only in those that bend from it by less than this (cosine of 45°).
pub const STRAIGHT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Some edges of a mesh, by the vertices they meet at.
#[derive(Debug)]
pub struct EdgePaths<'a> {
    welded: &'a Welded,
    edges: &'a Edges,
    at_vertex: Rows,
}

impl<'a> EdgePaths<'a> {
    /// The paths along those edges whose index is `taken`.
    #[must_use]
    pub fn new(welded: &'a Welded, edges: &'a Edges, taken: impl Fn(usize) -> bool) -> Self {
        let taken = || edges.edges.iter().zip(0_u32..).filter(|&(_, index)| taken(index as usize));
        let ends = || taken().flat_map(|(edge, index)| edge.ends.map(|end| (end, index)));
        Self { welded, edges, at_vertex: Rows::placed(welded.positions.len(), ends) }
    }

    /// The edges that meet at a vertex, ascending.
    #[must_use]
    pub fn around(&self, vertex: u32) -> &[u32] {
        self.at_vertex.row(vertex)
    }

    /// Those of them that bound the surface: marked ones, and those where it ends.
    pub fn bounding(&self, vertex: u32, marked: &[bool]) -> impl Iterator<Item = u32> {
        let bounds = |index: u32| {
            marked[index as usize] || self.edges.pair(&self.edges.edges[index as usize]).is_none()
        };
        self.around(vertex).iter().copied().filter(move |&index| bounds(index))
    }

    /// The other end of an edge.
    #[must_use]
    pub fn beyond(&self, index: u32, vertex: u32) -> u32 {
        let [a, b] = self.edges.edges[index as usize].ends;
        if a == vertex { b } else { a }
    }

    /// The length of an edge, model units.
    #[must_use]
    pub fn length(&self, index: u32) -> f64 {
        let [a, b] = self.welded.places(self.edges.edges[index as usize].ends);
        a.distance(b)
    }

    /// The direction in which an edge leaves a vertex.
    #[must_use]
    pub fn away(&self, index: u32, vertex: u32) -> DVec3 {
        let [from, to] = self.welded.places([vertex, self.beyond(index, vertex)]);
        (to - from).normalize_or_zero()
    }

    /// The edge that goes on beyond the end of another, as straight as there is.
    #[must_use]
    pub fn onward(&self, edge: u32, vertex: u32) -> Option<u32> {
        let back = self.away(edge, vertex);
        let others = self.around(vertex).iter().filter(|&&index| index != edge);
        let straight = others.map(|&index| (self.away(index, vertex).dot(-back), index));
        let straight = straight.filter(|&(straight, _)| straight > STRAIGHT);
        straight.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).map(|(_, index)| index)
    }
}
