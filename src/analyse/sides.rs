//! On which side of a mesh's hard edges a corner of a face lies, and the normal there.

use glam::{DVec3, Vec3};

use super::edges::{Edge, Edges, Half, crease_cosine, face_normals};
use super::sets::Sets;
use super::split::split;
use super::weld::Welded;

/// The corners of a mesh's faces, joined where the surface goes on smoothly.
#[derive(Clone, Debug, Default)]
pub struct Sides {
    /// For each face the numbers of its corners' sides: faces that meet smoothly at a vertex have
    /// one side there.
    pub corners: Vec<[u32; 3]>,
    /// For each side its unit normal.
    pub normals: Vec<DVec3>,
}

/// The file's normals at one vertex that differ by more than this (cosine of 5°) make its edge
/// hard.
const SAME_NORMAL: f64 = 0.996;

/// A normal of the file's that is turned from the faces' mean by more than this (cosine of 60°)
/// is wrong.
const WILD: f64 = 0.5;

/// Faces whose normals differ by less than this (cosine of 0.1°) are of one plane.
const COPLANAR: f64 = 1.0 - 1.5e-6;

/// A plane that is this many times as large as all the others at a vertex is a flat part of the
/// thing, and the normal there is its own: what bends begins behind its edge.
const FLAT_PART: f64 = 4.0;

impl Sides {
    /// The sides of a mesh's faces at its edges that are hard.
    ///
    /// `shading` is what the file says of each face's corners, or empty: then normals are the
    /// means of the faces, weighted by their angles, but for flat parts, which keep theirs.
    #[must_use]
    pub fn of(welded: &Welded, edges: &Edges, hard: &[bool], shading: &[[Vec3; 3]]) -> Self {
        let surface = split(welded, hard);
        let mean: Vec<DVec3> = surface.normals.iter().map(|n| n.as_dvec3().normalize_or(DVec3::Z)).collect();
        let mut sides = Self { corners: surface.pieces, normals: mean };
        if shading.is_empty() {
            sides.keep_flat_parts(welded, edges, hard);
        } else {
            sides.shade(shading);
        }
        sides
    }

    /// The sides along half an edge, from its lesser vertex to the greater.
    #[must_use]
    pub fn along(&self, half: &Half) -> [u32; 2] {
        let corners = self.corners[half.face as usize];
        let [from, to] = [half.corner as usize, (half.corner as usize + 1) % 3].map(|n| corners[n]);
        if half.forward { [from, to] } else { [to, from] }
    }

    /// Takes the file's normals where they are sound.
    fn shade(&mut self, shading: &[[Vec3; 3]]) {
        let mut sums = vec![DVec3::ZERO; self.normals.len()];
        for (corners, normals) in self.corners.iter().zip(shading) {
            for (&side, normal) in corners.iter().zip(normals) {
                sums[side as usize] += normal.as_dvec3().normalize_or_zero();
            }
        }
        for (normal, sum) in self.normals.iter_mut().zip(sums) {
            let given = sum.normalize_or_zero();
            if given.dot(*normal) > WILD {
                *normal = given;
            }
        }
    }

    /// Gives sides that a flat part dominates that part's normal.
    fn keep_flat_parts(&mut self, welded: &Welded, edges: &Edges, hard: &[bool]) {
        let faces = face_normals(&welded.positions, &welded.triangles);
        let mut planes = Sets::new(faces.len());
        for (edge, _) in edges.edges.iter().zip(hard).filter(|(_, hard)| !**hard) {
            if let Some((a, b)) = edges.pair(edge)
                && faces[a.face as usize].dot(faces[b.face as usize]) > COPLANAR
            {
                planes.merge(a.face, b.face);
            }
        }
        let mut areas = vec![0.0; faces.len()];
        for (face, corners) in (0_u32..).zip(&welded.triangles) {
            let [a, b, c] = welded.places(*corners);
            areas[planes.root(face) as usize] += 0.5 * (b - a).cross(c - a).length();
        }
        let mut meeting: Vec<(u32, u32)> = Vec::with_capacity(3 * faces.len());
        for (face, corners) in (0_u32..).zip(&self.corners) {
            let plane = planes.root(face);
            meeting.extend(corners.map(|side| (side, plane)));
        }
        meeting.sort_unstable();
        meeting.dedup();
        for planes in meeting.chunk_by(|a, b| a.0 == b.0) {
            let area = |plane: &(u32, u32)| areas[plane.1 as usize];
            let whole: f64 = planes.iter().map(area).sum();
            let largest = planes.iter().max_by(|a, b| area(a).total_cmp(&area(b)).then(b.1.cmp(&a.1)));
            if let Some(plane) = largest.filter(|plane| area(plane) > FLAT_PART * (whole - area(plane))) {
                self.normals[plane.0 as usize] = faces[plane.1 as usize];
            }
        }
    }
}

/// Which edges a smooth surface does not go over, beside feature edges: those where the file's
/// normals differ on both sides, or without normals those whose faces' differ by more than `degrees`.
#[must_use]
pub fn hard_edges(
    welded: &Welded,
    edges: &Edges,
    marked: &[bool],
    degrees: f64,
    shading: &[[Vec3; 3]],
) -> Vec<bool> {
    let normals = face_normals(&welded.positions, &welded.triangles);
    let limit = libm::cos(degrees.to_radians());
    let given = |half: &Half, step: usize| {
        let corner = (half.corner as usize + step) % 3;
        shading[half.face as usize][corner].as_dvec3().normalize_or_zero()
    };
    let differ = |(a, b): (Half, Half)| {
        let ends = [[given(&a, 0), given(&b, 1)], [given(&a, 1), given(&b, 0)]];
        let known = |normal: &DVec3| *normal != DVec3::ZERO;
        ends.iter().any(|ends| ends.iter().all(known) && ends[0].dot(ends[1]) < SAME_NORMAL)
    };
    let hard = |(edge, &mark): (&Edge, &bool)| {
        mark || match shading.is_empty() {
            true => crease_cosine(edges, edge, &normals).is_some_and(|cosine| cosine < limit),
            false => edges.pair(edge).is_some_and(differ),
        }
    };
    edges.edges.iter().zip(marked).map(hard).collect()
}
