//! The rays on which an asset shows a hole, or anything beside the outline: what a bake has to mend.
//!
//! They are the rays of [`super::holes`], so that what is mended is what is counted, and for holes
//! as many midway between these: slits are narrower than a pixel, and those that no ray of the one lattice
//! meets show to others.

use glam::DVec3;
use rayon::prelude::*;

use super::holes::{self, Depths, Mark, Rules};
use super::views::{SIDE, View, views};
use crate::error::Result;
use crate::model::asset::Asset;
use crate::model::mesh::Mesh;
use crate::model::sight::{Faults, Sight};
use crate::render::cpu;
use crate::render::eye::Eye;
use crate::render::input::{Model, Prepared, Style};

/// A mesh is not drawn as discs.
const NO_DISC: f64 = 0.0;

/// Pixels that the bound spans at most in a view whose extra pixels count. A view along a needle magnifies
/// it, and the bound with it: what stands out there is what the bound allows.
const WIDEST: f64 = 4.0;

/// How far away a mesh lies in the views of [`views`] and in those between. Eight bytes a pixel.
pub struct Sights {
    /// The views that holes are counted in.
    own: Vec<(View, Depths)>,
    /// Those [`between`] them that still showed a hole when they were last looked along.
    moved: Vec<(View, Depths)>,
}

impl Sights {
    /// Looks at a mesh.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] for a view that cannot be drawn.
    pub fn of(mesh: &Mesh) -> Result<Self> {
        let model = Model::Mesh(mesh);
        let input = Prepared::new(model, &Style::default());
        let drawn = |view: View| {
            let depths = Depths::from(&input.visibility(&view.camera, [SIDE; 2])?);
            Ok((view, depths))
        };
        let all = |views: Vec<View>| views.into_par_iter().map(drawn).collect::<Result<_>>();
        let own = views(model);
        let scale = model.cloud().frame.scale();
        let moved = own.iter().map(|view| between(view, scale)).collect();
        Ok(Self { own: all(own)?, moved: all(moved)? })
    }

    /// The rays of pixels that are missing or seen through, and of those that are extra, in the order of
    /// the views; extra ones of views that show the bound four pixels wide at most.
    ///
    /// Only holes are looked for along the views between: what stands out beside the outline is wider than
    /// a pixel where it counts. Each of them is looked along until it shows none: most show none from the
    /// first, and what mends one ray seldom opens another.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn faults(&mut self, asset: &Asset) -> Result<Faults> {
        let along = |views: &[(View, Depths)]| {
            let each = views.par_iter().map(|(view, depths)| faults(asset, view, depths));
            each.collect::<Result<Vec<Faults>>>()
        };
        let (own, moved) = (along(&self.own)?, along(&self.moved)?);
        let mut shown = moved.iter().map(|one| !one.open.is_empty());
        self.moved.retain(|_| shown.next().unwrap_or_default());
        let mut all = Faults::default();
        for Faults { open, beside } in own {
            all.open.extend(open);
            all.beside.extend(beside);
        }
        all.open.extend(moved.into_iter().flat_map(|one| one.open));
        Ok(all)
    }
}

/// The same view moved across by half a pixel of [`SIDE`] each way, so that each of its rays passes midway
/// between four; `scale` is the length of a model unit in input units.
fn between(view: &View, scale: f64) -> View {
    let mut moved = view.clone();
    let [eye, target, up] = [view.camera.eye, view.camera.target, view.camera.up].map(DVec3::from);
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let pixel = scale * view.height / f64::from(SIDE);
    let by = 0.5 * pixel * (right + right.cross(forward));
    (moved.camera.eye, moved.camera.target) = ((eye + by).into(), (target + by).into());
    moved
}

/// The same for one view.
fn faults(asset: &Asset, view: &View, depths: &Depths) -> Result<Faults> {
    let splats = cpu::visibility(asset, &view.camera, [SIDE; 2])?;
    let rules = Rules::new(asset, NO_DISC, view, SIDE);
    let map = holes::compare(depths, &splats, &rules);
    let eye = Eye::new(&view.camera, &asset.frame, [SIDE; 2])?;
    let open = |(x, y): (u32, u32)| {
        let own = depths.at(x, y)?;
        let beyond = holes::farthest(depths, x, y) + rules.behind - own;
        Some(Sight { at: eye.place([x, y], own), direction: eye.forward, beyond })
    };
    let bound = asset.max_error / view.height * f64::from(SIDE);
    let beside = |(x, y): (u32, u32)| {
        let at = eye.place([x, y], splats.at(x, y)?.depth);
        Some(Sight { at, direction: eye.forward, beyond: f64::INFINITY })
    };
    Ok(Faults {
        open: map.places(&[Mark::Missing, Mark::Through]).filter_map(open).collect(),
        beside: map.places(&[Mark::Extra]).filter(|_| bound <= WIDEST).filter_map(beside).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::cloud::Cloud;
    use crate::model::frame::Frame;
    use glam::{DVec2, Vec3};

    #[test]
    fn moved_rays_pass_midway_between_four() -> Result<()> {
        let frame = Frame { origin: DVec3::new(1e3, -20.0, 3.0), exponent: 4 };
        let positions = vec![Vec3::ZERO, Vec3::new(0.5, 0.25, 0.125)];
        let cloud = Cloud { frame, positions, ..Cloud::default() };
        for view in views(Model::Cloud(&cloud)) {
            let moved = between(&view, frame.scale());
            let [own, other] = [&view, &moved].map(|view| Eye::new(&view.camera, &frame, [SIDE; 2]));
            let (own, other) = (own?, other?);
            let corners = [[7, 9], [8, 9], [7, 8], [8, 8]].map(|pixel| own.place(pixel, 1.0));
            let middle = corners.iter().sum::<DVec3>() / 4.0;
            let pixel = view.height / f64::from(SIDE);
            let off =
                DVec2::new(middle.distance(other.place([7, 9], 1.0)), own.forward.distance(other.forward));
            assert!(off.max_element() < 1e-6 * pixel.min(1.0), "{}: {off}", view.name);
        }
        Ok(())
    }
}
