//! glTF 2.0 and GLB: a scene flattened to one mesh or cloud (Khronos, glTF 2.0.1).
//!
//! The typed JSON is the crate `gltf-json`'s; every index in it is looked up with a check. Its
//! own validation is not run, for it panics on an accessor index out of range.

mod accessor;
mod document;
mod light;
mod primitive;
mod scene;
mod texture;

use super::assemble::Geometry;
use super::source::Source;
use crate::error::Result;
use document::Document;
use primitive::{Flattened, Wanted};

/// Reads the triangles of the default scene, or its points where it has no triangles.
pub(super) fn read(source: &Source) -> Result<Geometry<'static>> {
    let document = Document::read(source)?;
    let placed = scene::placed_meshes(&document)?;
    for wanted in [Wanted::Triangles, Wanted::Points] {
        let mut flattened = Flattened::new(&document, wanted);
        for mesh in &placed {
            flattened.add_mesh(mesh)?;
        }
        if !flattened.is_empty() {
            return Ok(flattened.into_geometry());
        }
    }
    Err(source.whole("its scene has neither triangles nor points; export the surface with it"))
}
