//! `wgpu frame`: a picture by a graphics device, brought back to memory. Floor: the same splats
//! drawn flat.

use criterion::Criterion;
use qsplat::Result;
use qsplat::render::gpu::Gpu;
use serde_json::json;

use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{assets, frame};

// What is left out must be said.
#[allow(clippy::print_stderr)]
pub fn bench(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    let gpu = match Gpu::new() {
        Ok(gpu) => gpu,
        Err(error) => {
            eprintln!("LEFT OUT: wgpu frames: {error}");
            return Ok(());
        }
    };
    notes.adapter(&gpu.info().name);
    let settings = frame::settings();
    for points in inputs() {
        let asset = assets::asset(points)?;
        let (flat, camera) = (frame::flat(&asset), frame::camera(&asset));
        notes.add("wgpu frame", points, json!({ "splats": asset.splats.len() }));
        let (curved, flat) = (gpu.load(&asset)?, gpu.load(&flat)?);
        let stage = || curved.draw(&camera, &settings);
        beside(criterion, "wgpu frame", points, stage, || flat.draw(&camera, &settings));
    }
    Ok(())
}
