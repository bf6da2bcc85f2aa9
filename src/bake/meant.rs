//! What is baked: the input, or what it stands for.
//!
//! A mesh may stand for a smooth surface, a noisy cloud for a smoother one.

use std::borrow::Cow;

use super::analysed::{MOST_PIECES, piece_length};
use super::bound::diagonal;
use super::lines::{cloud_lines, features, given_lines, input_lines};
use super::noise::noise;
use super::options::{Edges, Meaning, Options};
use super::quiet::{Quieted, is_loud, is_noisy, least_bound, quieted};
use crate::analyse::mesh_surface::Found;
use crate::analyse::sided::Sided;
use crate::analyse::smooth::Fineness;
use crate::analyse::smoothed::{Smoothed, Smoothing, smoothed};
use crate::error::{Error, Result};
use crate::ingest::Input;
use crate::model::cloud::Cloud;
use crate::model::mesh::Mesh;

/// Facets of a smooth surface lie within this share of the error bound of it.
const SMOOTH_SHARE: f64 = 0.05;

/// A smooth surface that lies nearer to the facets than this share of the error bound everywhere
/// is not worth asking which is meant.
const NOTICEABLE: f64 = 0.25;

/// An error bound of less than this many standard deviations of a cloud's noise is refused. Of points
/// that scatter normally one in 370 strays farther, and takes a splat of its own. A cloud of a million
/// on a smooth surface takes 770 splats at a bound of four, 1,900 at three and 6,200 at two and a half:
/// these are splats for noise.
const LEAST_BOUND: f64 = 3.0;

/// What a least bound is told larger by, so that its four digits are enough.
const ROUNDED: f64 = 1e-3;

/// What is baked in the place of an input.
#[derive(Clone, Debug)]
pub struct Meant<'a> {
    /// The input, or what it stands for, in the same frame: a smooth surface may bulge a little
    /// beyond its box.
    pub input: Cow<'a, Input>,
    /// The feature lines of that; those of a smoothed cloud are given, as they were or were found before.
    pub edges: Cow<'a, Edges>,
    /// Standard deviation of a cloud's points from their surface, model units; `None` for a mesh, and
    /// for a cloud that shows no surface.
    pub noise: Option<f64>,
    /// What was done.
    pub made: Made,
}

/// What was made of an input.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Made {
    /// Nothing: it stands for itself.
    #[default]
    Itself,
    /// A smooth surface of a mesh's facets; what became of the mesh's feature edges.
    Smooth(Found),
    /// A cloud without its noise.
    Quiet(Quiet),
}

/// How a cloud was smoothed, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quiet {
    /// Root mean square of the ways that the points were moved.
    pub moved_rms: f64,
    /// The longest.
    pub moved_max: f64,
    /// Standard deviation of the smoothed points from their surface; `None` where they show none.
    pub left: Option<f64>,
}

/// What a bake of an input with these options bakes; `max_error` is its bound in model units.
///
/// Of the options only the edges, their angle, the meaning and `denoise` matter. A cloud too noisy to
/// be smoothed for the bound stands for itself: [`check_noise`] refuses it.
///
/// # Errors
/// [`Error::Internal`] should the neighbour search not take the points of a cloud.
pub fn meant<'a>(input: &'a Input, options: &'a Options, max_error: f64) -> Result<Meant<'a>> {
    match input {
        Input::Mesh(mesh) => Ok(of_mesh(input, mesh, options, max_error)),
        Input::Cloud(cloud) => of_cloud(input, cloud, options, max_error),
    }
}

fn itself<'a>(input: &'a Input, options: &'a Options) -> Meant<'a> {
    Meant {
        input: Cow::Borrowed(input),
        edges: Cow::Borrowed(&options.edges),
        noise: None,
        made: Made::Itself,
    }
}

fn of_mesh<'a>(input: &'a Input, mesh: &Mesh, options: &'a Options, max_error: f64) -> Meant<'a> {
    let only_beyond = match options.meaning {
        Meaning::Facets => return itself(input, options),
        Meaning::Smooth => None,
        Meaning::Auto => Some(NOTICEABLE * max_error),
    };
    let smoothing = Smoothing {
        degrees: options.edge_angle,
        fineness: Fineness {
            tolerance: SMOOTH_SHARE * max_error,
            longest: piece_length(max_error, diagonal(&mesh.vertices.positions)),
            most: MOST_PIECES,
        },
        only_beyond,
    };
    let features = features(mesh, &options.edges, options.edge_angle, max_error);
    let Some(Smoothed { mesh, lines, found }) = smoothed(mesh, &features, &smoothing) else {
        return itself(input, options);
    };
    let edges = match &options.edges {
        Edges::Given(_) => Cow::Owned(Edges::Given(input_lines(&lines, &mesh.vertices.frame))),
        kept => Cow::Borrowed(kept),
    };
    Meant { input: Cow::Owned(Input::Mesh(mesh)), edges, noise: None, made: Made::Smooth(found) }
}

fn of_cloud<'a>(input: &'a Input, cloud: &Cloud, options: &'a Options, max_error: f64) -> Result<Meant<'a>> {
    let noise = noise(cloud);
    let itself = Meant { noise, ..itself(input, options) };
    // Where a bound is kept without, too: noise nearly as wide as the points lie apart hides how the
    // surface goes on from one to the next, and bumps make splats small.
    let wanted =
        |noise: &f64| options.denoise && max_error >= least_bound(*noise) && is_noisy(*noise, max_error);
    let Some(noise) = noise.filter(wanted) else { return Ok(itself) };
    let given = given_lines(&options.edges, &cloud.frame);
    let lines = cloud_lines(&options.edges, &given, options.edge_angle, max_error);
    let sided = Sided::of(cloud, options.normals.into(), lines, Some(noise))?;
    let Quieted { cloud: smoothed, moved_rms, moved_max } = quieted(cloud, &sided, max_error)?;
    let made = Made::Quiet(Quiet { moved_rms, moved_max, left: self::noise(&smoothed) });
    let edges = match &options.edges {
        // Smoothed on either side of its creases, a cloud shows others where these were lost in the noise.
        Edges::Auto => Cow::Owned(Edges::Given(input_lines(&sided.lines, &cloud.frame))),
        // As they are: what becomes of them is told by their numbers.
        given => Cow::Borrowed(given),
    };
    Ok(Meant { input: Cow::Owned(Input::Cloud(smoothed)), edges, made, ..itself })
}

/// Refuses a cloud whose noise, or what smoothing leaves of it, an error bound (model units) is below.
///
/// # Errors
/// [`Error::Usage`] with the least bound that is not, in input units.
pub fn check_noise(meant: &Meant<'_>, denoise: bool, max_error: f64) -> Result<()> {
    let Some(noise) = meant.noise else { return Ok(()) };
    let plain = LEAST_BOUND * noise;
    let loud = match &meant.made {
        Made::Quiet(quiet) => max_error < plain && is_loud(quiet.left, max_error),
        Made::Itself | Made::Smooth(_) => false,
    };
    // A bound that takes no smoothing, where that does not help.
    let least = if denoise && !loud { least_bound(noise) } else { plain };
    if max_error >= least {
        return Ok(());
    }
    let scale = meant.input.cloud().frame.scale();
    let remedy = match (denoise, loud) {
        (false, _) => ", or --denoise to smooth them",
        (true, false) => "",
        (true, true) => ": these do not smooth to a surface",
    };
    Err(Error::Usage(format!(
        "the points scatter about their surface by {:.3e} (standard deviation, input units), too much for an \
         error bound of {:.3e}: give a --max-error of {:.3e} or more{remedy}",
        noise * scale,
        max_error * scale,
        least * scale * (1.0 + ROUNDED)
    )))
}
