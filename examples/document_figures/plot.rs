//! Curves as SVG.

use std::fmt::Display;

use plotters::prelude::*;
use qsplat::{Error, Result};

/// Width and height, pixels.
const SIZE: (u32, u32) = (640, 400);

/// One curve, or several over the same axes.
pub struct Plot<'a> {
    /// Above it.
    pub title: &'a str,
    /// Below the horizontal axis.
    pub across: &'a str,
    /// Beside the vertical axis, which begins at 0.
    pub up: &'a str,
    /// Each with its name.
    pub curves: Vec<(&'a str, Vec<(f64, f64)>)>,
}

impl Plot<'_> {
    /// Draws it.
    ///
    /// # Errors
    /// [`Error::Internal`] where there is nothing to draw, or the drawing fails.
    pub fn svg(&self) -> Result<String> {
        let mut svg = String::new();
        self.draw(&mut svg)?;
        Ok(svg)
    }

    fn draw(&self, svg: &mut String) -> Result<()> {
        let values = || self.curves.iter().flat_map(|curve| &curve.1);
        let (right, top) = values().fold((0.0, 0.0), |(x, y), value| (value.0.max(x), value.1.max(y)));
        let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(failed)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(self.title, ("sans-serif", 18))
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(70)
            .build_cartesian_2d(0.0..1.05 * right, 0.0..1.05 * top)
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_desc(self.across)
            .y_desc(self.up)
            .draw()
            .map_err(failed)?;
        for (number, (name, curve)) in self.curves.iter().enumerate() {
            let color = Palette99::pick(number).to_rgba();
            chart
                .draw_series(LineSeries::new(curve.iter().copied(), color.stroke_width(2)).point_size(3))
                .map_err(failed)?
                .label(*name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        }
        if self.curves.len() > 1 {
            let mut legend = chart.configure_series_labels();
            legend
                .position(SeriesLabelPosition::LowerRight)
                .background_style(WHITE.mix(0.8))
                .border_style(BLACK)
                .draw()
                .map_err(failed)?;
        }
        area.present().map_err(failed)
    }
}

fn failed(error: impl Display) -> Error {
    Error::Internal(format!("a plot cannot be drawn: {error}"))
}
