//! Every fixture: its name and its bytes.
//!
//! A model file gives a formula and a few sizes; `curve`, `planar`, `ruled` and `geodesic` turn
//! them into one welded `surface`; `ply`, `obj` and `glb` write it. Nothing here depends on the
//! machine: every transcendental function comes from `libm`.

pub mod curve;
mod geodesic;
mod glb;
mod head;
mod obj;
pub mod planar;
mod ply;
pub mod ruled;
pub mod surface;

mod blob;
mod cylinder;
mod part;
mod plate;
mod rings;
mod saddle;
mod sphere;
mod torus;

use qsplat::Result;

/// A file to be written.
pub struct File {
    /// Its name in the fixtures' folder.
    pub name: &'static str,
    /// All of it.
    pub bytes: Vec<u8>,
}

/// All fixtures, in the order of the table in `fixtures/README.md`.
///
/// # Errors
/// [`qsplat::Error::Internal`] when outlines do not join or a face cannot be meshed.
pub fn all() -> Result<Vec<File>> {
    let mut files = Vec::new();
    let mut add = |name, bytes| files.push(File { name, bytes });

    add("sphere.ply", ply::mesh(&sphere::mesh(), &[]));
    add("sphere-cloud.ply", ply::cloud(&sphere::cloud(), &[]));
    let colored = sphere::colored();
    add("colored-sphere.ply", ply::mesh(&colored.0, &colored.1));
    add("torus.ply", ply::mesh(&torus::mesh(), &[]));
    let (points, normals) = torus::cloud();
    add("torus-cloud.ply", ply::cloud(&points, &normals));
    add("rings.glb", rings::glb());
    add("blob.ply", ply::mesh(&blob::mesh(), &[]));

    for (mesh_name, edges_name, model) in [
        ("monkey-saddle.ply", "monkey-saddle.edges.obj", saddle::model()),
        ("capped-cylinder.ply", "capped-cylinder.edges.obj", cylinder::model()?),
        ("plate.ply", "plate.edges.obj", plate::model()?),
        ("part.ply", "part.edges.obj", part::model()?),
    ] {
        add(mesh_name, ply::mesh(&model.surface, &[]));
        add(edges_name, obj::lines(&model.lines));
    }
    Ok(files)
}
