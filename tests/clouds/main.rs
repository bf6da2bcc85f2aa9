//! Clouds whose surface is known, baked and held against it.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod extremes;
mod invariance;
mod lines;
mod measured;
mod noise;
mod scene;
mod shapes;
