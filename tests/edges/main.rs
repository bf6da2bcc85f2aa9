//! Feature edges from end to end: whatever lines a surface has, its bake keeps every bound.
//!
//! `budgets` sweeps models with lines over three bounds. `hard` takes what one clip curve cannot
//! say: two lines through one splat, a bend to and fro, corners of many lines, of curved and of acute
//! ones, a loop smaller than a splat, a line that ends inside the surface; and ridges that a few large
//! facets make.

// What was measured is printed, so that a failure, or a curious reader, sees by how much.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

mod budgets;
// The fixtures' own tools: outlines, flat faces, walls.
#[path = "../../examples/make_fixtures/catalogue/mod.rs"]
#[allow(dead_code)] // the models that they are made for are not asked for here
mod catalogue;
mod hard;
mod measured;
mod shapes;
#[path = "../analytic/views.rs"]
#[allow(dead_code)] // the coarser pictures
mod views;
