//! Reading what the user names.

use std::io::Read;
use std::path::Path;

use qsplat::bake::Edges;
use qsplat::error::{Error, Result};
use qsplat::format;
use qsplat::ingest::{self, Input};
use qsplat::model::asset::Asset;

/// Whether a file begins as a `.qsplat` does.
pub(super) fn is_qsplat(path: &Path) -> Result<bool> {
    let mut start = Vec::new();
    let file = std::fs::File::open(path).map_err(Error::io(path))?;
    file.take(format::MAGIC.len() as u64).read_to_end(&mut start).map_err(Error::io(path))?;
    Ok(start == format::MAGIC)
}

/// Says of a file what cannot be done with it as asked.
pub(super) fn of(path: &Path) -> impl Fn(Error) -> Error {
    move |error| match error {
        Error::Usage(what) => Error::Usage(format!("{}: {what}", path.display())),
        other => other,
    }
}

/// Reads a mesh or cloud.
pub(super) fn input(path: &Path) -> Result<Input> {
    ingest::read(path, &ingest::Limits::default())
}

/// Reads a `.qsplat`.
pub(super) fn asset(path: &Path) -> Result<Asset> {
    format::read_file(path, &format::Limits::default())
}

/// Feature lines as `--edges` names them: `auto`, `none` or a file.
pub(super) fn edges(name: &str) -> Result<Edges> {
    Ok(match name {
        "auto" => Edges::Auto,
        "none" => Edges::None,
        path => Edges::Given(ingest::read_edges(path.as_ref(), &ingest::Limits::default())?),
    })
}
