//! `decode`: bytes to an asset. Floor: copying the splats.

use criterion::Criterion;
use qsplat::{Result, format};

use crate::assets;
use crate::harness::{beside, inputs};
use crate::notes::Notes;

pub fn bench(criterion: &mut Criterion, _: &mut Notes) -> Result<()> {
    for points in inputs() {
        let asset = assets::asset(points)?;
        let bytes = format::encode(&asset)?;
        let limits = format::Limits::default();
        beside(criterion, "decode", points, || format::decode(&bytes, &limits), || asset.splats.clone());
    }
    Ok(())
}
