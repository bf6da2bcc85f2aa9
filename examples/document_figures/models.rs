//! The models, or what stands in for them.

use std::path::{Path, PathBuf};

use qsplat::bake::{Edges, Options};
use qsplat::ingest::{Input, Limits, read, read_edges};
use qsplat::model::polyline::Polylines;
use qsplat::{Error, Result};

/// A model and what to call it.
pub struct Model {
    /// What it is called in a table.
    pub name: String,
    /// The mesh.
    pub input: Input,
    /// Its feature lines, where they are known.
    pub lines: Option<Polylines>,
}

impl Model {
    /// The program's defaults, with the model's lines where they are known.
    pub fn options(&self) -> Options {
        let edges = self.lines.clone().map_or(Edges::Auto, Edges::Given);
        Options { edges, ..Options::default() }
    }
}

/// CAD parts: the fixtures', and the document's Fandisk from the user's folder.
///
/// # Errors
/// As [`read`].
pub fn parts() -> Result<Vec<Model>> {
    let mut parts = vec![fixture("capped-cylinder.ply")?, fixture("plate.ply")?, fixture("part.ply")?];
    parts.extend(external("fandisk.obj")?);
    Ok(parts)
}

/// Parts whose edges bend: the fixtures', and two of the user's folder.
///
/// # Errors
/// As [`read`].
pub fn edged() -> Result<Vec<Model>> {
    let mut models = vec![fixture("part.ply")?];
    for file in ["fandisk.obj", "abc-00000049.obj"] {
        models.extend(external(file)?);
    }
    Ok(models)
}

/// A model of the user's folder, or `stand_in` of the fixtures where there is none.
///
/// # Errors
/// As [`read`], for the stand-in.
pub fn or_fixture(file: &str, stand_in: &str) -> Result<Model> {
    match external(file)? {
        Some(model) => Ok(model),
        None => fixture(stand_in),
    }
}

/// A model of the user's folder; `None`, with a word on standard error, where it is missing.
///
/// # Errors
/// As [`read`].
// What is left out must be said.
#[allow(clippy::print_stderr)]
pub fn external(file: &str) -> Result<Option<Model>> {
    let path = std::env::var_os("QSPLAT_MODELS").map(|folder| PathBuf::from(folder).join(file));
    match path {
        Some(path) if path.exists() => model(&path, file).map(Some),
        _ => {
            eprintln!("LEFT OUT: {file} (QSPLAT_MODELS names no folder that holds it)");
            Ok(None)
        }
    }
}

/// A model of the repository.
///
/// # Errors
/// As [`read`].
pub fn fixture(file: &str) -> Result<Model> {
    model(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(file), file)
}

fn model(path: &Path, file: &str) -> Result<Model> {
    let limits = Limits::default();
    let stem = file.split('.').next().unwrap_or(file);
    let beside = ["edges", "features"].map(|kind| path.with_file_name(format!("{stem}.{kind}.obj")));
    let lines = beside.iter().find(|lines| lines.exists());
    let lines = lines.map(|lines| read_edges(lines, &limits)).transpose()?;
    Ok(Model { name: stem.to_owned(), input: read(path, &limits)?, lines })
}

/// The triangles of a model.
///
/// # Errors
/// [`Error::Usage`] where it is a cloud.
pub fn mesh(model: &Model) -> Result<&qsplat::model::mesh::Mesh> {
    match &model.input {
        Input::Mesh(mesh) => Ok(mesh),
        Input::Cloud(_) => Err(Error::Usage(format!("{}: a mesh is wanted, not a cloud", model.name))),
    }
}
