//! Which edges of a mesh the given feature lines mean.

use glam::DVec3;
use rayon::prelude::*;

use super::edges::{Edges, crease_cosine, face_normals};
use super::segment_grid::SegmentGrid;
use super::weld::Welded;

/// An edge is meant by a line that passes its ends and its middle within this share of the
/// edge's own length: near enough to tell it from its neighbours.
const NEAR_SHARE: f64 = 0.05;

/// Lines along edges whose faces turn by less (degrees) bound nothing that a smooth splat
/// could not cross, and are left out.
const SMOOTH_DEGREES: f64 = 5.0;

/// What became of the given lines, in segments of mesh edges and lengths in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matched {
    /// Mesh edges marked as feature edges.
    pub edges: usize,
    /// Mesh edges that a line follows but where the surface is smooth.
    pub smooth: usize,
    /// Length of the given lines.
    pub length: f64,
    /// Length of the mesh edges that the lines follow.
    pub matched_length: f64,
}

/// Marks the edges that the given segments (model units) run along.
///
/// A segment from vertex to vertex of the mesh means the edge between them. Only the
/// segments that are no edge are compared by distance.
#[must_use]
pub fn mark(welded: &Welded, edges: &Edges, segments: &[[DVec3; 2]]) -> (Vec<bool>, Matched) {
    let mut meant = vec![false; edges.edges.len()];
    let vertices = VertexGrid::new(&welded.positions);
    let loose: Vec<[DVec3; 2]> = segments
        .iter()
        .filter(|[a, b]| {
            let edge = vertices.at(*a).zip(vertices.at(*b)).and_then(|(a, b)| edges.find(a, b));
            match edge {
                Some(index) => meant[index] = true,
                None => return true,
            }
            false
        })
        .copied()
        .collect();
    if !loose.is_empty() {
        mark_near(welded, edges, loose, &mut meant);
    }
    judge(welded, edges, segments, &meant)
}

/// Marks the edges that pass some segment closely with their ends and their middle.
fn mark_near(welded: &Welded, edges: &Edges, segments: Vec<[DVec3; 2]>, meant: &mut [bool]) {
    let grid = SegmentGrid::new(segments);
    meant.par_iter_mut().zip(&edges.edges).for_each(|(meant, edge)| {
        let [a, b] = edge.ends.map(|v| welded.positions[v as usize].as_dvec3());
        let reach = NEAR_SHARE * a.distance(b);
        *meant |= [a, b, 0.5 * (a + b)].iter().all(|&p| grid.nearest(p, reach).is_some());
    });
}

/// Leaves out edges where the surface is smooth, and adds up what was found.
fn judge(welded: &Welded, edges: &Edges, segments: &[[DVec3; 2]], meant: &[bool]) -> (Vec<bool>, Matched) {
    let normals = face_normals(&welded.positions, &welded.triangles);
    let smooth_cosine = libm::cos(SMOOTH_DEGREES.to_radians());
    let length = segments.iter().map(|[a, b]| a.distance(*b)).sum();
    let mut matched = Matched { length, ..Matched::default() };
    let mut marked = vec![false; meant.len()];
    for (index, edge) in edges.edges.iter().enumerate().filter(|&(index, _)| meant[index]) {
        let [a, b] = edge.ends.map(|v| welded.positions[v as usize].as_dvec3());
        let sharp = crease_cosine(edges, edge, &normals).is_none_or(|cosine| cosine < smooth_cosine);
        matched.matched_length += a.distance(b);
        matched.edges += usize::from(sharp);
        matched.smooth += usize::from(!sharp);
        marked[index] = sharp;
    }
    (marked, matched)
}

/// Finds the vertex at a place, up to the rounding of files.
struct VertexGrid {
    places: Vec<([i32; 3], u32)>,
    positions: Vec<DVec3>,
}

/// Two places nearer than this (model units) are one: a hundred roundings of 32 bits, which
/// covers files that print six digits.
const SAME_PLACE: f64 = 5e-6;

impl VertexGrid {
    fn new(positions: &[glam::Vec3]) -> Self {
        let positions: Vec<DVec3> = positions.iter().map(|p| p.as_dvec3()).collect();
        let mut places: Vec<_> = positions.iter().enumerate().map(|(v, p)| (cell(*p), v as u32)).collect();
        places.sort_unstable();
        Self { places, positions }
    }

    /// The nearest vertex within [`SAME_PLACE`].
    fn at(&self, point: DVec3) -> Option<u32> {
        let (low, high) = (cell(point - SAME_PLACE), cell(point + SAME_PLACE));
        let mut best: Option<(f64, u32)> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                let from = self.places.partition_point(|(cell, _)| *cell < [x, y, low[2]]);
                let column = self.places[from..].iter().take_while(|(cell, _)| *cell <= [x, y, high[2]]);
                for &(_, vertex) in column {
                    let distance = self.positions[vertex as usize].distance(point);
                    if distance <= SAME_PLACE && best.is_none_or(|(least, _)| distance < least) {
                        best = Some((distance, vertex));
                    }
                }
            }
        }
        best.map(|(_, vertex)| vertex)
    }
}

fn cell(point: DVec3) -> [i32; 3] {
    (point / (4.0 * SAME_PLACE)).floor().as_ivec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn lines_along_edges_are_found_exactly_and_nearly() {
        // Two squares that meet at a right angle along x = 0 .. 1.
        let positions = [
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            (1.0, 1.0, 0.0),
            (0.0, 0.0, 1.0),
            (1.0, 0.0, 1.0),
        ]
        .map(|(x, y, z)| Vec3::new(x, y, z))
        .to_vec();
        let triangles = vec![[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]];
        let welded = Welded { positions, triangles, ..Welded::default() };
        let edges = Edges::of(&welded.triangles);
        for shift in [0.0, 1e-6, 1e-2] {
            let line = [DVec3::new(0.0, shift, 0.0), DVec3::new(1.0, shift, 0.0)];
            let (marked, matched) = mark(&welded, &edges, &[line]);
            let found: Vec<_> =
                edges.edges.iter().zip(&marked).filter(|(_, m)| **m).map(|(e, _)| e.ends).collect();
            assert_eq!(found, [[0, 1]], "shift {shift}");
            assert!((matched.matched_length - 1.0).abs() < 1e-9);
        }
        let (marked, _) = mark(&welded, &edges, &[[DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)]]);
        assert!(marked.iter().all(|mark| !mark), "a line across a flat face bounds nothing");
    }
}
