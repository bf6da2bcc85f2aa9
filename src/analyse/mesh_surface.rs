//! From a mesh to its surface: weld, sew, find or match feature edges, refine, cut.

use glam::DVec3;

use super::bends::bends;
use super::chains;
use super::creases::creases;
use super::edges::Edges;
use super::given_lines::{self, Matched, Meant};
use super::line_ends::carried;
use super::refine::{Fineness, Refined, Side, refine};
use super::sew::{CRACK_SHARE, Sewn, sew};
use super::split::split;
use super::surface::Surface;
use super::weld::{Welded, weld};
use super::worth::{Worth, drop_needless, mark_folds};
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
    /// What was sewn where cracks are narrow beside the bound.
    pub sewn: Sewn,
}

/// How a mesh becomes a surface.
#[derive(Clone, Copy)]
pub struct Making<'a> {
    /// Pieces are no longer than this, model units, unless that takes more than `most` of them; up to
    /// [`FLATTER`] times as long inside flat faces.
    pub longest: f64,
    /// The most pieces that refinement makes.
    pub most: usize,
    /// Which feature edges that are found are worth a cut.
    pub worth: Worth<'a>,
}

/// Sides of pieces on flat faces may be up to this many times as long: a plane reaches farther there than
/// splats may be expected to elsewhere. Not so beside lines, where splats are grown from pieces that fit
/// between them: a gear whose teeth have pieces four times as long takes a fifth more bytes.
pub const FLATTER: f64 = 4.0;

/// A straight run of feature edges at least this many times as long as the shortest line is one by itself: so
/// long beside the bound it is no noise of a scan but a fold between facets of a coarse mesh, whose lines
/// need be neither smooth nor long. With 1 files of fine scans are about a tenth larger, with 3 those of
/// coarse meshes a sixth; judged as those of scans, coarse meshes take up to twice as many bytes.
const LONG: f64 = 2.0;

impl Making<'_> {
    /// How long a side may be of a face that bends so much, in 1 / model units.
    fn longest(&self, bend: f64, at_line: bool) -> f64 {
        if at_line {
            return self.longest;
        }
        // A plane strays by the bound where half the curvature times the square of the way does.
        let plane = (2.0 * self.worth.max_error / bend).sqrt();
        self.longest * (plane / self.worth.reach).clamp(1.0, FLATTER)
    }
}

/// A mesh that is welded and refined, and which of its edges are feature edges.
#[derive(Default)]
pub struct Marked {
    welded: Welded,
    marked: Vec<bool>,
    max_error: f64,
}

impl Marked {
    /// Welds a mesh, finds or matches its feature edges and refines it; also what was found.
    #[must_use]
    pub fn of(mesh: &Mesh, features: &Features, making: &Making<'_>) -> (Self, Found) {
        let (welded, sewn) = sewn(mesh, making.worth.max_error);
        let (marked, found) = mark(&welded, features);
        let mut found = Found { sewn, ..found };
        let bends = bends(&welded, &marked);
        let too_long =
            |side: &Side| side.way.length() > making.longest(bends[side.face as usize], side.at_line);
        let Refined { welded, mut marked, .. } =
            refine(welded, marked, &Fineness { too_long: &too_long, most: making.most });
        if let Features::Sharp { shortest, .. } = features {
            // Only now are there vertices enough on large facets to judge by.
            let edges = Edges::of(&welded.triangles);
            drop_needless(&welded, &edges, &making.worth, LONG * shortest, &mut marked);
            chains::drop_short(&welded.positions, &edges, *shortest, &mut marked);
            mark_folds(&welded, &edges, &making.worth, &mut marked);
            found.feature_edges = marked.iter().filter(|mark| **mark).count();
        }
        (Self { welded, marked, max_error: making.worth.max_error }, found)
    }

    /// The same, refined further; for each of its triangles the number of the one it is a part of.
    #[must_use]
    pub fn refined(self, fineness: &Fineness<'_>) -> (Self, Vec<u32>) {
        let Refined { welded, marked, part_of } = refine(self.welded, self.marked, fineness);
        (Self { welded, marked, ..self }, part_of)
    }

    /// The surface, cut along feature edges; a piece for each triangle, in their order.
    #[must_use]
    pub fn surface(&self) -> Surface {
        let edges = Edges::of(&self.welded.triangles);
        let carried = carried(&self.welded, &edges, &self.marked, self.max_error);
        let mut marked = self.marked.clone();
        carried.iter().for_each(|&edge| marked[edge as usize] = true);
        let mut surface = split(&self.welded, &marked);
        surface.carried_on(carried.iter().map(|&edge| edges.edges[edge as usize].ends));
        surface
    }
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
            let (welded, _) = sewn(mesh, making.worth.max_error);
            let edges = Edges::of(&welded.triangles);
            let given = given_lines::mark(&welded, &edges, segments, *beside).lines;
            (welded, vec![false; edges.edges.len()], given)
        }
        Features::Sharp { .. } | Features::None => {
            let (Marked { welded, marked, .. }, _) = Marked::of(mesh, features, making);
            (welded, marked, Vec::new())
        }
    };
    let edges = Edges::of(&welded.triangles);
    let found = edges.cut(&marked).map(|edge| welded.places(edge.ends));
    found.chain(given).map(|segment| segment.to_vec()).collect()
}

/// A mesh welded, and sewn where its cracks are narrow beside the bound.
fn sewn(mesh: &Mesh, max_error: f64) -> (Welded, Sewn) {
    let mut welded = weld(mesh);
    let sewn = sew(&mut welded, CRACK_SHARE * max_error);
    (welded, sewn)
}

/// Which edges of a mesh are feature edges, and what was found.
pub(super) fn mark(welded: &Welded, features: &Features) -> (Vec<bool>, Found) {
    let edges = Edges::of(&welded.triangles);
    let (marked, matched) = match features {
        Features::Sharp { degrees, shortest } => {
            let mut marked = creases(welded, &edges, *degrees, LONG * shortest);
            chains::drop_short(&welded.positions, &edges, *shortest, &mut marked);
            (marked, None)
        }
        Features::Given { segments, beside } => {
            let Meant { marked, matched, .. } = given_lines::mark(welded, &edges, segments, *beside);
            (marked, Some(matched))
        }
        Features::None => (vec![false; edges.edges.len()], None),
    };
    let feature_edges = marked.iter().filter(|mark| **mark).count();
    let found = Found { feature_edges, matched, sewn: Sewn::default() };
    (marked, found)
}
