//! `qsplat export`: triangles for other tools.

use std::path::PathBuf;

use clap::Args;
use qsplat::error::Result;
use qsplat::{export, format};

use super::{Outcome, source};

/// Writes the splats of a .qsplat as triangles: a binary PLY with the splat of each face.
///
/// The triangles stay within a tenth of the file's error budget of the splats and of their clip
/// curves. Faces carry the property `splat`, the number of the splat in the file.
#[derive(Args)]
pub(super) struct Arguments {
    /// The .qsplat
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The triangles, a PLY
    #[arg(short, long, value_name = "OUT.ply")]
    output: PathBuf,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Outcome> {
        let asset = source::asset(&self.file)?;
        format::write_file(&self.output, &export::ply::encode(&asset)?)?;
        Ok(Outcome::text(""))
    }
}
