//! Bakes meshes and point clouds to curved splats with crisp edges and a guaranteed error.
//!
//! A splat is an elliptical piece of a quadric, `w = a u² + b v²` over its tangent plane, cut
//! at feature edges by rational Bézier curves of five numbers. The pipeline:
//!
//! 1. [`ingest`] reads PLY, OBJ, OFF, glTF and GLB into a [`model::mesh::Mesh`] or
//!    [`model::cloud::Cloud`], kept relative to a 64-bit origin, and feature lines into
//!    [`model::polyline::Polylines`].
//! 2. [`analyse`] makes of either one [`analyse::surface::Surface`]: points with neighbours and
//!    normals, cut open along its feature edges.
//! 3. [`fit`] knows two fits: quadrics to points, clip curves to lines.
//! 4. [`sample`] grows the largest splat around each of many seeds that keeps the error bound,
//!    and chooses few that cover every piece of the surface.
//! 5. [`mod@bake`] is the recipe of these; it ends in a [`model::asset::Asset`].
//! 6. [`mod@format`] rounds, orders and codes an asset as a `.qsplat`, and reads it back within
//!    limits. `format-spec.md` is the norm.
//! 7. [`mod@deliver`] does all of that in one call, and measures the decoded splats.
//! 8. [`render`] draws an asset on the CPU, which is the reference, or by wgpu.
//! 9. [`measure`], [`mod@verify`], [`report`] and [`export`] say and show how good it is.
//!
//! The bake half and the show half meet only at the asset and at the file; a viewer needs no
//! more than [`mod@format`] and [`render`].
//!
//! # Example
//!
//! A sphere of some thousand triangles becomes a few dozen splats, none of whose quadrics is
//! farther from the sphere than the bound allows:
//!
//! ```
//! use qsplat::bake::{MaxError, Options, Silent};
//! use qsplat::{deliver, ingest};
//!
//! # fn main() -> qsplat::Result<()> {
//! let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/sphere.ply");
//! let input = ingest::read(path.as_ref(), &ingest::Limits::default())?;
//! let options = Options { max_error: MaxError::Relative(0.002), ..Options::default() };
//! let delivery = deliver::deliver(&input, &options, &mut Silent)?;
//!
//! let asset = &delivery.asset;
//! assert!(asset.fit.max <= asset.max_error);
//! assert!(asset.splats.len() < 100 && delivery.bytes.len() < 2000);
//! // The fixture's radius is 0.5: the splats' centres lie on that sphere within the bound.
//! for splat in &asset.splats {
//!     let radius = asset.frame.to_input(splat.center).length();
//!     assert!((radius - 0.5).abs() <= asset.max_error * asset.frame.scale());
//! }
//! # Ok(())
//! # }
//! ```

pub mod error;
pub mod model;
pub mod tolerance;

pub mod ingest;

pub mod analyse;
pub mod bake;
pub mod fit;
pub mod sample;

pub mod format;

pub mod deliver;
pub mod export;
pub mod measure;
pub mod render;
pub mod report;
pub mod verify;

pub use error::{Error, Result};
