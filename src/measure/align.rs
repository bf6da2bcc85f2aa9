//! Whether an input belongs to a file, and the input in the file's model units.

use std::borrow::Cow;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::model::cloud::Cloud;
use crate::model::discs::Discs;
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
    /// A cloud and the surface that it tells of.
    Surface(Cow<'a, Cloud>, Cow<'a, Discs>),
}

impl Aligned<'_> {
    /// The input, to be drawn and measured.
    #[must_use]
    pub fn model(&self) -> Model<'_> {
        match self {
            Self::Mesh(mesh) => Model::Mesh(mesh),
            Self::Cloud(cloud) => Model::Cloud(cloud),
            Self::Surface(cloud, discs) => Model::Surface(cloud, discs),
        }
    }
}

/// Brings an input to an asset's model units; a copy is made only if the frames differ.
///
/// # Errors
/// As [`check`].
pub fn align<'a>(against: Model<'a>, asset: &Asset) -> Result<Aligned<'a>> {
    check(&against.cloud().frame, against.diagonal(), asset)?;
    Ok(bring(against, asset))
}

/// Whether an input belongs to an asset, by its frame and the diagonal of its box in that frame.
///
/// # Errors
/// [`Error::Usage`] if the bounding boxes differ by more than rounding: the file was baked from
/// something else.
pub fn check(frame: &Frame, diagonal: f64, asset: &Asset) -> Result<()> {
    let diagonals = [asset.diagonal * asset.frame.scale(), diagonal * frame.scale()];
    // Rounded a little otherwise, a box may get an origin that is a step farther along each axis.
    let steps = DVec3::splat(frame.step().max(asset.frame.step()));
    let apart = frame.origin.distance(asset.frame.origin) - steps.length();
    // Written so that a NaN is refused.
    let same = [apart, (diagonals[0] - diagonals[1]).abs()].iter().all(|&off| off <= SAME_BOX * diagonals[0]);
    if same {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "the file and the input do not belong together: the file's bounding box lies around {} with a \
         diagonal of {}, the input's around {} with {}; give the input that the file was baked from",
        asset.frame.origin, diagonals[0], frame.origin, diagonals[1]
    )))
}

/// Brings a model to an asset's model units, whether it belongs to it or not.
#[must_use]
pub fn bring<'a>(against: Model<'a>, asset: &Asset) -> Aligned<'a> {
    let frame = against.cloud().frame;
    match against {
        Model::Mesh(mesh) if frame == asset.frame => Aligned::Mesh(Cow::Borrowed(mesh)),
        Model::Cloud(cloud) if frame == asset.frame => Aligned::Cloud(Cow::Borrowed(cloud)),
        Model::Mesh(mesh) => {
            let vertices = moved(&mesh.vertices, asset.frame);
            Aligned::Mesh(Cow::Owned(Mesh { vertices, ..mesh.clone() }))
        }
        Model::Surface(cloud, discs) if frame == asset.frame => {
            Aligned::Surface(Cow::Borrowed(cloud), Cow::Borrowed(discs))
        }
        Model::Cloud(cloud) => Aligned::Cloud(Cow::Owned(moved(cloud, asset.frame))),
        Model::Surface(cloud, discs) => Aligned::Surface(
            Cow::Owned(moved(cloud, asset.frame)),
            Cow::Owned(discs.moved(&frame, &asset.frame)),
        ),
    }
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

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;
    use crate::model::asset::Accuracy;
    use glam::Vec3;

    /// Two points whose box is `[-8, 8] x [-4, 4] x [0, 0]` around `origin`, in 2^`exponent`.
    fn cloud(origin: DVec3, exponent: i32) -> Cloud {
        let frame = Frame { origin, exponent };
        let scale = frame.scale() as f32;
        let corner = Vec3::new(8.0, 4.0, 0.0) / scale;
        Cloud { frame, positions: vec![corner, -corner], ..Cloud::default() }
    }

    fn asset() -> Asset {
        let frame = Frame { origin: DVec3::ONE, exponent: 3 };
        let diagonal = libm::hypot(2.0, 1.0);
        Asset {
            frame,
            diagonal,
            max_error: 1e-3,
            fit: Accuracy::default(),
            has_colors: false,
            splats: vec![],
        }
    }

    #[test]
    fn the_same_frame_is_not_copied_and_another_comes_to_the_same_places() {
        let same = cloud(DVec3::ONE, 3);
        assert!(matches!(align(Model::Cloud(&same), &asset()).unwrap(), Aligned::Cloud(Cow::Borrowed(_))));
        let other = cloud(DVec3::ONE + DVec3::X * 1e-5, 4);
        let aligned = align(Model::Cloud(&other), &asset()).unwrap();
        let model = aligned.model();
        let found = model.cloud();
        assert_eq!((found.frame, found.positions.len()), (asset().frame, 2));
        for (a, b) in found.positions.iter().zip(&same.positions) {
            assert!((a.distance(*b) - 1.25e-6).abs() < 2e-7, "{a} is not {b} and the origins' difference");
        }
        let line = [vec![DVec3::new(0.25, 0.5, 0.0)]];
        let moved = lines(&line, &other.frame, &asset().frame);
        assert!(moved[0][0].distance(DVec3::new(0.5 + 1.25e-6, 1.0, 0.0)) < 1e-12);
    }

    #[test]
    fn a_step_of_the_origin_along_each_axis_makes_no_other_model() {
        let other = cloud(DVec3::ONE + asset().frame.step(), 3);
        assert!(align(Model::Cloud(&other), &asset()).is_ok());
    }

    #[test]
    fn another_model_is_refused_with_both_boxes() {
        let mut bigger = cloud(DVec3::ONE, 3);
        bigger.positions[0].x *= 1.01;
        for other in [cloud(DVec3::ONE + DVec3::Y * 0.015, 3), bigger, Cloud::default()] {
            let message = align(Model::Cloud(&other), &asset()).err().unwrap().to_string();
            assert!(message.contains("17.88") && message.contains("baked from"), "{message}");
        }
    }
}
