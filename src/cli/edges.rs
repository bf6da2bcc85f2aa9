//! `qsplat edges`: the feature lines of a mesh.

use std::path::PathBuf;

use clap::Args;
use glam::DVec3;
use qsplat::bake::{MaxError, Options, found_lines};
use qsplat::deliver::model;
use qsplat::error::{Error, Result};
use qsplat::export::lines::obj;
use qsplat::format;
use qsplat::ingest::{self, Input};
use qsplat::measure::recall::share_near;
use qsplat::model::polyline::Polylines;
use qsplat::tolerance::DEFAULT_EDGE_ANGLE;
use serde::Serialize;

use super::{Outcome, bake, source};

/// Finds the feature lines of a mesh: sharp edges and borders, as `bake --edges auto` takes them.
///
/// docs/edges-schema.md says what the JSON means.
#[derive(Args)]
pub(super) struct Arguments {
    /// A mesh: PLY, OBJ, OFF, glTF, GLB
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// The lines, an OBJ with `l` records that `bake --edges` reads
    #[arg(short, long, value_name = "OUT.obj")]
    output: PathBuf,
    /// Dihedral angle from which an edge is a feature edge, degrees
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
        let lines = found_lines(&input, &options).map_err(|error| match error {
            Error::Usage(what) => Error::Usage(format!("{}: {what}", self.input.display())),
            other => other,
        })?;
        let compared = match &self.against {
            Some(path) => {
                Some(self.compared(&input, &lines, &ingest::read_edges(path, &ingest::Limits::default())?))
            }
            None => None,
        };
        format::write_file(&self.output, obj(&lines).as_bytes())?;
        let length = |line: &Vec<DVec3>| line.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
        let found = Found {
            schema: "qsplat-edges/1",
            lines: lines.lines.len(),
            closed: lines.lines.iter().filter(|line| line.len() > 2 && line.first() == line.last()).count(),
            segments: lines.segments(),
            length: lines.lines.iter().map(length).fold(0.0, |sum, length| sum + length),
            precision: compared.map(|shares| shares[0]),
            recall: compared.map(|shares| shares[1]),
        };
        if self.json {
            let text = serde_json::to_string_pretty(&found).map_err(|e| Error::Internal(e.to_string()))?;
            return Ok(Outcome::text(text + "\n"));
        }
        Ok(Outcome::text(found.table()))
    }

    /// Precision and recall.
    fn compared(&self, input: &Input, found: &Polylines, truth: &Polylines) -> [f64; 2] {
        let frame = input.cloud().frame;
        let in_model = |lines: &Polylines| -> Vec<Vec<DVec3>> {
            lines.lines.iter().map(|line| line.iter().map(|&p| frame.to_model(p)).collect()).collect()
        };
        let within = match self.max_error {
            MaxError::Relative(share) => share * model(input).diagonal(),
            MaxError::Absolute(length) => length / frame.scale(),
        };
        let (found, truth) = (in_model(found), in_model(truth));
        [share_near(&found, &truth, within), share_near(&truth, &found, within)]
    }
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
