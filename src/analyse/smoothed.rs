//! The mesh of the smooth surface that another mesh stands for.

use glam::{DVec3, Vec3};

use super::edges::{Edges, crease_cosine, face_normals};
use super::mesh_surface::{Features, Found, mark};
use super::refine::length;
use super::sides::{Sides, hard_edges};
use super::smooth::{Fineness, height, smooth};
use super::weld::{Welded, weld_shaded};
use crate::model::cloud::Cloud;
use crate::model::mesh::Mesh;

/// How a mesh is smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothing {
    /// Edges whose faces' normals differ by more than this angle, degrees, stay sharp.
    pub degrees: f64,
    /// How fine the facets of the answer are.
    pub fineness: Fineness,
    /// Only where mesh and normals say that a smooth surface is meant, and where it lies farther
    /// than this from the facets, model units.
    pub only_beyond: Option<f64>,
}

/// A mesh made smooth.
#[derive(Clone, Debug)]
pub struct Smoothed {
    /// Facets too fine to be told from the surface.
    pub mesh: Mesh,
    /// The feature edges of that mesh, each a segment, model units.
    pub lines: Vec<[DVec3; 2]>,
    /// What became of the feature edges of the mesh it was made from.
    pub found: Found,
}

/// Edges whose faces turn by less than this (cosine of 1°) say nothing of what is meant.
const FLAT: f64 = 0.999_85;

/// A mesh without normals stands for a smooth surface if so much of what bends, by length, bends by
/// less than [`GENTLE`]: facets that nobody took for smooth are coarser somewhere.
const MOSTLY: f64 = 0.9;

/// The same of a mesh with normals, by the edges over which they go on.
const HALF: f64 = 0.5;

/// Cosine of 35°: a circle of fewer than 11 sides is a polygon to most eyes.
const GENTLE: f64 = 0.82;

/// The smooth surface that a mesh stands for; `None` where that is the mesh itself.
#[must_use]
pub fn smoothed(mesh: &Mesh, features: &Features, smoothing: &Smoothing) -> Option<Smoothed> {
    let (welded, shading) = weld_shaded(mesh);
    // Where the file has normals they say what is sharp, not the angles between coarse facets.
    let found_by_angle = matches!(features, Features::Sharp { .. }) && !shading.is_empty();
    let (marked, found) = mark(&welded, if found_by_angle { &Features::None } else { features });
    let edges = Edges::of(&welded.triangles);
    let hard = hard_edges(&welded, &edges, &marked, smoothing.degrees, &shading);
    let sides = Sides::of(&welded, &edges, &hard, &shading);
    if let Some(least) = smoothing.only_beyond
        && !(height(&welded, &edges, &sides) > least && is_meant(&welded, &edges, &hard, &shading))
    {
        return None;
    }
    let (fine, marked) = smooth(welded, marked, &sides, &smoothing.fineness);
    let edges = Edges::of(&fine.triangles);
    let marked = edges.edges.iter().zip(&marked).filter(|(_, mark)| **mark);
    let lines = marked.map(|(edge, _)| fine.places(edge.ends)).collect();
    let vertices = Cloud {
        frame: mesh.vertices.frame,
        positions: fine.positions,
        colors: fine.colors,
        ..Cloud::default()
    };
    let mesh = Mesh { vertices, triangles: fine.triangles, dropped: mesh.dropped, turned: mesh.turned };
    Some(Smoothed { mesh, lines, found })
}

/// Whether a mesh stands for a smooth surface: the file's normals go on over most of the length of
/// the edges that bend; without normals most of them bend gently.
fn is_meant(welded: &Welded, edges: &Edges, hard: &[bool], shading: &[[Vec3; 3]]) -> bool {
    let normals = face_normals(&welded.positions, &welded.triangles);
    let by_angle = shading.is_empty();
    let (mut whole, mut smooth) = (0.0, 0.0);
    for (edge, &hard) in edges.edges.iter().zip(hard) {
        let Some(cosine) = crease_cosine(edges, edge, &normals).filter(|cosine| *cosine < FLAT) else {
            continue;
        };
        if by_angle && hard {
            // A sharp edge is one whatever the facets around it stand for.
            continue;
        }
        let length = length(welded, edge);
        whole += length;
        if !hard && (!by_angle || cosine > GENTLE) {
            smooth += length;
        }
    }
    smooth > whole * if by_angle { MOSTLY } else { HALF }
}
