//! Drawing an asset, and the input it was baked from, from one camera.
//!
//! An asset is drawn two ways that must agree: [`cpu`], the reference, in 64-bit arithmetic,
//! and [`gpu`], wgpu. Both run the same stages, which are twins of one name in Rust and in
//! WGSL, with every number that decides a case in [`constants`]:
//!
//! 1. `project` bounds a splat on the screen;
//! 2. `intersect` casts a pixel's ray on the splat's quadric;
//! 3. `clip` drops what a clip curve cuts away, `partner` what clip partners do;
//! 4. `composite` keeps the nearest hit of a pixel, then blends the splats that lie within a
//!    depth band behind it and face the same way;
//! 5. `shade` lights the blended normal and colour.
//!
//! A mesh or a cloud is drawn on the CPU by [`input`] with the same camera, light and shading.

pub mod camera;
pub mod constants;
pub mod cpu;
pub mod device;
mod disc_scene;
pub mod eye;
mod facets;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod input;
pub mod mesh_normals;
pub mod picture;
pub mod settings;
pub mod stops;

mod composite;
mod partner;
mod project;
mod shade;
mod slivers;
mod smooth;
mod splat;
mod tiles;

pub use camera::Camera;
pub use device::{Choice, DeviceInfo, Drawn, list_devices};
pub use picture::Picture;
pub use settings::{Settings, Show};
