//! From a mesh to its surface: weld, find or match feature edges, refine, cut.

use glam::DVec3;

use super::chains;
use super::creases::creases;
use super::edges::Edges;
use super::given_lines::{self, Matched};
use super::refine::refine;
use super::split::split;
use super::surface::Surface;
use super::weld::{Welded, weld};
use crate::model::mesh::Mesh;

/// Which edges of a mesh are feature edges, beside its borders.
#[derive(Clone, Debug)]
pub enum Features {
    /// Those whose faces' normals differ by much, as far as they belong to a line of some length.
    Sharp {
        /// The angle, degrees.
        degrees: f64,
        /// The least length of all connected edges together, model units.
        shortest: f64,
    },
    /// Those that these segments (model units) run along.
    Given(Vec<[DVec3; 2]>),
    /// None.
    None,
}

/// What was found on the way, for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Feature edges of the mesh before refinement.
    pub feature_edges: usize,
    /// What became of given lines.
    pub matched: Option<Matched>,
}

/// The surface of a mesh, its pieces no longer than `longest` (model units) unless that
/// takes more than `most` of them.
#[must_use]
pub fn mesh_surface(mesh: &Mesh, features: &Features, longest: f64, most: usize) -> (Surface, Found) {
    let welded = weld(mesh);
    let (marked, found) = mark(&welded, features);
    let (fine, marked) = refine(welded, marked, longest, most);
    (split(&fine, &marked), found)
}

/// The lines that a mesh's surface is cut along, model units, each a segment of two points: its
/// borders, where its faces do not join two by two, and its feature edges as they are found.
///
/// Given segments are returned as they are, beside the borders: whether the mesh has an edge
/// there or not.
#[must_use]
pub fn cut_lines(mesh: &Mesh, features: &Features) -> Vec<Vec<DVec3>> {
    let welded = weld(mesh);
    let edges = Edges::of(&welded.triangles);
    let (marked, given) = match features {
        Features::Given(segments) => (vec![false; edges.edges.len()], segments.as_slice()),
        Features::Sharp { .. } | Features::None => (mark(&welded, features).0, [].as_slice()),
    };
    let place = |v: u32| welded.positions[v as usize].as_dvec3();
    let cut = edges.edges.iter().zip(&marked).filter(|(edge, mark)| **mark || edges.pair(edge).is_none());
    let found = cut.map(|(edge, _)| edge.ends.map(place));
    found.chain(given.iter().copied()).map(|segment| segment.to_vec()).collect()
}

fn mark(welded: &Welded, features: &Features) -> (Vec<bool>, Found) {
    let edges = Edges::of(&welded.triangles);
    let (marked, matched) = match features {
        Features::Sharp { degrees, shortest } => {
            let mut marked = creases(welded, &edges, *degrees);
            chains::drop_short(&welded.positions, &edges, *shortest, &mut marked);
            (marked, None)
        }
        Features::Given(segments) => {
            let (marked, matched) = given_lines::mark(welded, &edges, segments);
            (marked, Some(matched))
        }
        Features::None => (vec![false; edges.edges.len()], None),
    };
    let found = Found { feature_edges: marked.iter().filter(|mark| **mark).count(), matched };
    (marked, found)
}
