//! The edges of a welded mesh: which faces meet at each, and at what angle.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// An edge of a mesh and the faces at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The vertices, the lesser first.
    pub ends: [u32; 2],
    /// First of the edge's half-edges in [`Edges::halves`].
    first: u32,
    /// How many faces meet here.
    pub faces: u32,
}

/// A face's side, from the lesser to the greater vertex or back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Half {
    /// The edge's vertices, the lesser first.
    ends: [u32; 2],
    /// The triangle.
    pub face: u32,
    /// Which of its corners the side starts at.
    pub corner: u8,
    /// Whether the triangle walks it from the lesser vertex to the greater.
    pub forward: bool,
}

/// All edges, sorted by their vertices.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// One entry an edge.
    pub edges: Vec<Edge>,
    halves: Vec<Half>,
}

impl Edges {
    /// Collects the edges of a list of triangles.
    #[must_use]
    pub fn of(triangles: &[[u32; 3]]) -> Self {
        let mut halves: Vec<Half> = triangles
            .iter()
            .enumerate()
            .flat_map(|(face, corners)| {
                (0..3_u8).map(move |corner| {
                    let (from, to) = (corners[corner as usize], corners[(corner as usize + 1) % 3]);
                    let ends = [from.min(to), from.max(to)];
                    Half { ends, face: face as u32, corner, forward: from < to }
                })
            })
            .collect();
        halves.par_sort_unstable();
        let mut edges: Vec<Edge> = Vec::new();
        for (at, half) in halves.iter().enumerate() {
            match edges.last_mut() {
                Some(edge) if edge.ends == half.ends => edge.faces += 1,
                _ => edges.push(Edge { ends: half.ends, first: at as u32, faces: 1 }),
            }
        }
        Self { edges, halves }
    }

    /// The index of the edge between two vertices.
    #[must_use]
    pub fn find(&self, a: u32, b: u32) -> Option<usize> {
        self.edges.binary_search_by_key(&[a.min(b), a.max(b)], |edge| edge.ends).ok()
    }

    /// The sides of the faces that meet at an edge.
    #[must_use]
    pub fn halves(&self, edge: &Edge) -> &[Half] {
        &self.halves[edge.first as usize..(edge.first + edge.faces) as usize]
    }

    /// The edges along which the surface is cut open: feature edges, and where it ends.
    pub fn cut<'a>(&'a self, marked: &'a [bool]) -> impl Iterator<Item = &'a Edge> {
        let marked = self.edges.iter().zip(marked);
        marked.filter(|(edge, mark)| **mark || self.pair(edge).is_none()).map(|(edge, _)| edge)
    }

    /// The two sides of an edge where exactly two faces meet and agree on their outside.
    #[must_use]
    pub fn pair(&self, edge: &Edge) -> Option<(Half, Half)> {
        match self.halves(edge) {
            [a, b] if a.forward != b.forward => Some((*a, *b)),
            _ => None,
        }
    }
}

/// Unit normals of the triangles; zero for one without area.
#[must_use]
pub fn face_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    triangles
        .par_iter()
        .map(|corners| {
            let [a, b, c] = corners.map(|v| positions[v as usize].as_dvec3());
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect()
}

/// Cosine of the angle between the normals of the two faces at an edge.
///
/// `None` at a border, where more than two faces meet, where they disagree on their
/// outside, or where one has no area.
#[must_use]
pub fn crease_cosine(edges: &Edges, edge: &Edge, normals: &[DVec3]) -> Option<f64> {
    let (a, b) = edges.pair(edge)?;
    let (a, b) = (normals[a.face as usize], normals[b.face as usize]);
    (a != DVec3::ZERO && b != DVec3::ZERO).then(|| a.dot(b))
}
