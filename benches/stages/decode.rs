//! `decode`: bytes to an asset. Floor: copying the splats.

use criterion::Criterion;
use qsplat::{Result, format};

use crate::assets;
use crate::harness::{POINTS, beside};

pub fn bench(criterion: &mut Criterion) -> Result<()> {
    for points in POINTS {
        let asset = assets::asset(points)?;
        let bytes = format::encode(&asset)?;
        let limits = format::Limits::default();
        beside(criterion, "decode", points, || format::decode(&bytes, &limits), || asset.splats.clone());
    }
    Ok(())
}
