//! `encode`: an asset to bytes. Floor: copying the splats.

use criterion::Criterion;
use qsplat::{Result, format};
use serde_json::json;

use crate::assets;
use crate::harness::{beside, inputs};
use crate::notes::Notes;

pub fn bench(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    for points in inputs() {
        let asset = assets::asset(points)?;
        let bytes = format::encode(&asset)?.len();
        notes.add("encode", points, json!({ "splats": asset.splats.len(), "bytes": bytes }));
        beside(criterion, "encode", points, || format::encode(&asset), || asset.splats.clone());
    }
    Ok(())
}
