//! Which edges of a mesh the given feature lines mean.

use glam::DVec3;
use rayon::prelude::*;

use super::chains::{Chain, chains};
use super::edges::{Edges, crease_cosine, face_normals};
use super::segment_grid::SegmentGrid;
use super::weld::Welded;

/// An edge is meant by a line that passes its ends and its middle within this share of the
/// edge's own length: near enough to tell it from its neighbours.
const NEAR_SHARE: f64 = 0.05;

/// Lines along edges whose faces turn by less (degrees) bound nothing that a smooth splat
/// could not cross, and are left out.
const SMOOTH_DEGREES: f64 = 5.0;

/// Nor do lines whose faces turn by less than [`SMOOTH_DEGREES`] on the mean and nowhere by this
/// much: the seams of round faces, as coarse as their facets are.
const SHARP_DEGREES: f64 = 10.0;

/// What became of the given lines, in segments of mesh edges and lengths in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matched {
    /// Mesh edges marked as feature edges.
    pub edges: usize,
    /// Length of the given lines.
    pub length: f64,
    /// Length of the mesh edges that the lines follow.
    pub matched_length: f64,
    /// Length of those at which the surface is smooth: they are no feature edges.
    pub smooth_length: f64,
}

/// What given lines mean on a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meant {
    /// For each edge of the mesh, whether it is a feature edge.
    pub marked: Vec<bool>,
    /// For each given segment, whether it runs along edges at which the surface is smooth.
    pub smooth: Vec<bool>,
    /// What became of the lines.
    pub matched: Matched,
}

/// Marks the edges that the given segments (model units) run along.
///
/// A segment from vertex to vertex of the mesh means the edge between them. Only the
/// segments that are no edge are compared by distance.
#[must_use]
pub fn mark(welded: &Welded, edges: &Edges, segments: &[[DVec3; 2]]) -> Meant {
    let vertices = VertexGrid::new(&welded.positions);
    let exact = |[a, b]: &[DVec3; 2]| edges.find(vertices.at(*a)?, vertices.at(*b)?);
    let exact: Vec<Option<usize>> = segments.iter().map(exact).collect();
    let mut followed = vec![false; edges.edges.len()];
    exact.iter().flatten().for_each(|&edge| followed[edge] = true);
    let loose =
        || segments.iter().zip(&exact).filter(|(_, exact)| exact.is_none()).map(|(segment, _)| *segment);
    if loose().next().is_some() {
        mark_near(welded, edges, loose().collect(), &mut followed);
    }
    let marked = sharp(welded, edges, &followed);
    let matched = Matched {
        length: segments.iter().map(|[a, b]| a.distance(*b)).sum(),
        ..matched(welded, edges, &followed, &marked)
    };
    Meant { smooth: smooth(welded, edges, segments, &exact, &followed, &marked), marked, matched }
}

/// Marks the edges that pass some segment closely with their ends and their middle.
fn mark_near(welded: &Welded, edges: &Edges, segments: Vec<[DVec3; 2]>, followed: &mut [bool]) {
    let grid = SegmentGrid::new(segments);
    followed.par_iter_mut().zip(&edges.edges).for_each(|(followed, edge)| {
        let [a, b] = place(welded, edge.ends);
        let reach = NEAR_SHARE * a.distance(b);
        *followed |= [a, b, 0.5 * (a + b)].iter().all(|&p| grid.nearest(p, reach).is_some());
    });
}

/// Which of the edges that lines follow are creases or borders.
fn sharp(welded: &Welded, edges: &Edges, followed: &[bool]) -> Vec<bool> {
    let normals = face_normals(&welded.positions, &welded.triangles);
    let mut sharp = vec![false; followed.len()];
    for Chain { edges: chain, .. } in chains(welded.positions.len(), edges, followed) {
        let turn = |&edge: &u32| {
            let cosine = crease_cosine(edges, &edges.edges[edge as usize], &normals);
            cosine.map_or(180.0, |cosine| libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees())
        };
        let length = |&edge: &u32| {
            let [a, b] = place(welded, edges.edges[edge as usize].ends);
            a.distance(b)
        };
        let most = chain.iter().map(turn).fold(0.0, f64::max);
        let turned: f64 = chain.iter().map(|edge| turn(edge) * length(edge)).sum();
        let is_seam = most < SHARP_DEGREES && turned < SMOOTH_DEGREES * chain.iter().map(length).sum::<f64>();
        for edge in chain {
            sharp[edge as usize] = !is_seam && turn(&edge) >= SMOOTH_DEGREES;
        }
    }
    sharp
}

/// Adds up what the lines follow.
fn matched(welded: &Welded, edges: &Edges, followed: &[bool], marked: &[bool]) -> Matched {
    let mut matched = Matched::default();
    for (index, edge) in edges.edges.iter().enumerate().filter(|&(index, _)| followed[index]) {
        let [a, b] = place(welded, edge.ends);
        let length = a.distance(b);
        matched.edges += usize::from(marked[index]);
        matched.matched_length += length;
        matched.smooth_length += if marked[index] { 0.0 } else { length };
    }
    matched
}

/// Which segments run along edges that are followed but not marked. One that is no edge of the
/// mesh is judged by the edge followed that passes its middle the nearest.
fn smooth(
    welded: &Welded,
    edges: &Edges,
    segments: &[[DVec3; 2]],
    exact: &[Option<usize>],
    followed: &[bool],
    marked: &[bool],
) -> Vec<bool> {
    let of: Vec<usize> = (0..followed.len()).filter(|&index| followed[index]).collect();
    let grid = SegmentGrid::new(of.iter().map(|&index| place(welded, edges.edges[index].ends)).collect());
    let near = |[a, b]: [DVec3; 2]| {
        let nearest = grid.nearest(0.5 * (a + b), a.distance(b))?;
        let [from, to] = grid.segment(nearest.segment);
        let close = nearest.distance <= NEAR_SHARE * from.distance(to);
        close.then(|| of[nearest.segment as usize])
    };
    let edge = |(segment, exact): (&[DVec3; 2], &Option<usize>)| exact.or_else(|| near(*segment));
    segments.iter().zip(exact).map(edge).map(|edge| edge.is_some_and(|edge| !marked[edge])).collect()
}

fn place(welded: &Welded, ends: [u32; 2]) -> [DVec3; 2] {
    ends.map(|v| welded.positions[v as usize].as_dvec3())
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
            let Meant { marked, matched, smooth } = mark(&welded, &edges, &[line]);
            let found: Vec<_> =
                edges.edges.iter().zip(&marked).filter(|(_, m)| **m).map(|(e, _)| e.ends).collect();
            assert_eq!(found, [[0, 1]], "shift {shift}");
            assert!((matched.matched_length - 1.0).abs() < 1e-9 && matched.smooth_length == 0.0);
            assert_eq!(smooth, [false]);
        }
        let across = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
        let Meant { marked, matched, smooth } = mark(&welded, &edges, &[across]);
        assert!(marked.iter().all(|mark| !mark), "a line across a flat face bounds nothing");
        assert!(smooth[0] && matched.smooth_length == matched.matched_length);
        let beyond = [DVec3::new(0.3, 0.5, 0.0), DVec3::new(0.4, 0.5, 0.0)];
        assert_eq!(mark(&welded, &edges, &[beyond]).smooth, [false], "along no edge, nothing is known");
    }

    /// A strip of quads whose rows `[0, 1]`, `[1, 2]` turn by these angles, one a column, degrees.
    fn fold(degrees: &[f32]) -> (Welded, Vec<[DVec3; 2]>) {
        let row = |side: f32| {
            degrees.iter().enumerate().map(move |(n, turn)| {
                let drop = if side > 0.0 { turn.to_radians().tan() } else { 0.0 };
                Vec3::new(n as f32, side, -drop)
            })
        };
        let positions: Vec<Vec3> = [-1.0, 0.0].into_iter().flat_map(row).chain(row(1.0)).collect();
        let count = degrees.len() as u32;
        let quad = |at: u32| [[at, at + 1, at + count], [at + 1, at + count + 1, at + count]];
        let triangles =
            (0..2).flat_map(|r| (0..count - 1).map(move |n| r * count + n)).flat_map(quad).collect();
        // On the middle row nothing drops.
        let positions: Vec<Vec3> =
            positions.into_iter().map(|p| if p.y == 0.0 { p.with_z(0.0) } else { p }).collect();
        let line = |n: u32| [n, n + 1].map(|n| positions[(count + n) as usize].as_dvec3());
        let lines = (0..count - 1).map(line).collect();
        (Welded { positions, triangles, ..Welded::default() }, lines)
    }

    fn marked_of(degrees: &[f32]) -> usize {
        let (welded, lines) = fold(degrees);
        mark(&welded, &Edges::of(&welded.triangles), &lines).matched.edges
    }

    #[test]
    fn seams_of_round_faces_bound_nothing_and_creases_that_fade_do_where_they_are_sharp() {
        assert_eq!(marked_of(&[6.0; 9]), 8, "a shallow crease");
        assert_eq!(marked_of(&[3.0, 3.0, 3.0, 6.0, 6.0, 3.0, 3.0, 3.0, 3.0]), 0, "a seam");
        let fading = marked_of(&[40.0, 30.0, 20.0, 10.0, 2.0, 1.0, 0.0, 0.0, 0.0]);
        assert!((3..=4).contains(&fading), "{fading} edges of a crease that fades");
    }
}
