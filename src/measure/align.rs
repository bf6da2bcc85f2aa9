//! Whether an input belongs to a file, and the input in the file's model units.

use std::borrow::Cow;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::model::cloud::Cloud;
use crate::model::frame::Frame;
use crate::model::mesh::Mesh;
use crate::render::input::Model;

/// Boxes that differ by more than this share of the diagonal are of different models. A hundredth
/// of the default budget, and above what six decimal digits change when a model is written as text.
const SAME_BOX: f64 = 1e-5;

/// An input in a file's model units.
pub enum Aligned<'a> {
    /// A mesh.
    Mesh(Cow<'a, Mesh>),
    /// A cloud.
    Cloud(Cow<'a, Cloud>),
}

impl Aligned<'_> {
    /// The input, to be drawn and measured.
    #[must_use]
    pub fn model(&self) -> Model<'_> {
        match self {
            Self::Mesh(mesh) => Model::Mesh(mesh),
            Self::Cloud(cloud) => Model::Cloud(cloud),
        }
    }
}

/// Brings an input to an asset's model units; a copy is made only if the frames differ.
///
/// # Errors
/// [`Error::Usage`] if the bounding boxes differ by more than rounding: the file was baked from
/// something else.
pub fn align<'a>(against: Model<'a>, asset: &Asset) -> Result<Aligned<'a>> {
    let frame = against.cloud().frame;
    let diagonals = [asset.diagonal * asset.frame.scale(), against.diagonal() * frame.scale()];
    let apart = frame.origin.distance(asset.frame.origin);
    // Written so that a NaN is refused.
    let same = [apart, (diagonals[0] - diagonals[1]).abs()].iter().all(|&off| off <= SAME_BOX * diagonals[0]);
    if !same {
        return Err(Error::Usage(format!(
            "the file and the input do not belong together: the file's bounding box has its centre at {} and \
             a diagonal of {}, the input's {} and {}; give the input that the file was baked from",
            asset.frame.origin, diagonals[0], frame.origin, diagonals[1]
        )));
    }
    Ok(match against {
        Model::Mesh(mesh) if frame == asset.frame => Aligned::Mesh(Cow::Borrowed(mesh)),
        Model::Cloud(cloud) if frame == asset.frame => Aligned::Cloud(Cow::Borrowed(cloud)),
        Model::Mesh(mesh) => {
            let vertices = moved(&mesh.vertices, asset.frame);
            Aligned::Mesh(Cow::Owned(Mesh { vertices, ..mesh.clone() }))
        }
        Model::Cloud(cloud) => Aligned::Cloud(Cow::Owned(moved(cloud, asset.frame))),
    })
}

/// Feature lines in the model units of `from`, in those of `to`.
#[must_use]
pub fn lines<'a>(lines: &'a [Vec<DVec3>], from: &Frame, to: &Frame) -> Cow<'a, [Vec<DVec3>]> {
    if from == to {
        return Cow::Borrowed(lines);
    }
    let point = |point: &DVec3| to.to_model(from.to_input(*point));
    lines.iter().map(|line| line.iter().map(point).collect()).collect()
}

fn moved(cloud: &Cloud, frame: Frame) -> Cloud {
    let point = |point: &glam::Vec3| frame.to_model(cloud.frame.to_input(point.as_dvec3())).as_vec3();
    Cloud { frame, positions: cloud.positions.iter().map(point).collect(), ..cloud.clone() }
}
