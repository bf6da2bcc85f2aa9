//! Feature lines: where they come from, for a mesh and for a cloud, and how they go between input and model units.

use glam::DVec3;

use super::analysed::making;
use super::bound::diagonal;
use super::options::Edges;
use crate::analyse::cloud_creases::{Sought, cloud_creases};
use crate::analyse::cloud_normals::NormalSource;
use crate::analyse::cloud_surface::Lines;
use crate::analyse::mesh_surface::{Features, cut_lines};
use crate::analyse::sided::Sided;
use crate::error::Result;
use crate::ingest::Input;
use crate::model::frame::Frame;
use crate::model::mesh::Mesh;
use crate::model::polyline::Polylines;

/// Lines found that are shorter than this many error bounds, taken together with all that they
/// meet, are left out.
const SHORTEST_LINE: f64 = 8.0;

/// Given lines that lie off the edges they mean by at most this share of the diagonal are moved
/// onto them: five error bounds at the default.
const BESIDE: f64 = 0.005;

/// Which edges of a mesh are feature edges.
pub(super) fn features(mesh: &Mesh, edges: &Edges, edge_angle: f64, max_error: f64) -> Features {
    match edges {
        Edges::Auto => Features::Sharp { degrees: edge_angle, shortest: SHORTEST_LINE * max_error },
        Edges::None => Features::None,
        Edges::Given(lines) => Features::Given {
            segments: segments(lines, &mesh.vertices.frame),
            beside: BESIDE * diagonal(&mesh.vertices.positions),
        },
    }
}

/// The lines that are given, model units.
pub(super) fn given_lines(edges: &Edges, frame: &Frame) -> Vec<Vec<DVec3>> {
    match edges {
        Edges::Given(lines) => model_lines(lines, frame),
        Edges::Auto | Edges::None => Vec::new(),
    }
}

/// Where the feature lines of a cloud come from; those that are `given` are its [`given_lines`].
pub(super) fn cloud_lines<'a>(
    edges: &Edges,
    given: &'a [Vec<DVec3>],
    edge_angle: f64,
    max_error: f64,
) -> Lines<'a> {
    match edges {
        Edges::Auto => Lines::Found(sought(edge_angle, max_error)),
        Edges::Given(_) | Edges::None => Lines::Given(given),
    }
}

/// Which creases of a cloud are feature lines.
fn sought(edge_angle: f64, max_error: f64) -> Sought {
    Sought { degrees: edge_angle, shortest: SHORTEST_LINE * max_error }
}

/// The lines along which a bake with these options cuts its splats, model units: feature lines,
/// and a mesh's open borders, where splats are cut as well.
///
/// A mesh's lines come as segments of two points. Lines given with a mesh are moved onto the edges
/// they mean where they lie a little off these, kept as they are where they mean none (they are lost,
/// and cut nothing). Lines given with a cloud that shows no noise are moved onto the creases they mean.
/// Lines given with a mesh or a cloud are left out where that is smooth.
/// `noise` is that of a cloud's points, model units; `edge_angle` is in degrees; `max_error`, in model
/// units, decides which found lines are too short to count. `None` where there are no lines: for a
/// smooth cloud, for a smooth closed mesh, and for [`Edges::None`].
///
/// # Errors
/// As [`cloud_creases`], for the found lines of a cloud.
pub fn feature_lines(
    input: &Input,
    edges: &Edges,
    noise: Option<f64>,
    edge_angle: f64,
    max_error: f64,
) -> Result<Option<Vec<Vec<DVec3>>>> {
    let lines = match (input, edges) {
        (_, Edges::None) => Vec::new(),
        (Input::Mesh(mesh), _) => {
            let making = making(max_error, diagonal(&mesh.vertices.positions));
            cut_lines(mesh, &features(mesh, edges, edge_angle, max_error), &making)
        }
        (Input::Cloud(cloud), Edges::Given(lines)) => {
            let lines = model_lines(lines, &cloud.frame);
            Sided::of(cloud, NormalSource::Auto, Lines::Given(&lines), noise)?.lines
        }
        (Input::Cloud(cloud), Edges::Auto) => cloud_creases(cloud, &sought(edge_angle, max_error), noise)?,
    };
    Ok((!lines.is_empty()).then_some(lines))
}

/// Lines in model units.
#[must_use]
pub fn model_lines(lines: &Polylines, frame: &Frame) -> Vec<Vec<DVec3>> {
    lines.lines.iter().map(|line| line.iter().map(|&point| frame.to_model(point)).collect()).collect()
}

/// Lines of model units in input units.
pub(super) fn input_lines(lines: &[impl AsRef<[DVec3]>], frame: &Frame) -> Polylines {
    let to_input = |line: &[DVec3]| line.iter().map(|&place| frame.to_input(place)).collect();
    Polylines { lines: lines.iter().map(|line| to_input(line.as_ref())).collect() }
}

/// The segments of lines, in model units.
fn segments(lines: &Polylines, frame: &Frame) -> Vec<[DVec3; 2]> {
    let lines = model_lines(lines, frame);
    lines.iter().flat_map(|line| line.windows(2)).map(|pair| [pair[0], pair[1]]).collect()
}
