//! Small inputs in memory, through the same door as files.

#![allow(clippy::unwrap_used, clippy::panic)]

mod facing;
#[cfg(feature = "gltf")]
mod gltf;
#[cfg(feature = "gltf")]
mod gltf_file;
mod limits;
mod obj;
mod off;
mod ply;
mod torture;

use std::path::Path;

use glam::DVec3;

use super::source::Source;
use super::{Input, Limits, decode, decode_edges};
use crate::error::Result;
use crate::model::{cloud::Cloud, mesh::Mesh, polyline::Polylines};

fn read(name: &str, bytes: &[u8]) -> Result<Input> {
    decode(&Source::of_bytes(Path::new(name), bytes.to_vec(), &Limits::default()))
}

fn edges(name: &str, bytes: &[u8]) -> Result<Polylines> {
    decode_edges(&Source::of_bytes(Path::new(name), bytes.to_vec(), &Limits::default()))
}

fn mesh(name: &str, bytes: &[u8]) -> Mesh {
    match read(name, bytes) {
        Ok(Input::Mesh(mesh)) => mesh,
        other => panic!("{name}: no mesh but {other:?}"),
    }
}

fn cloud(name: &str, bytes: &[u8]) -> Cloud {
    match read(name, bytes) {
        Ok(Input::Cloud(cloud)) => cloud,
        other => panic!("{name}: no cloud but {other:?}"),
    }
}

fn message(name: &str, bytes: &[u8]) -> String {
    match read(name, bytes) {
        Err(error) => error.to_string(),
        Ok(input) => panic!("{name} was accepted: {input:?}"),
    }
}

/// Positions in the file's coordinates.
fn input_positions(cloud: &Cloud) -> Vec<DVec3> {
    cloud.positions.iter().map(|p| cloud.frame.to_input(p.as_dvec3())).collect()
}
