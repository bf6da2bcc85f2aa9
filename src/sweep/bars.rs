//! Stacked bars, one a case, as SVG.

use std::error::Error as StdError;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

use crate::error::{Error, Result};

/// Twice the pixels the page shows.
const WIDTH: u32 = 1240;

/// Height of a bar with the gap below it, pixels.
const ROW: u32 = 40;

/// Height of what lies below the bars: numbers and label.
const FOOT: u32 = 100;

/// Width of the names of the bars.
const NAMES: u32 = 330;

/// Height of text, pixels. The backend divides by 1.24.
const TEXT: u32 = 32;

/// Colours of the parts: first those of Okabe and Ito (2008), told apart with any colour vision,
/// then darker and lighter ones; as many as a file has kinds of chunks. More begin again.
pub(super) const PALETTE: [RGBColor; 16] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(240, 228, 66),
    RGBColor(90, 90, 90),
    RGBColor(180, 180, 180),
    RGBColor(0, 45, 75),
    RGBColor(250, 190, 170),
    RGBColor(120, 190, 60),
    RGBColor(110, 60, 140),
    RGBColor(150, 225, 215),
    RGBColor(110, 70, 30),
    RGBColor(230, 60, 90),
];

/// One bar.
#[derive(Clone, Debug)]
pub(super) struct Bar {
    pub(super) name: String,
    /// Lengths of its parts, as many as every other bar has.
    pub(super) parts: Vec<f64>,
}

/// The bars' axis: names in the middle of each row, the first at the top.
struct Rows {
    names: Vec<String>,
}

impl Ranged for Rows {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        // Screens count downward, and so do the bars: `limit` runs from the bottom to the top.
        let share = value / self.names.len() as f64;
        limit.1 + (share * f64::from(limit.0 - limit.1)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        (0..self.names.len()).map(|n| n as f64 + 0.5).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        0.0..self.names.len() as f64
    }
}

impl ValueFormatter<f64> for Rows {
    fn format_ext(&self, value: &f64) -> String {
        self.names.get(*value as usize).cloned().unwrap_or_default()
    }
}

/// Draws stacked bars; `None` without any.
///
/// # Errors
/// [`Error::Internal`] if the backend refuses.
pub(super) fn stacked(label: &str, bars: &[Bar]) -> Result<Option<String>> {
    if bars.is_empty() {
        return Ok(None);
    }
    let mut svg = String::new();
    draw(&mut svg, label, bars).map_err(|error| Error::Internal(format!("plot: {error}")))?;
    Ok(Some(svg))
}

fn draw(svg: &mut String, label: &str, bars: &[Bar]) -> std::result::Result<(), Box<dyn StdError>> {
    let size = (WIDTH, ROW * bars.len() as u32 + FOOT);
    let root = SVGBackend::with_string(svg, size).into_drawing_area();
    let longest = bars.iter().map(|bar| bar.parts.iter().sum::<f64>()).fold(0.0, f64::max);
    let end = if longest > 0.0 { 1.03 * longest } else { 1.0 };
    let names = bars.iter().map(|bar| bar.name.clone()).collect();
    let mut chart = ChartBuilder::on(&root)
        .margin_top(8)
        .margin_right(40)
        .x_label_area_size(FOOT - 8)
        .y_label_area_size(NAMES)
        .build_cartesian_2d(0.0..end, Rows { names })?;
    let ink = RGBColor(40, 40, 40);
    let text = ("sans-serif", TEXT).into_font().color(&ink);
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc(label)
        .x_labels(7)
        .label_style(text.clone())
        .axis_desc_style(text)
        .axis_style(ink.stroke_width(2))
        .bold_line_style(RGBColor(222, 222, 222))
        .light_line_style(TRANSPARENT)
        .draw()?;
    for (row, bar) in bars.iter().enumerate() {
        let (top, bottom) = (row as f64 + 0.14, row as f64 + 0.86);
        let mut start = 0.0;
        for (part, length) in bar.parts.iter().enumerate().filter(|(_, length)| **length > 0.0) {
            let color = PALETTE[part % PALETTE.len()].filled();
            chart.draw_series([Rectangle::new([(start, top), (start + length, bottom)], color)])?;
            start += length;
        }
    }
    root.present()?;
    drop(chart);
    drop(root);
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn bars_have_names_and_a_rectangle_a_part() {
        let bar = |name: &str, parts: &[f64]| Bar { name: name.into(), parts: parts.into() };
        let bars = [bar("1 % · 5", &[1.0, 0.0, 3.0]), bar("0.1 % · 5", &[2.0, 2.5, 0.5])];
        let svg = stacked("bake time, s", &bars).unwrap().unwrap();
        assert!(svg.contains("0.1 % · 5") && svg.contains("bake time, s"), "{svg}");
        assert_eq!(svg.matches("<rect").count(), 5, "{svg}");
        let first = svg.find("1 % · 5").unwrap();
        assert!(first < svg.find("0.1 % · 5").unwrap());
        assert_eq!(stacked("x", &[]).unwrap(), None);
        assert!(stacked("x", &[bar("nothing", &[0.0])]).unwrap().is_some());
    }
}
