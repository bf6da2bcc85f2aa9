//! `qsplat info`: what a file holds.

use std::path::PathBuf;

use clap::Args;
use qsplat::error::Result;
use qsplat::format;
use qsplat::report::{File, Report};

use super::Outcome;

/// Says what a .qsplat holds: splats by kind, bytes by chunk, the error it keeps.
#[derive(Args)]
pub(super) struct Arguments {
    /// The .qsplat
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The report as JSON instead of a table (docs/report-schema.md)
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Outcome> {
        let limits = format::Limits::default();
        let asset = format::read_file(&self.file, &limits)?;
        let info = format::inspect(&format::read_bytes(&self.file, &limits)?, &limits)?;
        let report = Report::new(&asset, File::new(&self.file, &info), None);
        Ok(Outcome::text(if self.json { report.json()? } else { report.table() }))
    }
}
