//! From an input to the surface that splats are to cover, as fine as the error bound asks for.

use super::lines::{cloud_lines, features, given_lines};
use super::looking::{is_looked_at, told_margins};
use super::meant::{Made, Meant};
use super::options::{Edges, Options};
use crate::analyse::cloud_surface::{CloudSurface, OpenPlace, Sparse, cloud_surface};
use crate::analyse::mesh_surface::{Found, Making, Marked};
use crate::analyse::surface::Surface;
use crate::analyse::thin::Reach;
use crate::analyse::worth::Worth;
use crate::error::Result;
use crate::fit::pose::misfit;
use crate::ingest::Input;
use crate::model::cloud::Cloud;
use crate::model::discs::Discs;
use crate::model::mesh::Mesh;

/// No refinement makes more pieces than this.
pub(super) const MOST_PIECES: usize = 4_000_000;

/// Pieces are refined to this share of the radius that a splat is expected to reach.
const PIECE_SHARE: f64 = 1.0 / 6.0;

/// The size of features that a generic smooth surface has, as a share of the diagonal.
const FEATURE_SHARE: f64 = 0.25;

/// The radius that a quadric splat reaches on a generic smooth surface: there the third-order
/// term `r³ / L²` meets the error, with features of size `L`.
fn expected_radius(max_error: f64, diagonal: f64) -> f64 {
    let feature = FEATURE_SHARE * diagonal;
    libm::cbrt(max_error * feature * feature)
}

/// How a mesh becomes a surface under an error bound.
pub(super) fn making(max_error: f64, diagonal: f64) -> Making<'static> {
    let reach = expected_radius(max_error, diagonal);
    let worth = Worth { reach, max_error, misfit: &misfit };
    Making { longest: piece_length(max_error, diagonal), most: MOST_PIECES, worth }
}

/// How long the sides of pieces may be.
pub(super) fn piece_length(max_error: f64, diagonal: f64) -> f64 {
    PIECE_SHARE * expected_radius(max_error, diagonal)
}

/// How far points of a cloud stand for others: over areas as wide as a mesh's pieces are long.
fn thinning(max_error: f64, diagonal: f64) -> Reach {
    Reach { radius: 0.5 * piece_length(max_error, diagonal), offset: THIN_OFFSET * max_error }
}

/// A point of a cloud stands for others whose distance from its tangent plane is below this
/// share of the error bound, so that a fit to it is as good as one to all of them.
const THIN_OFFSET: f64 = 0.25;

/// The input's surface, and what was found on the way to it.
#[derive(Default)]
pub(super) struct Analysed {
    pub(super) surface: Surface,
    /// What a mesh's surface was made of.
    pub(super) marked: Option<Marked>,
    pub(super) features: Found,
    pub(super) left_out: Vec<u32>,
    /// What points tell of the surface by themselves, nothing for a mesh; `None` where nobody looks.
    pub(super) discs: Option<Discs>,
    pub(super) open_places: Vec<OpenPlace>,
    pub(super) sparse: Option<Sparse>,
}

/// The surface of what is meant, under an error bound in model units.
///
/// # Errors
/// [`crate::Error::Usage`] where a cloud's normals are to be kept and none is sound.
pub(super) fn analyse(
    meant: &Meant<'_>,
    options: &Options,
    max_error: f64,
    diagonal: f64,
) -> Result<Analysed> {
    match meant.input.as_ref() {
        Input::Mesh(mesh) => Ok(of_mesh(mesh, meant, options, max_error, diagonal)),
        Input::Cloud(cloud) => of_cloud(cloud, meant, options, max_error, diagonal),
    }
}

fn of_mesh(mesh: &Mesh, meant: &Meant<'_>, options: &Options, max_error: f64, diagonal: f64) -> Analysed {
    let features = features(mesh, &meant.edges, options.edge_angle, max_error);
    let (marked, found) = Marked::of(mesh, &features, &making(max_error, diagonal));
    // Of a smooth surface's lines, the input's are those to tell of.
    let matched = match &meant.made {
        Made::Smooth(before) => before.matched.clone(),
        Made::Itself | Made::Quiet(_) => found.matched,
    };
    Analysed {
        surface: marked.surface(),
        marked: Some(marked),
        features: Found { matched, ..found },
        discs: is_looked_at(options).then(Discs::default),
        ..Analysed::default()
    }
}

fn of_cloud(
    cloud: &Cloud,
    meant: &Meant<'_>,
    options: &Options,
    max_error: f64,
    diagonal: f64,
) -> Result<Analysed> {
    let given = given_lines(&meant.edges, &cloud.frame);
    let lines = cloud_lines(&meant.edges, &given, options.edge_angle, max_error);
    let (normals, reach) = (options.normals.into(), thinning(max_error, diagonal));
    let told = told_margins(options, meant.noise, diagonal);
    let CloudSurface { surface, left_out, discs, edges, open_places, sparse, matched } =
        cloud_surface(cloud, normals, lines, meant.noise, Some(reach), told, Some(max_error))?;
    // Creases found before the cloud was smoothed are not the user's.
    let matched = matched.filter(|_| matches!(options.edges, Edges::Given(_)));
    let features = Found { feature_edges: edges, matched, ..Found::default() };
    Ok(Analysed { surface, marked: None, features, left_out, discs, open_places, sparse })
}
