//! From where holes and pictures are measured: the 26 directions of the cube.

use glam::DVec3;
use rayon::prelude::*;

use crate::render::Camera;
use crate::render::camera::Projection;
use crate::render::input::Model;

/// Width and height of every view, pixels.
pub const SIDE: u32 = 512;

/// Share of the picture's side that the model's greater extent fills: what is left shows what
/// sticks out.
const FILLED: f64 = 0.95;

/// Distance of the eye from the middle of the box, in diagonals: far outside the model.
const DISTANCE: f64 = 2.0;

/// A view.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Where it looks from: `right`, `left`, `top`, `bottom`, `front`, `back` for `+X` to `-Z`,
    /// joined by `-`.
    pub name: String,
    /// Orthographic, for a square picture.
    pub camera: Camera,
    /// Height of the picture in model units.
    pub height: f64,
}

/// The views from the directions of a cube's 6 faces, 12 edges and 8 corners, in this order.
///
/// Each picture is centred on what the input's points span across it, and as high as the
/// greater extent of that takes. Up is `+Y`; seen from `+Y` it is `-Z`, from `-Y` it is `+Z`.
#[must_use]
pub fn views(model: Model<'_>) -> Vec<View> {
    let steps = [1.0, 0.0, -1.0];
    let mut all: Vec<DVec3> = Vec::with_capacity(27);
    for x in steps {
        for y in steps {
            all.extend(steps.map(|z| DVec3::new(x, y, z)));
        }
    }
    // Faces, edges, corners: by how many coordinates are not 0. The sort keeps the order within.
    all.retain(|corner| *corner != DVec3::ZERO);
    all.sort_by_key(|corner| corner.abs().element_sum() as u32);
    let diagonal = model.diagonal();
    all.into_par_iter().map(|corner| view(corner, model, diagonal)).collect()
}

/// The view from one corner of `{-1, 0, 1}³`.
fn view(corner: DVec3, model: Model<'_>, diagonal: f64) -> View {
    let direction = corner.normalize();
    let up = if corner.x == 0.0 && corner.z == 0.0 { -corner.y * DVec3::Z } else { DVec3::Y };
    let right = up.cross(direction).normalize();
    let upward = direction.cross(right);
    // A single point has no extent; any height shows it.
    let size = if diagonal > 0.0 { diagonal } else { 1.0 };
    let [across, along] = [right, upward].map(|axis| span(model, axis));
    let extent = (across[1] - across[0]).max(along[1] - along[0]);
    let height = if extent > 0.0 { extent / FILLED } else { size };
    let middle = 0.5 * ((across[0] + across[1]) * right + (along[0] + along[1]) * upward);
    let frame = &model.cloud().frame;
    let camera = Camera {
        eye: frame.to_input(middle + DISTANCE * size * direction).into(),
        target: frame.to_input(middle).into(),
        up: up.into(),
        projection: Projection::Orthographic { height: height * frame.scale() },
        near: None,
    };
    View { name: name(corner), camera, height }
}

/// Least and greatest place of the points along an axis.
fn span(model: Model<'_>, axis: DVec3) -> [f64; 2] {
    let places = model.cloud().positions.iter().map(|point| point.as_dvec3().dot(axis));
    let span = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
    if span[0] <= span[1] { span } else { [0.0; 2] }
}

fn name(corner: DVec3) -> String {
    let word = |at: f64, words: [&'static str; 2]| match at {
        at if at > 0.0 => Some(words[0]),
        at if at < 0.0 => Some(words[1]),
        _ => None,
    };
    let words = [
        word(corner.x, ["right", "left"]),
        word(corner.y, ["top", "bottom"]),
        word(corner.z, ["front", "back"]),
    ];
    words.into_iter().flatten().collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::cloud::Cloud;
    use crate::model::frame::Frame;
    use crate::render::input::{Style, visibility};
    use glam::Vec3;
    use std::collections::BTreeSet;

    /// The corners of a long box, far from the origin of the input's coordinates.
    fn bar() -> Cloud {
        let frame = Frame { origin: DVec3::new(1e5, -20.0, 3.0), exponent: 4 };
        let corner = |n: u32| {
            let side = |bit: u32| if n >> bit & 1 == 0 { -1.0 } else { 1.0 };
            Vec3::new(0.9 * side(0), 0.1 * side(1), 0.3 * side(2))
        };
        Cloud { frame, positions: (0..8).map(corner).collect(), ..Cloud::default() }
    }

    #[test]
    fn there_are_26_views_with_names_of_their_own() {
        let cloud = bar();
        let views = views(Model::Cloud(&cloud));
        let names: BTreeSet<&str> = views.iter().map(|view| view.name.as_str()).collect();
        assert_eq!(names.len(), 26);
        assert_eq!(
            [0, 5, 6, 25].map(|n| views[n].name.as_str()),
            ["right", "left", "right-top", "left-bottom-back"]
        );
        assert!(views.iter().all(|view| view.camera.check().is_ok()));
    }

    #[test]
    fn the_model_fills_every_view_and_stays_inside() -> crate::Result<()> {
        let cloud = bar();
        let model = Model::Cloud(&cloud);
        // Discs of half a pixel: what is seen is where the points are.
        let pixels = 200_u32;
        for view in views(model) {
            let point_radius = Some(0.75 * view.height / f64::from(pixels) * cloud.frame.scale());
            let style = Style { point_radius, ..Style::default() };
            let seen = visibility(model, &view.camera, [pixels; 2], &style)?;
            let (mut x, mut y) = ([pixels, 0], [pixels, 0]);
            for at in (0..pixels * pixels).filter(|at| seen.at(at % pixels, at / pixels).is_some()) {
                let (column, row) = (at % pixels, at / pixels);
                (x, y) = ([x[0].min(column), x[1].max(column)], [y[0].min(row), y[1].max(row)]);
            }
            let filled = f64::from((x[1] - x[0]).max(y[1] - y[0])) / f64::from(pixels);
            assert!((filled - FILLED).abs() < 0.02, "{}: {filled}", view.name);
            assert!(
                (x[0] + x[1]).abs_diff(pixels - 1) <= 2 && (y[0] + y[1]).abs_diff(pixels - 1) <= 2,
                "{}",
                view.name
            );
        }
        Ok(())
    }
}
