//! `qsplat report`: budgets and efforts swept over some inputs.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;

use clap::Args;
use qsplat::bake::MaxError;
use qsplat::error::{Error, Result};
use qsplat::sweep::{self, Case, Event, Lines, Plan};

use super::progress::Style;
use super::{Notes, Outcome};

/// Bakes inputs at many budgets and efforts, measures each, and shows error against cost.
///
/// Writes report.json (docs/sweep-schema.md), report.csv and report.html, a page that needs no
/// network: curves, tables, stage times, bytes by chunk and pictures. Every budget is baked at
/// every effort; for comparison also from planes alone and, where splats are cut, with chords
/// alone, both at the middle effort. The bound alone rules, as in `bake --holes leave`. A bake that fails
/// is kept as such, and ends in exit code 1.
#[derive(Args)]
pub(super) struct Arguments {
    /// Meshes or clouds: PLY, OBJ, OFF, glTF, GLB
    #[arg(value_name = "INPUT", required = true)]
    inputs: Vec<PathBuf>,
    /// The directory to write into
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Error budgets, as those of `bake`, apart by commas
    #[arg(long, value_name = "LIST", default_value = "1%,0.3%,0.1%,0.03%")]
    max_errors: List<MaxError>,
    /// Efforts, 1 (fastest) to 9 (fewest bytes), apart by commas
    #[arg(long, value_name = "LIST", default_value = "1,5,9")]
    efforts: List<u8>,
    /// Frames drawn on the CPU for a frame time, which is their median
    #[arg(long, value_name = "N", default_value_t = Plan::default().frames)]
    frames: usize,
    /// Cases at a time. Times can be compared only where each case runs alone
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
    /// Feature lines: `auto` finds them on a mesh; `beside` takes NAME.features.obj,
    /// NAME.edges.obj or NAME.edges.ply beside an input NAME.*, and finds them where there is
    /// none; a file is for a single input
    #[arg(long, value_name = "auto|none|beside|FILE", default_value = "auto", value_parser = lines)]
    edges: Lines,
    /// How to tell the progress, on standard error
    #[arg(long, value_enum, default_value_t)]
    progress: Style,
}

/// Values apart by commas.
#[derive(Clone, Debug)]
struct List<T>(Vec<T>);

impl<T: FromStr<Err: std::fmt::Display>> FromStr for List<T> {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let one = |part: &str| part.trim().parse().map_err(|error: T::Err| format!("`{part}`: {error}"));
        text.split(',').map(one).collect::<std::result::Result<_, _>>().map(Self)
    }
}

fn lines(text: &str) -> std::result::Result<Lines, std::convert::Infallible> {
    Ok(match text {
        "auto" => Lines::Auto,
        "none" => Lines::None,
        "beside" => Lines::Beside,
        path => Lines::File(path.into()),
    })
}

impl Arguments {
    pub(super) fn run(self, notes: &mut Notes<'_>) -> Result<Outcome> {
        let plan = Plan {
            max_errors: self.max_errors.0,
            efforts: self.efforts.0,
            lines: self.edges,
            frames: self.frames,
            jobs: self.jobs,
        };
        if plan.jobs > 1 {
            notes.note("with more than one job the times of the cases cannot be compared");
        }
        let style = if notes.quiet { Style::None } else { self.progress };
        let start = Instant::now();
        let out = &mut *notes.out;
        let mut watch = |event: &Event<'_>| {
            // A closed standard error must not stop the work.
            let _ = match style {
                Style::None => Ok(()),
                Style::Json => writeln!(out, "{}", json(event, start.elapsed().as_secs_f64())),
                Style::Auto | Style::Plain => {
                    writeln!(out, "{:8.1} s  {}", start.elapsed().as_secs_f64(), plain(event))
                }
            };
        };
        // What cannot be written should be known before the work, and what is done be kept.
        std::fs::create_dir_all(&self.output).map_err(Error::io(&self.output))?;
        let mut written = Ok(self.output.clone());
        let swept = sweep::run(&self.inputs, &plan, &mut |event| match event {
            Event::Finished(so_far) => written = so_far.write(&self.output),
            event => watch(event),
        })?;
        let page = written?;
        let failures = swept.sweep.failures();
        let cases: usize = swept.sweep.models.iter().map(|model| model.cases.len()).sum();
        let text = format!("{}: {cases} bakes, {failures} failed\n", page.display());
        Ok(Outcome { text, passed: failures == 0 })
    }
}

fn plain(event: &Event<'_>) -> String {
    match event {
        Event::Reading(path) => format!("{}", path.display()),
        Event::Finished(swept) => format!("{} inputs done", swept.sweep.models.len()),
        Event::Began(model, what) => format!("{model}: {what} ..."),
        Event::Ended { model, case, done, total } => {
            format!(
                "{model}: {}, {}, effort {} [{done}/{total}]: {}",
                case.variant,
                case.max_error,
                case.effort,
                came_to(case)
            )
        }
    }
}

fn came_to(case: &Case) -> String {
    match (&case.outcome, &case.failure) {
        (Some(outcome), _) => {
            let (cost, measures) = (&outcome.measures.cost, &outcome.measures);
            format!(
                "{:.2} s, {} bytes, {} splats, fit max {:.2e}, backward max {:.2e}, FLIP {:.4}",
                outcome.bake_seconds,
                cost.bytes,
                cost.splats,
                measures.fit.max,
                measures.backward.max,
                measures.image.flip_mean
            )
        }
        (None, failure) => format!("FAILED: {}", failure.as_deref().unwrap_or("no outcome")),
    }
}

fn json(event: &Event<'_>, seconds: f64) -> serde_json::Value {
    match event {
        Event::Reading(path) => {
            serde_json::json!({ "event": "input", "path": path.display().to_string(), "seconds": seconds })
        }
        Event::Finished(swept) => {
            serde_json::json!({ "event": "finished", "inputs": swept.sweep.models.len(), "seconds": seconds })
        }
        Event::Began(model, what) => {
            serde_json::json!({ "event": "case", "model": model, "case": what, "seconds": seconds })
        }
        Event::Ended { model, case, done, total } => serde_json::json!({
            "event": "ended", "model": model, "variant": case.variant, "max_error": case.max_error,
            "effort": case.effort, "failure": case.failure, "done": done, "total": total, "seconds": seconds
        }),
    }
}
