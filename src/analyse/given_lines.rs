//! Which edges of a mesh the given feature lines mean.

use glam::DVec3;
use rayon::prelude::*;

use super::chains::{Chain, chains};
use super::edges::{Edges, crease_cosine, face_normals};
use super::refine::length;
use super::segment_grid::SegmentGrid;
use super::snap::{Piece, pieces, snap};
use super::weld::Welded;

/// An edge is meant by a line that passes its ends and its middle within this share of the
/// edge's own length: near enough to tell it from its neighbours.
const NEAR_SHARE: f64 = 0.05;

/// Lines along edges whose faces turn by less (degrees) bound nothing that a smooth splat
/// could not cross, and are left out.
pub(super) const SMOOTH_DEGREES: f64 = 5.0;

/// Nor do lines whose faces turn by less than [`SMOOTH_DEGREES`] on the mean and nowhere by this
/// much: the seams of round faces, as coarse as their facets are.
pub(super) const SHARP_DEGREES: f64 = 10.0;

/// What an edge counts as that does not join two agreeing faces: it ends the surface.
const OPEN_DEGREES: f64 = 180.0;

/// What became of the given lines, in segments of mesh edges and lengths in model units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matched {
    /// Mesh edges marked as feature edges.
    pub edges: usize,
    /// Length of the given lines.
    pub length: f64,
    /// Length of the mesh edges that the lines follow.
    pub matched_length: f64,
    /// Length of those at which the surface is smooth: they are no feature edges.
    pub smooth_length: f64,
    /// Length of the given lines that pass beside the edges they mean, and were moved onto them.
    pub moved_length: f64,
    /// Length of the lines that run beside others, closer than a cloud's points lie apart, and gave way to them.
    pub merged_length: f64,
    /// Given segments, ascending, that lie beside no edge of a mesh, or on lines far from a cloud:
    /// they mean nothing.
    pub lost: Vec<u32>,
}

/// What given lines mean on a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meant {
    /// For each edge of the mesh, whether it is a feature edge.
    pub marked: Vec<bool>,
    /// The given lines, as segments, less those that mean nothing and those along edges at which
    /// the surface is smooth; where they were moved, the edges they mean.
    pub lines: Vec<[DVec3; 2]>,
    /// What became of the lines.
    pub matched: Matched,
}

/// Marks the edges that the given segments (model units) run along.
///
/// A segment from vertex to vertex of the mesh means the edge between them. Only the
/// segments that are no edge are compared by distance, and those that run along no edge either
/// mean the creases beside them, no farther than `reach` (model units).
#[must_use]
pub fn mark(welded: &Welded, edges: &Edges, segments: &[[DVec3; 2]], reach: f64) -> Meant {
    let exact = exact(welded, edges, segments);
    let followed = Followed::new(welded, edges, followed(welded, edges, segments, &exact));
    let loose = (0..segments.len()).filter(|&n| exact[n].is_none());
    let stray: Vec<Piece> = pieces(segments, loose, reach)
        .into_iter()
        .filter(|piece| followed.at(piece.middle()).is_none())
        .collect();
    let turns = Turns::of(welded, edges);
    let snapped = snap(welded, edges, [&turns.creases(), &followed.marks], &stray, reach);
    let meant: Vec<bool> = followed.marks.iter().zip(&snapped.edges).map(|(a, b)| *a || *b).collect();
    let marked = turns.sharp(welded, edges, &meant);
    let edge_of = |n: usize| exact[n].or_else(|| followed.at(middle(segments[n])));
    let mut strays = vec![false; segments.len()];
    stray.iter().for_each(|piece| strays[piece.segment as usize] = true);
    let kept = (0..segments.len()).filter(|&n| !strays[n] && edge_of(n).is_some_and(|edge| marked[edge]));
    let moved = (0..marked.len()).filter(|&edge| snapped.edges[edge] && marked[edge]);
    let lines = kept.map(|n| segments[n]).chain(moved.map(|edge| welded.places(edges.edges[edge].ends)));
    let matched = Matched {
        length: segments.iter().map(|[a, b]| a.distance(*b)).sum(),
        moved_length: snapped.length,
        lost: snapped.lost,
        ..matched(welded, edges, &meant, &marked)
    };
    Meant { lines: lines.collect(), marked, matched }
}

/// The edge that each segment is, from vertex to vertex.
fn exact(welded: &Welded, edges: &Edges, segments: &[[DVec3; 2]]) -> Vec<Option<usize>> {
    let vertices = VertexGrid::new(&welded.positions);
    segments.iter().map(|[a, b]| edges.find(vertices.at(*a)?, vertices.at(*b)?)).collect()
}

/// The edges that are segments, and those that pass some other segment closely with their ends and
/// their middle.
fn followed(welded: &Welded, edges: &Edges, segments: &[[DVec3; 2]], exact: &[Option<usize>]) -> Vec<bool> {
    let mut followed = vec![false; edges.edges.len()];
    exact.iter().flatten().for_each(|&edge| followed[edge] = true);
    let loose = segments.iter().zip(exact).filter(|(_, exact)| exact.is_none());
    let loose: Vec<[DVec3; 2]> = loose.map(|(segment, _)| *segment).collect();
    if loose.is_empty() {
        return followed;
    }
    let grid = SegmentGrid::new(loose);
    followed.par_iter_mut().zip(&edges.edges).for_each(|(followed, edge)| {
        let [a, b] = welded.places(edge.ends);
        let reach = NEAR_SHARE * a.distance(b);
        *followed |= [a, b, middle([a, b])].iter().all(|&p| grid.nearest(p, reach).is_some());
    });
    followed
}

/// Adds up what the lines mean.
fn matched(welded: &Welded, edges: &Edges, meant: &[bool], marked: &[bool]) -> Matched {
    let mut matched = Matched::default();
    for (index, edge) in edges.edges.iter().enumerate().filter(|&(index, _)| meant[index]) {
        let length = length(welded, edge);
        matched.edges += usize::from(marked[index]);
        matched.matched_length += length;
        matched.smooth_length += if marked[index] { 0.0 } else { length };
    }
    matched
}

/// The edges that lines follow, to be found by place.
struct Followed {
    /// For each edge, whether one does.
    marks: Vec<bool>,
    /// Those edges.
    edges: Vec<usize>,
    grid: SegmentGrid,
    longest: f64,
}

impl Followed {
    fn new(welded: &Welded, edges: &Edges, marks: Vec<bool>) -> Self {
        let of: Vec<usize> = (0..marks.len()).filter(|&index| marks[index]).collect();
        let longest = of.iter().map(|&index| length(welded, &edges.edges[index])).fold(0.0, f64::max);
        let segments = of.iter().map(|&index| welded.places(edges.edges[index].ends)).collect();
        Self { marks, edges: of, grid: SegmentGrid::new(segments), longest }
    }

    /// The edge that runs through a place.
    fn at(&self, place: DVec3) -> Option<usize> {
        let nearest = self.grid.nearest(place, NEAR_SHARE * self.longest)?;
        let [from, to] = self.grid.segment(nearest.segment);
        let close = nearest.distance <= NEAR_SHARE * from.distance(to);
        close.then(|| self.edges[nearest.segment as usize])
    }
}

/// By how much faces turn at each edge, degrees.
struct Turns(Vec<f64>);

impl Turns {
    fn of(welded: &Welded, edges: &Edges) -> Self {
        let normals = face_normals(&welded.positions, &welded.triangles);
        let turn = |edge| {
            let cosine = crease_cosine(edges, edge, &normals);
            cosine.map_or(OPEN_DEGREES, |cosine| libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees())
        };
        Self(edges.edges.par_iter().map(turn).collect())
    }

    /// The edges that lines beside them may mean: creases, and those of borders.
    fn creases(&self) -> Vec<bool> {
        self.0.iter().map(|turn| *turn >= SHARP_DEGREES).collect()
    }

    /// Which of the edges that lines mean are creases or borders.
    fn sharp(&self, welded: &Welded, edges: &Edges, meant: &[bool]) -> Vec<bool> {
        let turn = |&edge: &u32| self.0[edge as usize];
        let length = |&edge: &u32| length(welded, &edges.edges[edge as usize]);
        let mut sharp = vec![false; meant.len()];
        for Chain { edges: chain, .. } in chains(welded.positions.len(), edges, meant) {
            let most = chain.iter().map(turn).fold(0.0, f64::max);
            let turned: f64 = chain.iter().map(|edge| turn(edge) * length(edge)).sum();
            let all = chain.iter().map(length).sum::<f64>();
            let is_seam = most < SHARP_DEGREES && turned < SMOOTH_DEGREES * all;
            for edge in chain {
                sharp[edge as usize] = !is_seam && turn(&edge) >= SMOOTH_DEGREES;
            }
        }
        sharp
    }
}

fn middle([a, b]: [DVec3; 2]) -> DVec3 {
    0.5 * (a + b)
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
            let Meant { marked, matched, lines } = mark(&welded, &edges, &[line], 0.0);
            let found: Vec<_> =
                edges.edges.iter().zip(&marked).filter(|(_, m)| **m).map(|(e, _)| e.ends).collect();
            assert_eq!(found, [[0, 1]], "shift {shift}");
            assert!((matched.matched_length - 1.0).abs() < 1e-9 && matched.smooth_length < 1e-12);
            assert_eq!(lines, [line]);
        }
        let across = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
        let Meant { marked, matched, lines } = mark(&welded, &edges, &[across], 0.0);
        assert!(marked.iter().all(|mark| !mark), "a line across a flat face bounds nothing");
        assert!(lines.is_empty() && (matched.smooth_length - matched.matched_length).abs() < 1e-12);
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
        mark(&welded, &Edges::of(&welded.triangles), &lines, 0.0).matched.edges
    }

    #[test]
    fn seams_of_round_faces_bound_nothing_and_creases_that_fade_do_where_they_are_sharp() {
        assert_eq!(marked_of(&[6.0; 9]), 8, "a shallow crease");
        assert_eq!(marked_of(&[3.0, 3.0, 3.0, 6.0, 6.0, 3.0, 3.0, 3.0, 3.0]), 0, "a seam");
        let fading = marked_of(&[40.0, 30.0, 20.0, 10.0, 2.0, 1.0, 0.0, 0.0, 0.0]);
        assert!((3..=4).contains(&fading), "{fading} edges of a crease that fades");
    }

    /// A line above the crease of a fold, from its one end to the other, in steps of a quarter.
    fn beside(off: impl Fn(usize) -> f64) -> Vec<[DVec3; 2]> {
        let at = |n: usize| DVec3::new(0.25 * n as f64, off(n), 0.0);
        (0..32).map(|n| [at(n), at(n + 1)]).collect()
    }

    #[test]
    fn lines_beside_a_crease_mean_it_and_lines_far_from_all_mean_nothing() {
        let (welded, crease) = fold(&[40.0; 9]);
        let edges = Edges::of(&welded.triangles);
        let tremble = |n: usize| if n.is_multiple_of(2) { 0.25 } else { 0.1 };
        let twice: Vec<_> = beside(|_| 0.2).into_iter().chain(beside(|_| -0.2)).collect();
        for (name, lines) in [("off", beside(|_| 0.2)), ("trembling", beside(tremble)), ("twice", twice)] {
            let Meant { lines: meant, matched, .. } = mark(&welded, &edges, &lines, 0.5);
            assert_eq!(meant, crease, "{name}");
            assert!(matched.moved_length > 0.9 * matched.length && matched.lost.is_empty(), "{name}");
            let Meant { matched, .. } = mark(&welded, &edges, &lines, 0.02);
            assert_eq!((matched.edges, matched.lost.len()), (0, lines.len()), "{name}: out of reach");
        }
        let both: Vec<_> = crease.iter().copied().chain([[DVec3::Z, DVec3::Z + DVec3::X]]).collect();
        let Meant { lines, matched, .. } = mark(&welded, &edges, &both, 0.5);
        assert_eq!((lines, matched.lost, matched.moved_length), (crease, vec![8], 0.0));
    }
}
