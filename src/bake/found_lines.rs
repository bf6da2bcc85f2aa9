//! The feature lines of a mesh or cloud as polylines.

use glam::DVec3;

use super::lines::{feature_lines, input_lines};
use super::model_error;
use super::noise::input_noise;
use super::options::{Edges, Options};
use crate::error::Result;
use crate::ingest::Input;
use crate::ingest::chain::chain;
use crate::model::polyline::{Polylines, straightened};

/// Points nearer than this to the line between others, model units, are left out: they halve
/// straight edges of the mesh, up to the rounding of 32 bits.
const STRAIGHT: f64 = 3e-7;

/// A line that turns by more than this (cosine of 45°) has a corner there, and ends.
const CORNER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The feature lines that a bake with these options finds, a mesh's borders among them: polylines
/// that end where not two meet and at corners. A cloud's may end inside its surface as well.
///
/// # Errors
/// [`Error::Usage`](crate::Error::Usage) for options out of range.
pub fn found_lines(input: &Input, options: &Options) -> Result<Polylines> {
    let frame = input.cloud().frame;
    let max_error = model_error(options, input)?;
    let found = feature_lines(input, &Edges::Auto, input_noise(input), options.edge_angle, max_error)?
        .unwrap_or_default();
    let lines = match input {
        Input::Mesh(_) => cornered(&joined(&found)).iter().map(|line| straightened(line, STRAIGHT)).collect(),
        Input::Cloud(_) => joined(&found),
    };
    Ok(input_lines(&lines, &frame))
}

/// Segments joined where exactly two meet.
fn joined(segments: &[Vec<DVec3>]) -> Vec<Vec<DVec3>> {
    // Adding zero turns -0 into 0: they are one place.
    let bits = |place: &DVec3| (*place + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut places: Vec<[u64; 3]> = segments.iter().flatten().map(bits).collect();
    places.sort_unstable();
    places.dedup();
    let number = |place: &DVec3| places.partition_point(|other| *other < bits(place)) as u32;
    let edges: Vec<[u32; 2]> = segments
        .iter()
        .flat_map(|line| line.windows(2).map(|pair| [number(&pair[0]), number(&pair[1])]))
        .collect();
    let place = |n: u32| DVec3::from_array(places[n as usize].map(f64::from_bits));
    chain(&edges).into_iter().map(|line| line.into_iter().map(place).collect()).collect()
}

/// Lines cut where they turn sharply.
fn cornered(lines: &[Vec<DVec3>]) -> Vec<Vec<DVec3>> {
    let mut cut = Vec::new();
    for line in lines {
        let mut from = 0;
        for at in 1..line.len() - 1 {
            let [before, after] =
                [line[at] - line[at - 1], line[at + 1] - line[at]].map(DVec3::normalize_or_zero);
            if before.dot(after) < CORNER {
                cut.push(line[from..=at].to_vec());
                from = at;
            }
        }
        cut.push(line[from..].to_vec());
    }
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_of_a_square_become_its_four_sides() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.5));
        let mut segments = Vec::new();
        for n in 0..4 {
            let (a, b) = (corners[n], corners[(n + 1) % 4]);
            let at = |k: u32| a.lerp(b, f64::from(k) / 8.0);
            segments.extend((0..8).map(|k| vec![at(k + 1), at(k)]));
        }
        let lines: Vec<Vec<DVec3>> =
            cornered(&joined(&segments)).iter().map(|line| straightened(line, STRAIGHT)).collect();
        // A loop has no end; the walk begins at its least place, a corner.
        assert_eq!(lines.len(), 4, "{lines:?}");
        for line in &lines {
            assert!(line.len() == 2 && corners.contains(&line[0]) && corners.contains(&line[1]), "{line:?}");
        }
    }

    #[test]
    fn a_circle_keeps_its_points() {
        let at = |n: i32| {
            let (sin, cos) = (0.01 * std::f64::consts::TAU * f64::from(n % 100)).sin_cos();
            DVec3::new(cos, sin, 0.0)
        };
        let segments: Vec<Vec<DVec3>> = (0..100).map(|n| vec![at(n), at(n + 1)]).collect();
        let lines = cornered(&joined(&segments));
        assert_eq!((lines.len(), straightened(&lines[0], STRAIGHT).len()), (1, 101));
    }
}
