//! `neighbours`: sort, merge, search tree and the nearest of every point. Floor: the neighbour
//! pass.

use criterion::Criterion;
use qsplat::Result;
use qsplat::analyse::distinct::distinct;
use qsplat::analyse::nearest::Search;

use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{cloud, floor};

pub fn bench(criterion: &mut Criterion, _: &mut Notes) -> Result<()> {
    for points in inputs() {
        let cloud = cloud::cloud(points);
        let stage = || Search::new(&distinct(&cloud).positions).map(|search| search.nearest());
        beside(criterion, "neighbours", points, stage, || floor::neighbour_pass(&cloud.positions));
    }
    Ok(())
}
