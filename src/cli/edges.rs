//! `qsplat edges`: the feature lines of a mesh or cloud.

use std::path::PathBuf;

use clap::Args;
use qsplat::bake::{MaxError, Options, found_lines, model_error, model_lines};
use qsplat::error::{Error, Result};
use qsplat::export::lines::obj;
use qsplat::format;
use qsplat::ingest::{self, Input};
use qsplat::measure::recall::share_near;
use qsplat::model::polyline::{Polylines, is_closed};
use qsplat::tolerance::DEFAULT_EDGE_ANGLE;
use serde::Serialize;

use super::{Outcome, bake, source};

/// Finds feature lines as `bake --edges auto` takes them: the sharp edges and borders of a mesh, the
/// creases of a cloud.
///
/// docs/edges-schema.md says what the JSON means.
#[derive(Args)]
pub(super) struct Arguments {
    /// A mesh or cloud: PLY, OBJ, OFF, glTF, GLB
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// The lines, an OBJ with `l` records that `bake --edges` reads
    #[arg(short, long, value_name = "OUT.obj")]
    output: PathBuf,
    /// Dihedral angle from which an edge is a feature edge, and angle by which the surface of a cloud
    /// turns at a crease, degrees
    #[arg(long, value_name = "DEG", default_value_t = DEFAULT_EDGE_ANGLE, value_parser = bake::edge_angle)]
    edge_angle: f64,
    /// The error bound of the bake that the lines are for, as there: creases lower than it, and lines
    /// shorter than a few of it, are left out
    #[arg(long, value_name = "0.1%|0.002", default_value_t, allow_hyphen_values = true)]
    max_error: MaxError,
    /// True lines: tells how much of what was found lies along them (precision), and how much of
    /// them was found (recall), within the error bound
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// What was found. Lengths in input units, shares of lengths.
#[derive(Serialize)]
struct Found {
    schema: &'static str,
    lines: usize,
    closed: usize,
    segments: usize,
    length: f64,
    precision: Option<f64>,
    recall: Option<f64>,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Outcome> {
        let input = source::input(&self.input)?;
        let options =
            Options { edge_angle: self.edge_angle, max_error: self.max_error, ..Options::default() };
        let lines = found_lines(&input, &options).map_err(source::of(&self.input))?;
        let compared = match &self.against {
            Some(path) => {
                let truth = ingest::read_edges(path, &ingest::Limits::default())?;
                Some(compared(&input, &options, &lines, &truth)?)
            }
            None => None,
        };
        format::write_file(&self.output, obj(&lines).as_bytes())?;
        let found = Found {
            schema: "qsplat-edges/1",
            lines: lines.lines.len(),
            closed: lines.lines.iter().filter(|line| is_closed(line)).count(),
            segments: lines.segments(),
            length: lines.length(),
            precision: compared.map(|shares| shares[0]),
            recall: compared.map(|shares| shares[1]),
        };
        if self.json {
            let text = serde_json::to_string_pretty(&found).map_err(|e| Error::Internal(e.to_string()))?;
            return Ok(Outcome::text(text + "\n"));
        }
        Ok(Outcome::text(found.table()))
    }
}

/// Precision and recall, within the error bound.
fn compared(input: &Input, options: &Options, found: &Polylines, truth: &Polylines) -> Result<[f64; 2]> {
    let within = model_error(options, input)?;
    let [found, truth] = [found, truth].map(|lines| model_lines(lines, &input.cloud().frame));
    Ok([share_near(&found, &truth, within), share_near(&truth, &found, within)])
}

impl Found {
    fn table(&self) -> String {
        let Self { lines, closed, segments, length, .. } = self;
        let mut text = format!(
            "lines         {lines}, {closed} of them closed\nsegments      {segments}\nlength        {length:.6} input units\n"
        );
        if let (Some(precision), Some(recall)) = (self.precision, self.recall) {
            text +=
                &format!("precision     {:.1} %\nrecall        {:.1} %\n", 100.0 * precision, 100.0 * recall);
        }
        text
    }
}
