//! The CPU reference against the truth, and wgpu against the CPU reference.
// What was measured is printed, so that a failure, or a curious reader, sees by how much.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod input;
mod reference;
mod scenes;
#[cfg(feature = "gpu")]
mod twins;
