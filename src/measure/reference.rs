//! What files are measured against: all that depends on the input alone, made once.

use glam::Vec3;
use rayon::prelude::*;

use super::fit;
use super::input_surface::InputSurface;
use super::seen::Drawn;
use super::views::{self, View};
use crate::error::Result;
use crate::render::input::{Model, Prepared, Style};

/// An input, sampled and drawn, to measure any number of files against.
///
/// Beside the input itself it takes about a hundred megabytes, most of them for the pictures.
pub struct Reference<'a> {
    /// The input, or the surface that it stands for.
    pub model: Model<'a>,
    /// Of the input's bounding box, in the model's units: by it a file is known to belong to it.
    pub diagonal: f64,
    /// Points of a cloud that belong to no surface: outliers, which the model does without.
    pub outliers: usize,
    /// The points of [`fit::points`].
    pub points: Vec<Vec3>,
    /// Its surface.
    pub surface: InputSurface<'a>,
    /// Its pictures from the views of [`views::views`], in that order.
    pub drawn: Vec<Drawn>,
}

impl<'a> Reference<'a> {
    /// Samples and draws an input; a cloud as the surface that it tells of, [`Model::Surface`].
    ///
    /// # Errors
    /// [`crate::Error::Usage`] for a mesh without any area, and for a [`Model::Cloud`].
    pub fn new(model: Model<'a>) -> Result<Self> {
        Self::standing_for(model, model.diagonal())
    }

    /// As [`Self::new`], of a surface that stands for an input with a bounding box of this diagonal,
    /// in the surface's units. What it says of outliers, none, is for whoever left some out to set right.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn standing_for(model: Model<'a>, diagonal: f64) -> Result<Self> {
        let surface = InputSurface::new(model)?;
        let input = Prepared::new(model, &Style::default());
        let views = views::views(model);
        let drawn = views.into_par_iter().map(|view| Drawn::new(&input, view)).collect::<Result<_>>()?;
        Ok(Self { model, diagonal, outliers: 0, points: fit::points(model, &[]), surface, drawn })
    }

    /// The views.
    pub fn views(&self) -> impl Iterator<Item = &View> + Clone {
        self.drawn.iter().map(|drawn| &drawn.view)
    }
}
