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
    /// The input.
    pub model: Model<'a>,
    /// The points of [`fit::points`].
    pub points: Vec<Vec3>,
    /// Its surface.
    pub surface: InputSurface<'a>,
    /// Its pictures from the views of [`views::views`], in that order.
    pub drawn: Vec<Drawn>,
}

impl<'a> Reference<'a> {
    /// Samples and draws an input.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] for a mesh without any area.
    pub fn new(model: Model<'a>) -> Result<Self> {
        let surface = InputSurface::new(model)?;
        let input = Prepared::new(model, &Style::default());
        let views = views::views(model);
        let drawn = views.into_par_iter().map(|view| Drawn::new(&input, view)).collect::<Result<_>>()?;
        Ok(Self { model, points: fit::points(model, &[]), surface, drawn })
    }

    /// The views.
    pub fn views(&self) -> impl Iterator<Item = &View> + Clone {
        self.drawn.iter().map(|drawn| &drawn.view)
    }
}
