//! Patches of a mesh around an edge, over which it is judged.

use glam::DVec3;

use super::edges::{Edge, Edges, Half, face_normals};
use super::marks::Marks;
use super::surface::NONE;
use super::weld::Welded;
use crate::model::polyline::nearest_on;

/// Places along each side of a face that are looked at, less one.
const LATTICE: u32 = 3;

/// A face whose normal is turned farther from the mean than this (cosine of 75°) cannot be part
/// of one splat.
const FOLDED: f64 = 0.26;

/// A leaf goes on over faces turned from its first by less than this (cosine of 60°): beyond, the surface folds.
const LEAF: f64 = 0.5;

/// For each face, the edges along its sides.
fn sides(edges: &Edges, faces: usize) -> Vec<[u32; 3]> {
    let mut sides = vec![[NONE; 3]; faces];
    for (index, edge) in (0_u32..).zip(&edges.edges) {
        for half in edges.halves(edge) {
            sides[half.face as usize][half.corner as usize] = index;
        }
    }
    sides
}

/// Where patches are cut out of a mesh.
pub struct Patches<'a> {
    welded: &'a Welded,
    edges: &'a Edges,
    /// For each face, the edges along its sides.
    sides: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    /// Which edges are feature edges so far.
    marked: &'a [bool],
}

/// What a patch is cut out for: where its middle is and how far it goes.
#[derive(Clone, Copy)]
pub struct Disc {
    pub middle: DVec3,
    pub radius: f64,
    /// Whether it goes over feature edges.
    pub over: bool,
}

impl<'a> Patches<'a> {
    /// Patches of a mesh some of whose edges are `marked`.
    #[must_use]
    pub fn new(welded: &'a Welded, edges: &'a Edges, marked: &'a [bool]) -> Self {
        let normals = face_normals(&welded.positions, &welded.triangles);
        Self { welded, edges, sides: sides(edges, welded.triangles.len()), normals, marked }
    }

    /// Places within a disc on the faces that the surface joins to some, and the mean of those
    /// faces' normals; `None` if it folds over.
    pub fn patch(&self, disc: &Disc, from: &[u32], visited: &mut Marks) -> Option<(Vec<DVec3>, DVec3)> {
        visited.clear();
        let mut open: Vec<u32> = from.iter().copied().filter(|&face| visited.insert(face)).collect();
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        while let Some(face) = open.pop() {
            let before = places.len();
            let near = |place: &DVec3| place.distance_squared(disc.middle) <= disc.radius * disc.radius;
            places.extend(self.lattice(face).filter(near));
            if places.len() == before {
                continue;
            }
            normals.push(self.normals[face as usize]);
            for side in self.sides[face as usize] {
                if disc.over || !self.marked[side as usize] {
                    let halves = self.edges.halves(&self.edges.edges[side as usize]);
                    open.extend(halves.iter().map(|half| half.face).filter(|&other| visited.insert(other)));
                }
            }
        }
        let mean = normals.iter().sum::<DVec3>().normalize_or_zero();
        let folds = normals.iter().any(|&normal| normal != DVec3::ZERO && normal.dot(mean) < FOLDED);
        (!folds).then_some((places, mean))
    }

    /// Places spread over a face, its corners among them: a facet has no vertices inside, and may
    /// be as large as the patch.
    pub fn lattice(&self, face: u32) -> impl Iterator<Item = DVec3> {
        let [a, b, c] = self.welded.places(self.welded.triangles[face as usize]);
        (0..=LATTICE).flat_map(move |i| {
            (0..=LATTICE - i).map(move |j| {
                let [s, t] = [i, j].map(|n| f64::from(n) / f64::from(LATTICE));
                a + s * (b - a) + t * (c - a)
            })
        })
    }

    /// The middle of an edge.
    #[must_use]
    pub fn middle(&self, edge: &Edge) -> DVec3 {
        let [a, b] = self.welded.places(edge.ends);
        0.5 * (a + b)
    }

    /// The mean normal of some faces; zero if they lie back to back.
    #[must_use]
    pub fn mean_normal<const N: usize>(&self, faces: [u32; N]) -> DVec3 {
        faces.map(|face| self.normals[face as usize]).iter().sum::<DVec3>().normalize_or_zero()
    }

    /// The cosine of the angle by which two faces turn from each other; 0 where one has no area.
    #[must_use]
    pub fn turned(&self, face: u32, other: u32) -> f64 {
        self.normals[face as usize].dot(self.normals[other as usize])
    }

    /// Whether the leaf of the surface that begins with a face reaches so `far` from one of its sides, model units,
    /// near the middle of that.
    pub fn reaches(&self, side: Half, far: f64, visited: &mut Marks) -> bool {
        let edge = self.sides[side.face as usize][side.corner as usize];
        let along = &self.edges.edges[edge as usize];
        let middle = self.middle(along);
        let near = |side: &u32| {
            let [p, q] = self.welded.places(self.edges.edges[*side as usize].ends);
            nearest_on(p, q, middle).distance(middle) <= far
        };
        visited.clear();
        visited.insert(side.face);
        let mut open = vec![side.face];
        while let Some(face) = open.pop() {
            if self.welded.height(face, along.ends) > far {
                return true;
            }
            for over in self.sides[face as usize].into_iter().filter(|&over| over != edge).filter(near) {
                let halves = self.edges.halves(&self.edges.edges[over as usize]);
                let others =
                    halves.iter().map(|half| half.face).filter(|&other| self.turned(side.face, other) > LEAF);
                open.extend(others.filter(|&other| visited.insert(other)));
            }
        }
        false
    }
}
