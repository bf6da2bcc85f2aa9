//! One case: bake, measure, time, draw.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use super::plan::Setting;
use super::schema::{Case, Outcome};
use crate::bake::noise::input_noise;
use crate::bake::{Edges, Kept, Options, Silent, feature_lines, kept, model_error};
use crate::deliver::{deliver, model, surface};
use crate::error::{Error, Result};
use crate::ingest::Input;
use crate::measure::{self, Reference, measure};
use crate::model::asset::Asset;
use crate::model::frame::Frame;
use crate::render::camera::{Framing, View};
use crate::render::{Camera, Settings, Show, cpu, input};
use crate::report::{self, png};

/// Width and height of the frames that are timed.
pub(super) const FRAME_SIZE: [u32; 2] = [512, 512];

/// Width and height of the pictures: small, since the page holds two a case.
const PICTURE_SIZE: [u32; 2] = [280, 280];

/// The view of [`crate::measure::views`] that the pictures show: the model fills it.
const PICTURE_VIEW: &str = "right-top-front";

/// An input as its cases share it.
pub(super) struct Subject<'a> {
    pub(super) input: &'a Input,
    pub(super) edges: Edges,
    /// What every case is measured against.
    pub(super) reference: Reference<'a>,
    /// From where the pictures of the page are drawn.
    pub(super) camera: Camera,
}

/// An input without the outliers of a cloud, which every case leaves out. Which points they are hardly
/// depends on the bound: that of a bake at defaults stands for all.
///
/// # Errors
/// Those of [`kept`], and of [`model_error`] for a cloud.
pub(super) fn without_outliers<'a>(input: &'a Input, edges: &Edges) -> Result<Kept<'a>> {
    let options = Options::default();
    let max_error = match input {
        Input::Mesh(_) => 0.0,
        Input::Cloud(_) => model_error(&options, input)?,
    };
    kept(input, edges, input_noise(input), &options, max_error)
}

impl<'a> Subject<'a> {
    /// # Errors
    /// As [`Reference::new`].
    pub(super) fn new(input: &'a Input, kept: &'a Kept<'a>, edges: Edges) -> Result<Self> {
        let whole = Reference::standing_for(surface(kept), model(input).diagonal())?;
        let reference = Reference { outliers: kept.outliers, ..whole };
        let view = reference.views().find(|view| view.name == PICTURE_VIEW);
        let iso = || iso(&input.cloud().frame, reference.model.diagonal(), PICTURE_SIZE);
        let camera = view.map_or_else(iso, |view| view.camera);
        Ok(Self { input, edges, reference, camera })
    }
}

/// PNGs of a case: shaded, and each splat in a colour of its own.
pub(super) type Pictures = [Vec<u8>; 2];

/// Runs a case. Whatever goes wrong is its message: the other cases go on.
pub(super) fn run(subject: &Subject<'_>, setting: &Setting, frames: usize) -> (Case, Option<Pictures>) {
    let outcome = catch_unwind(AssertUnwindSafe(|| outcome(subject, setting, frames)));
    // A panic is a bug of ours, and has been told by the program's hook.
    let outcome = outcome.unwrap_or_else(|_| Err(Error::Internal("the case panicked".into())));
    let (outcome, failure, pictures) = match outcome {
        Ok((outcome, pictures)) => (Some(outcome), None, Some(pictures)),
        Err(error) => (None, Some(error.to_string()), None),
    };
    let case = Case {
        variant: setting.variant.name().into(),
        max_error: setting.max_error.to_string(),
        effort: setting.effort,
        failure,
        outcome,
        fronts: Vec::new(),
    };
    (case, pictures)
}

fn outcome(subject: &Subject<'_>, setting: &Setting, frames: usize) -> Result<(Outcome, Pictures)> {
    let options = Options { edges: subject.edges.clone(), ..setting.options() };
    let delivery = deliver(subject.input, &options, &mut Silent)?;
    let run = report::Run::of_stages(delivery.stages, rayon::current_num_threads());
    let lines = feature_lines(
        subject.input,
        &options.edges,
        delivery.baked.noise,
        options.edge_angle,
        delivery.asset.max_error,
    )?;
    let measures = measure(&measure::Subject {
        bytes: &delivery.bytes,
        asset: &delivery.asset,
        against: &subject.reference,
        lines: lines.as_deref(),
    })?;
    let outcome = Outcome {
        bake_seconds: run.wall_seconds,
        bake_cpu_seconds: run.cpu_seconds,
        stages: run.stages,
        frame_ms: frame_ms(&delivery.asset, frames)?,
        measures,
    };
    let picture = |show| draw_asset(&delivery.asset, &subject.camera, show);
    let pictures = [picture(Show::Shaded)?, picture(Show::Splats)?];
    Ok((outcome, pictures))
}

/// Milliseconds of one frame on the CPU reference: the median.
fn frame_ms(asset: &Asset, frames: usize) -> Result<f64> {
    let camera = iso(&asset.frame, asset.diagonal, FRAME_SIZE);
    let mut times = Vec::with_capacity(frames);
    for _ in 0..frames {
        let start = Instant::now();
        let picture = cpu::render(asset, &camera, &Settings::plain(FRAME_SIZE))?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        std::hint::black_box(picture);
    }
    times.sort_by(f64::total_cmp);
    Ok(median(&times))
}

/// The middle of sorted numbers, the mean of the middle two of an even count; 0 of none.
fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => 0.0,
        count if count % 2 == 1 => sorted[middle],
        _ => 0.5 * (sorted[middle - 1] + sorted[middle]),
    }
}

fn iso(frame: &Frame, diagonal: f64, size: [u32; 2]) -> Camera {
    Camera::framing(frame, diagonal, View::Iso, Framing::default(), size)
}

fn draw_asset(asset: &Asset, camera: &Camera, show: Show) -> Result<Vec<u8>> {
    let settings = Settings { size: PICTURE_SIZE, show, ..Settings::default() };
    png::encode(&cpu::render(asset, camera, &settings)?.rgba)
}

/// The input, drawn as its bakes are.
pub(super) fn draw_input(subject: &Subject<'_>) -> Result<Vec<u8>> {
    let settings = Settings { size: PICTURE_SIZE, ..Settings::default() };
    let picture = input::render(model(subject.input), &subject.camera, &settings, &input::Style::default())?;
    png::encode(&picture.rgba)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        for (sorted, expected) in [(&[][..], 0.0), (&[3.0], 3.0), (&[1.0, 2.0], 1.5), (&[1.0, 2.0, 9.0], 2.0)]
        {
            assert!((median(sorted) - expected).abs() < 1e-15);
        }
    }
}
