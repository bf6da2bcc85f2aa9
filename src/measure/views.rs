//! From where holes and pictures are measured: the 26 directions of the cube.

use glam::DVec3;

use crate::model::frame::Frame;
pub use crate::model::outlook::SIDE;
use crate::model::outlook::{Outlook, outlooks};
use crate::render::Camera;
use crate::render::camera::Projection;
use crate::render::input::Model;

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
    let diagonal = model.diagonal();
    // A single point has no extent; any height shows it.
    let size = if diagonal > 0.0 { diagonal } else { 1.0 };
    let outlooks = outlooks(&model.cloud().positions);
    outlooks.iter().map(|outlook| view(outlook, &model.cloud().frame, size)).collect()
}

/// The view of a model of some size from one side.
fn view(outlook: &Outlook, frame: &Frame, size: f64) -> View {
    let height = if outlook.extent() > 0.0 { outlook.height() } else { size };
    let middle = outlook.middle();
    let camera = Camera {
        eye: frame.to_input(middle + DISTANCE * size * outlook.direction()).into(),
        target: frame.to_input(middle).into(),
        up: outlook.up.into(),
        projection: Projection::Orthographic { height: height * frame.scale() },
        near: None,
    };
    View { name: name(outlook.corner), camera, height }
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
    use crate::model::outlook::FILLED;
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
