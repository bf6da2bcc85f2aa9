//! The `.qsplat` file, version 3: `format-spec.md` is its normative description.
//!
//! Writing, in order:
//! 1. [`quantize`] rounds each splat to the grids of [`grid`], within a proved share of the
//!    error budget, and gives a record of whole numbers.
//! 2. `order` sorts the records along a Morton curve.
//! 3. `walk` carries each record onto a tape of symbols and extra bits, as differences from
//!    what `predict` guesses from the splats before it; `coder` makes each symbol as short as its
//!    field's symbols before it tell.
//! 4. `codec` codes what is optional with zstd; `layout` puts a header before the chunks and a checksum
//!    behind.
//!
//! Reading does the same backwards, under [`Limits`].
//!
//! ```
//! use glam::{DMat3, DVec2, DVec3};
//! use qsplat::format::{Limits, decode, encode};
//! use qsplat::model::{asset::Asset, splat::Splat};
//!
//! let splat = Splat {
//!     center: DVec3::new(0.1, 0.2, 0.3),
//!     axes: DMat3::IDENTITY,
//!     radii: DVec2::new(0.05, 0.04),
//!     curvature: DVec2::new(2.0, -1.0),
//!     clips: Vec::new(),
//!     partners: Vec::new(),
//!     color: [255; 3],
//! };
//! let asset = Asset {
//!     frame: Default::default(),
//!     diagonal: 2.0,
//!     max_error: 1e-3,
//!     fit: Default::default(),
//!     has_colors: false,
//!     splats: vec![splat.clone()],
//! };
//! let back = decode(&encode(&asset)?, &Limits::default())?;
//! // The surface stays within 15 % of the error budget, here measured at the centre.
//! let local = back.splats[0].to_local(splat.center);
//! assert!((local.z - back.splats[0].height(local.truncate())).abs() <= 0.6 * asset.max_error);
//! # Ok::<(), qsplat::Error>(())
//! ```

mod accept;
mod bound;
mod chunks;
mod clip;
mod clip_walk;
mod codec;
mod coder;
mod color;
mod entry;
mod fields;
pub mod grid;
mod header;
mod homogeneous;
mod inspect;
mod layout;
mod lead;
mod limits;
mod octahedral;
mod order;
mod partners;
mod place;
mod predict;
pub mod quantize;
mod read;
mod record;
mod spelling;
mod store;
mod symbol;
mod tape;
pub mod thrift;
mod turns;
mod walk;
mod write;

#[cfg(test)]
mod planted;
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, clippy::float_cmp)]
mod promises;

pub use inspect::{Absent, ChunkInfo, FieldInfo, FileInfo, inspect};
pub use layout::MAGIC;
pub use limits::Limits;
pub use read::decode;
pub use store::{read_bytes, read_file, write_file};
pub use write::{encode, snap};
