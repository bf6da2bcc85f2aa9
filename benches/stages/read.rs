//! `read`: a binary PLY to a cloud. Floor: reading the file's bytes.

use criterion::Criterion;
use qsplat::{Result, ingest};

use crate::cloud;
use crate::harness::{beside, inputs};
use crate::notes::Notes;

pub fn bench(criterion: &mut Criterion, _: &mut Notes) -> Result<()> {
    for points in inputs() {
        let path = cloud::file(points)?;
        let limits = ingest::Limits::default();
        beside(criterion, "read", points, || ingest::read(&path, &limits), || std::fs::read(&path));
    }
    Ok(())
}
