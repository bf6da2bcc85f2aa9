//! Curves on two logarithmic axes, as SVG.

use std::error::Error as StdError;

use plotters::chart::ChartContext;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

use crate::error::{Error, Result};

/// Twice the pixels the page shows, since the backend places everything on whole pixels.
const SIZE: (u32, u32) = (800, 620);

/// Height of text, pixels of [`SIZE`]. The backend divides by 1.24.
const TEXT: u32 = 32;

/// Colour of text and axes.
const INK: RGBColor = RGBColor(40, 40, 40);

/// Colour of guides.
const FAINT: RGBColor = RGBColor(120, 120, 120);

/// One curve.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) look: Look,
    /// `(x, y)` and whether the point is on the Pareto front.
    pub(super) points: Vec<(f64, f64, bool)>,
}

/// How a curve is drawn: told apart by colour, and in print by mark and dashes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) color: RGBColor,
    pub(super) mark: Mark,
    pub(super) dashed: bool,
}

/// The mark at each point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Circle,
    Square,
    Diamond,
    Triangle,
    Cross,
}

/// An axis over decades: its values are logarithms to base 10, its labels are numbers.
struct Decades {
    low: f64,
    high: f64,
}

impl Ranged for Decades {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.low) / (self.high - self.low);
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        ticks(self.low, self.high)
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Decades {
    fn format_ext(&self, log: &f64) -> String {
        number(libm::exp10(*log))
    }
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Decades, Decades>>;
type Drawn = std::result::Result<(), Box<dyn StdError>>;

/// Half the width of a mark, pixels.
const MARK: i32 = 9;

/// Radius of the ring around a point on the front, pixels.
const RING: i32 = 16;

/// Draws curves. Points that have no logarithm are left out; `None` if none remains.
///
/// # Errors
/// [`Error::Internal`] if the backend refuses.
pub(super) fn log_log(labels: [&str; 2], lines: &[Line], guides: &[Guide]) -> Result<Option<String>> {
    let lines: Vec<Line> = lines.iter().map(logarithms).filter(|line| !line.points.is_empty()).collect();
    if lines.is_empty() {
        return Ok(None);
    }
    let mut svg = String::new();
    draw(&mut svg, labels, &lines, guides).map_err(|error| Error::Internal(format!("plot: {error}")))?;
    Ok(Some(svg))
}

/// A dashed line of a known exponent through the middle of the chart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guide {
    /// `y ~ x^slope`.
    pub(super) slope: f64,
}

fn logarithms(line: &Line) -> Line {
    let sound = |v: f64| v > 0.0 && v.is_finite();
    let points = line.points.iter().filter(|(x, y, _)| sound(*x) && sound(*y));
    let points = points.map(|&(x, y, front)| (libm::log10(x), libm::log10(y), front)).collect();
    Line { look: line.look, points }
}

fn draw(svg: &mut String, labels: [&str; 2], lines: &[Line], guides: &[Guide]) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let all = || lines.iter().flat_map(|line| &line.points);
    let (x, y) = (extent(all().map(|p| p.0)), extent(all().map(|p| p.1)));
    let mut chart = ChartBuilder::on(&root)
        .margin_top(20)
        .margin_right(30)
        .x_label_area_size(92)
        .y_label_area_size(128)
        .build_cartesian_2d(Decades { low: x.0, high: x.1 }, Decades { low: y.0, high: y.1 })?;
    let text = ("sans-serif", TEXT).into_font().color(&INK);
    chart
        .configure_mesh()
        .x_desc(labels[0])
        .y_desc(labels[1])
        .label_style(text.clone())
        .axis_desc_style(text)
        .axis_style(INK.stroke_width(2))
        .bold_line_style(RGBColor(222, 222, 222))
        .light_line_style(TRANSPARENT)
        .draw()?;
    let middle = (0.5 * (x.0 + x.1), 0.5 * (y.0 + y.1));
    for guide in guides {
        let at = |x: f64| (x, middle.1 + guide.slope * (x - middle.0));
        // Sampled densely, since what leaves the chart is cut off at its border.
        let path: Vec<(f64, f64)> = (0..=200)
            .map(|n| at(x.0 + (x.1 - x.0) * f64::from(n) / 200.0))
            .filter(|p| (y.0..=y.1).contains(&p.1))
            .collect();
        chart.draw_series(DashedLineSeries::new(path, 4, 8, FAINT.stroke_width(2)))?;
    }
    for line in lines {
        curve(&mut chart, line)?;
    }
    root.present()?;
    drop(chart);
    drop(root);
    Ok(())
}

fn curve(chart: &mut Chart<'_, '_>, line: &Line) -> Drawn {
    let Look { color, mark, dashed } = line.look;
    let path: Vec<(f64, f64)> = line.points.iter().map(|p| (p.0, p.1)).collect();
    let stroke = color.stroke_width(3);
    if dashed {
        chart.draw_series(DashedLineSeries::new(path.iter().copied(), 14, 8, stroke))?;
    } else {
        chart.draw_series(LineSeries::new(path.iter().copied(), stroke))?;
    }
    for &(x, y, front) in &line.points {
        let place = || EmptyElement::at((x, y));
        chart.draw_series([place() + Polygon::new(outline(mark), color.filled())])?;
        if front {
            chart.draw_series([place() + Circle::new((0, 0), RING, BLACK.stroke_width(3))])?;
        }
    }
    Ok(())
}

/// Outline of a mark around the origin, pixels.
fn outline(mark: Mark) -> Vec<(i32, i32)> {
    let m = MARK;
    match mark {
        Mark::Circle => (0..24)
            .map(|n| libm::sincos(std::f64::consts::TAU * f64::from(n) / 24.0))
            .map(|(s, c)| ((f64::from(m) * c).round() as i32, (f64::from(m) * s).round() as i32))
            .collect(),
        Mark::Square => vec![(-m, -m), (m, -m), (m, m), (-m, m)],
        Mark::Diamond => vec![(0, -m - 3), (m + 3, 0), (0, m + 3), (-m - 3, 0)],
        Mark::Triangle => vec![(0, -m - 3), (m + 2, m), (-m - 2, m)],
        Mark::Cross => {
            let (a, b) = (m + 2, 4);
            // Twelve corners of a cross along the diagonals.
            let arm = [(0, -b), (a - b, -a), (a, b - a), (b, 0)];
            let turned = |n: i32| arm.into_iter().take(3).map(move |p| (0..n).fold(p, |(x, y), _| (-y, x)));
            (0..4).flat_map(turned).collect()
        }
    }
}

/// The outline of a mark as the `points` of an SVG polygon.
pub(super) fn outline_points(mark: Mark) -> String {
    outline(mark).iter().map(|(x, y)| format!("{x},{y} ")).collect()
}

/// Room beyond the outermost points, in decades.
const ROOM: f64 = 0.08;

/// An axis spans this many decades at least.
const LEAST_SPAN: f64 = 0.4;

/// The range of an axis, in decades, that holds some values.
fn extent(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let room = ROOM.max(0.5 * (LEAST_SPAN - (high - low))).max(0.06 * (high - low));
    (low - room, high + room)
}

/// Where an axis over decades has its labels: at the most of some round numbers in each decade
/// that leave few enough labels.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    const MOST: usize = 7;
    let at = |mantissas: &[f64]| -> Vec<f64> {
        let decades = (low.floor() as i32)..=(high.ceil() as i32);
        let all = decades.flat_map(|d| mantissas.iter().map(move |m| f64::from(d) + libm::log10(*m)));
        all.filter(|tick| (low..=high).contains(tick)).collect()
    };
    let choices = [at(&[1.0, 1.5, 2.0, 3.0, 5.0, 7.0]), at(&[1.0, 2.0, 5.0]), at(&[1.0, 3.0])];
    choices.into_iter().find(|ticks| ticks.len() <= MOST).unwrap_or_else(|| at(&[1.0]))
}

/// A tick's value, which has one or two digits that matter.
fn number(value: f64) -> String {
    let digits = (1 - libm::log10(value).floor() as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn ticks_are_few_and_round() {
        let values = |low: f64, high: f64| {
            ticks(libm::log10(low), libm::log10(high))
                .into_iter()
                .map(|t| number(libm::exp10(t)))
                .collect::<Vec<_>>()
        };
        assert_eq!(values(0.9, 6.0), ["1", "1.5", "2", "3", "5"]);
        assert_eq!(values(0.02, 1.1), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(values(0.0009, 0.011), ["0.001", "0.0015", "0.002", "0.003", "0.005", "0.007", "0.01"]);
        assert_eq!(values(9.0, 20_000.0), ["10", "30", "100", "300", "1000", "3000", "10000"]);
        for span in 1..60 {
            let high = libm::pow(10.0, f64::from(span) * 0.1);
            let count = values(0.013, 0.013 * 2.0 * high).len();
            assert!((1..=8).contains(&count), "{count} over {span} tenths of a decade");
        }
    }

    #[test]
    fn a_chart_shows_labels_and_rings_and_leaves_out_zeros() {
        let look = Look { color: RED, mark: Mark::Cross, dashed: false };
        let line = Line { look, points: vec![(1.0, 0.1, true), (10.0, 0.01, false), (5.0, 0.0, true)] };
        let svg = log_log(["size, kB", "error, %"], std::slice::from_ref(&line), &[]).unwrap().unwrap();
        assert!(svg.contains("size, kB") && svg.contains("error, %") && !svg.contains("NaN"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 1, "one ring");
        assert_eq!(svg.matches("<polygon").count(), 2, "two marks");
        let nothing = Line { points: vec![(0.0, 1.0, true)], ..line };
        assert_eq!(log_log(["a", "b"], &[nothing], &[]).unwrap(), None);
    }

    #[test]
    fn one_point_has_axes_too() {
        let look = Look { color: RED, mark: Mark::Circle, dashed: true };
        let svg = log_log(["a", "b"], &[Line { look, points: vec![(3.0, 3.0, false)] }], &[]).unwrap();
        assert!(svg.unwrap().matches("<text").count() >= 4);
    }
}
