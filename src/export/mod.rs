//! An asset as triangles, so that any other tool can measure it.
//!
//! 1. [`outline`]: the ellipse's border and the clip curves as chains of chords.
//! 2. [`tessellate`]: a constrained Delaunay triangulation between them, with as many points
//!    inside as the curvature asks for.
//! 3. [`ply`]: one binary PLY of all splats, each face with the number of its splat.
//!
//! Both the chords and the triangles stay within a share of the error budget, which is
//! [`crate::tolerance::EXPORT_SHARE`] unless another is asked for.

pub mod lines;
pub mod outline;
pub mod ply;
pub mod tessellate;

#[cfg(test)]
mod tests;
