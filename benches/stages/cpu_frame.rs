//! `cpu frame`: a picture by the reference. Floor: the same splats drawn flat.

use criterion::Criterion;
use qsplat::Result;
use qsplat::render::cpu;
use serde_json::json;

use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{assets, frame};

pub fn bench(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    let settings = frame::settings();
    for points in inputs() {
        let asset = assets::asset(points)?;
        let (flat, camera) = (frame::flat(&asset), frame::camera(&asset));
        notes.add("cpu frame", points, json!({ "splats": asset.splats.len() }));
        let stage = || cpu::render(&asset, &camera, &settings);
        beside(criterion, "cpu frame", points, stage, || cpu::render(&flat, &camera, &settings));
    }
    Ok(())
}
