//! `normals`: planes through the neighbours, and one side for all. Floor: the neighbour pass.

use criterion::Criterion;
use qsplat::Result;
use qsplat::analyse::cloud_normals::{NormalSource, normals};
use qsplat::analyse::distinct::distinct;
use qsplat::analyse::nearest::Search;

use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{cloud, floor};

pub fn bench(criterion: &mut Criterion, _: &mut Notes) -> Result<()> {
    for points in inputs() {
        let found = distinct(&cloud::cloud(points));
        let nearest = Search::new(&found.positions)?.nearest();
        let stage = || normals(&found, &nearest, NormalSource::Estimate);
        beside(criterion, "normals", points, stage, || floor::neighbour_pass(&found.positions));
    }
    Ok(())
}
