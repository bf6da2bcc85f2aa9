//! From files to clouds, meshes and polylines.
//!
//! 1. `source` reads the file under the limits and brings text to UTF-8.
//! 2. `detect` tells the format by content, then by extension.
//! 3. `ply`, `obj`, `off` or `gltf` decodes to `assemble::Geometry`: 64-bit positions,
//!    attributes, triangles with indices that are in range.
//! 4. `assemble` drops what is not finite, takes the bounding box in 64 bits and rounds to
//!    model units; `facing` turns triangles that face the other way than their neighbours.
//!
//! Nothing is allocated from a number in a file before that number was compared with the
//! bytes that are there.

mod assemble;
pub(crate) mod chain;
mod color;
mod detect;
mod faces;
mod facing;
#[cfg(feature = "gltf")]
mod gltf;
mod obj;
mod off;
mod ply;
mod positions;
mod scalar;
mod source;
#[cfg(test)]
mod tests;
mod text;

use std::path::Path;

use crate::error::Result;
use crate::model::{cloud::Cloud, mesh::Mesh, polyline::Polylines};
use detect::Format;
use source::Source;

/// What a file holds.
#[derive(Clone, Debug)]
pub enum Input {
    /// Triangles.
    Mesh(Mesh),
    /// Points alone.
    Cloud(Cloud),
}

impl Input {
    /// The points, be they vertices or a cloud.
    #[must_use]
    pub fn cloud(&self) -> &Cloud {
        match self {
            Self::Mesh(mesh) => &mesh.vertices,
            Self::Cloud(cloud) => cloud,
        }
    }
}

/// Limits that hold before anything is allocated.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Bytes of a file; for glTF also of all the files it refers to, together.
    pub file_bytes: u64,
    /// Points or vertices, before any is dropped.
    pub points: u64,
    /// Triangles, polygons counted by the triangles they fan into.
    pub triangles: u64,
    /// Pixels of one base-colour texture, and of all that are held at a time.
    pub texture_pixels: u64,
}

impl Default for Limits {
    /// 4 GiB a file, 200 million points, 400 million triangles (a closed mesh has twice as many
    /// triangles as vertices) and textures of up to 16384 x 16384 pixels.
    fn default() -> Self {
        Self { file_bytes: 4 << 30, points: 200_000_000, triangles: 400_000_000, texture_pixels: 1 << 28 }
    }
}

/// Reads a mesh or cloud; the format is chosen by content, then by extension.
///
/// PLY, OBJ, OFF and, with the `gltf` feature, glTF and GLB are read; other formats are named
/// in the error. Points with a coordinate that is NaN or infinite are left out and counted, and
/// so are triangles that use such a point or one point twice. Normals are kept as they are in
/// the file. A vertex of an OBJ whose faces give it different normals (a crease) gets a zero
/// normal. A colour channel that is NaN counts as full, so that a broken colour is white.
/// A glTF scene is flattened: node transforms applied, skins and morph targets ignored.
///
/// # Errors
/// [`crate::Error::Input`] with file, place and remedy; [`crate::Error::Limits`];
/// [`crate::Error::Io`] when the file cannot be read.
pub fn read(path: &Path, limits: &Limits) -> Result<Input> {
    decode(&Source::open(path, limits)?)
}

/// Reads feature lines: OBJ `l` records or a PLY `edge` element.
///
/// PLY edges are joined to polylines at the vertices where exactly two of them meet; OBJ
/// records are kept as they are. A closed line repeats its first point at the end.
///
/// # Errors
/// As [`read`]; also when the file holds no line, or a line uses a point that is not finite.
pub fn read_edges(path: &Path, limits: &Limits) -> Result<Polylines> {
    decode_edges(&Source::open(path, limits)?)
}

fn decode(source: &Source) -> Result<Input> {
    let geometry = match detect::format(source)? {
        Format::Ply => ply::read(source)?,
        Format::Obj => obj::read(source)?,
        Format::Off => off::read(source)?,
        #[cfg(feature = "gltf")]
        Format::Gltf => gltf::read(source)?,
        #[cfg(not(feature = "gltf"))]
        Format::Gltf => {
            return Err(source.whole(
                "is glTF, and this build of qsplat leaves the `gltf` feature out; rebuild with \
                 `--features gltf`, or convert the file to PLY or OBJ",
            ));
        }
    };
    assemble::assemble(source, geometry)
}

fn decode_edges(source: &Source) -> Result<Polylines> {
    match detect::format(source)? {
        Format::Ply => ply::read_edges(source),
        Format::Obj => obj::read_edges(source),
        Format::Off | Format::Gltf => Err(source.whole(
            "feature lines are read from OBJ `l` records or a PLY `edge` element; convert the \
             lines to one of these",
        )),
    }
}
