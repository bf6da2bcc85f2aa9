//! From a mesh to its surface: weld, find or match feature edges, refine, cut.

use glam::DVec3;

use super::chains;
use super::creases::creases;
use super::edges::Edges;
use super::given_lines::{self, Matched, Meant};
use super::line_ends::carried;
use super::refine::refine;
use super::split::split;
use super::surface::Surface;
use super::weld::{Welded, weld};
use super::worth::{Worth, drop_needless};
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
    /// Those that given lines mean.
    Given {
        /// Their segments, model units.
        segments: Vec<[DVec3; 2]>,
        /// How far they may lie off the edges they mean, model units.
        beside: f64,
    },
    /// None.
    None,
}

/// What was found on the way, for the report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Feature edges: those matched to given lines as the mesh has them, those found as refined.
    pub feature_edges: usize,
    /// What became of given lines.
    pub matched: Option<Matched>,
}

/// How a mesh becomes a surface.
#[derive(Clone, Copy)]
pub struct Making<'a> {
    /// Pieces are no longer than this, model units, unless that takes more than `most` of them.
    pub longest: f64,
    /// The most pieces that refinement makes.
    pub most: usize,
    /// Which feature edges that are found are worth a cut.
    pub worth: Worth<'a>,
}

/// The surface of a mesh, cut along feature edges.
#[must_use]
pub fn mesh_surface(mesh: &Mesh, features: &Features, making: &Making<'_>) -> (Surface, Found) {
    let (fine, mut marked, found) = marked(mesh, features, making);
    let edges = Edges::of(&fine.triangles);
    let carried = carried(&fine, &edges, &marked, making.worth.max_error);
    carried.iter().for_each(|&edge| marked[edge as usize] = true);
    let mut surface = split(&fine, &marked);
    surface.carried_on(carried.iter().map(|&edge| edges.edges[edge as usize].ends));
    (surface, found)
}

/// A mesh, refined; which of its edges are feature edges; and what was found.
fn marked(mesh: &Mesh, features: &Features, making: &Making<'_>) -> (Welded, Vec<bool>, Found) {
    let welded = weld(mesh);
    let (marked, mut found) = mark(&welded, features);
    let (fine, mut marked) = refine(welded, marked, making.longest, making.most);
    if let Features::Sharp { shortest, .. } = features {
        // Only now are there vertices enough on large facets to judge by.
        let edges = Edges::of(&fine.triangles);
        drop_needless(&fine, &edges, &making.worth, &mut marked);
        chains::drop_short(&fine.positions, &edges, *shortest, &mut marked);
        found.feature_edges = marked.iter().filter(|mark| **mark).count();
    }
    (fine, marked, found)
}

/// The lines that a mesh's surface is cut along, model units, each a segment of two points: its
/// borders, where its faces do not join two by two, and its feature edges as they are found.
///
/// Given segments are returned beside the borders: as they are where they run along edges of the
/// mesh, where they lie off these as the edges they mean; not where the mesh is smooth.
#[must_use]
pub fn cut_lines(mesh: &Mesh, features: &Features, making: &Making<'_>) -> Vec<Vec<DVec3>> {
    let (welded, marked, given) = match features {
        Features::Given { segments, beside } => {
            let welded = weld(mesh);
            let edges = Edges::of(&welded.triangles);
            let given = given_lines::mark(&welded, &edges, segments, *beside).lines;
            (welded, vec![false; edges.edges.len()], given)
        }
        Features::Sharp { .. } | Features::None => {
            let (welded, marked, _) = marked(mesh, features, making);
            (welded, marked, Vec::new())
        }
    };
    let edges = Edges::of(&welded.triangles);
    let cut = edges.edges.iter().zip(&marked).filter(|(edge, mark)| **mark || edges.pair(edge).is_none());
    let found = cut.map(|(edge, _)| welded.places(edge.ends));
    found.chain(given).map(|segment| segment.to_vec()).collect()
}

/// Which edges of a mesh are feature edges, and what was found.
pub(super) fn mark(welded: &Welded, features: &Features) -> (Vec<bool>, Found) {
    let edges = Edges::of(&welded.triangles);
    let (marked, matched) = match features {
        Features::Sharp { degrees, shortest } => {
            let mut marked = creases(welded, &edges, *degrees);
            chains::drop_short(&welded.positions, &edges, *shortest, &mut marked);
            (marked, None)
        }
        Features::Given { segments, beside } => {
            let Meant { marked, matched, .. } = given_lines::mark(welded, &edges, segments, *beside);
            (marked, Some(matched))
        }
        Features::None => (vec![false; edges.edges.len()], None),
    };
    let found = Found { feature_edges: marked.iter().filter(|mark| **mark).count(), matched };
    (marked, found)
}
