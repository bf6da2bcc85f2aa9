//! Quadrics from points, clip curves from lines: the two fits everything rests on.

pub mod clip;
pub mod conic;
pub mod ellipse;
pub mod limits;
pub mod offset;
pub mod pose;
pub mod quadric;
