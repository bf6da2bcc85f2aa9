//! The rays on which an asset shows a hole, or anything beside the outline: what a bake has to mend.
//!
//! They are the rays of [`super::holes`], so that what is mended is what is counted.

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

/// How far away a mesh lies in the views of [`views`]. Eight bytes a pixel.
pub struct Sights {
    views: Vec<(View, Depths)>,
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
        Ok(Self { views: views(model).into_par_iter().map(drawn).collect::<Result<_>>()? })
    }

    /// The rays of pixels that are missing or seen through, and of those that are extra, in the order of
    /// the views; extra ones of views that show the bound four pixels wide at most.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn faults(&self, asset: &Asset) -> Result<Faults> {
        let each = self.views.par_iter().map(|(view, depths)| faults(asset, view, depths));
        let mut all = Faults::default();
        for Faults { open, beside } in each.collect::<Result<Vec<Faults>>>()? {
            all.open.extend(open);
            all.beside.extend(beside);
        }
        Ok(all)
    }
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
