//! The rays on which an asset shows a hole: what a bake has to close.
//!
//! They are the rays of [`super::holes`], so that no hole is left where holes are counted.

use rayon::prelude::*;

use super::holes::{self, Depths, Mark, Rules};
use super::views::{SIDE, View, views};
use crate::error::Result;
use crate::model::asset::Asset;
use crate::model::mesh::Mesh;
use crate::model::sight::Sight;
use crate::render::cpu;
use crate::render::eye::Eye;
use crate::render::input::{Model, Prepared, Style};

/// A mesh is not drawn as discs.
const NO_DISC: f64 = 0.0;

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

    /// The rays of pixels that are missing or seen through, in the order of the views. Views without any
    /// are not looked at again: splats that are added open no hole.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn open(&mut self, asset: &Asset) -> Result<Vec<Sight>> {
        let each = self.views.par_iter().map(|(view, depths)| open(asset, view, depths));
        let each = each.collect::<Result<Vec<Vec<Sight>>>>()?;
        let mut holes = each.iter().map(|sights| !sights.is_empty());
        self.views.retain(|_| holes.next().unwrap_or(false));
        Ok(each.concat())
    }
}

/// The same for one view.
fn open(asset: &Asset, view: &View, depths: &Depths) -> Result<Vec<Sight>> {
    let splats = cpu::visibility(asset, &view.camera, [SIDE; 2])?;
    let rules = Rules::new(asset, NO_DISC, view, SIDE);
    let map = holes::compare(depths, &splats, &rules);
    let eye = Eye::new(&view.camera, &asset.frame, [SIDE; 2])?;
    let sight = |(x, y): (u32, u32)| {
        let own = depths.at(x, y)?;
        let beyond = holes::farthest(depths, x, y) + rules.behind - own;
        Some(Sight { at: eye.place([x, y], own), direction: eye.forward, beyond })
    };
    Ok(map.places(&[Mark::Missing, Mark::Through]).filter_map(sight).collect())
}
