//! `bake`: the whole program, from file to file, in a process of its own, which gives its peak
//! memory. Floor: the neighbour pass.

use std::path::{Path, PathBuf};
use std::process::Command;

use criterion::Criterion;
use qsplat::report::{Report, Run};
use qsplat::{Error, Result};
use serde_json::json;

use crate::harness::{affordable, beside_timed, scratch};
use crate::notes::Notes;
use crate::{cloud, floor};

pub fn bench(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    for points in affordable() {
        let input = cloud::file(points)?;
        let mut runs = Vec::new();
        let mut failure = None;
        let seconds = || match program(&input) {
            Ok(run) => {
                let seconds = run.wall_seconds;
                runs.push(run);
                seconds
            }
            Err(error) => {
                failure = Some(error);
                0.0
            }
        };
        let positions = cloud::cloud(points).positions;
        beside_timed(criterion, "bake", points, seconds, || floor::neighbour_pass(&positions));
        if let Some(error) = failure {
            return Err(error);
        }
        if !runs.is_empty() {
            let peak = median(runs.iter().filter_map(|run| run.peak_bytes).map(|bytes| bytes as f64));
            let cores = median(runs.iter().map(|run| run.cpu_seconds / run.wall_seconds));
            notes.add("bake", points, json!({ "peak_bytes": peak, "cores": cores }));
        }
    }
    Ok(())
}

/// Bakes a file by the program at its defaults; what its report says of the run.
fn program(input: &Path) -> Result<Run> {
    let (output, report): (PathBuf, PathBuf) = (scratch("bench.qsplat"), scratch("bench.json"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_qsplat"));
    command.arg("bake").arg(input).arg("-o").arg(&output).arg("--report").arg(&report).arg("--quiet");
    let done = command.output().map_err(Error::io(input))?;
    if !done.status.success() {
        return Err(Error::Internal(String::from_utf8_lossy(&done.stderr).into_owned()));
    }
    let bytes = std::fs::read(&report).map_err(Error::io(&report))?;
    let report: Report = serde_json::from_slice(&bytes)
        .map_err(|error| Error::Internal(format!("the report cannot be read: {error}")))?;
    report.run.ok_or_else(|| Error::Internal("the report says nothing of the run".into()))
}

/// The middle value, `None` of none.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
