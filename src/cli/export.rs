//! `qsplat export`: triangles for other tools.

use std::path::PathBuf;

use clap::Args;
use qsplat::error::Result;
use qsplat::export::ply;
use qsplat::format;
use qsplat::tolerance::EXPORT_SHARE;

use super::{Outcome, source};

/// Writes the splats of a .qsplat as triangles: a binary PLY with the splat of each face.
///
/// The triangles stay within a share of the file's error budget of the splats and of their clip
/// curves, which the PLY's header names. Faces carry the property `splat`, the number of the splat
/// in the file.
#[derive(Args)]
pub(super) struct Arguments {
    /// The .qsplat
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The triangles, a PLY
    #[arg(short, long, value_name = "OUT.ply")]
    output: PathBuf,
    /// How far the triangles may stray, a share of the file's error budget, 0.001 to 1. A tenth of
    /// it takes about ten times the triangles
    #[arg(long, value_name = "SHARE", default_value_t = EXPORT_SHARE, value_parser = share)]
    tolerance: f64,
}

fn share(text: &str) -> std::result::Result<f64, String> {
    let share: f64 = text.parse().map_err(|_| "give a share of the error budget, such as 0.1".to_owned())?;
    ply::checked(share).map_err(|error| error.to_string())
}

impl Arguments {
    pub(super) fn run(self) -> Result<Outcome> {
        let asset = source::asset(&self.file)?;
        format::write_file(&self.output, &ply::encode(&asset, self.tolerance)?)?;
        Ok(Outcome::text(""))
    }
}
