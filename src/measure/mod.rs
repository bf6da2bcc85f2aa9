//! Numbers that say how good a result is.

pub mod fit;
pub mod image;
mod point_grid;
