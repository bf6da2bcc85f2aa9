//! `normals`: planes through the neighbours, and one side for all. Floor: the neighbour pass.

use criterion::Criterion;
use qsplat::Result;
use qsplat::analyse::cloud_creases::Points;
use qsplat::analyse::cloud_normals::{NormalSource, normals};
use qsplat::analyse::distinct::distinct;
use qsplat::analyse::nearest::{Search, Spacings, spacing};

use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{cloud, floor};

pub fn bench(criterion: &mut Criterion, _: &mut Notes) -> Result<()> {
    for points in inputs() {
        let found = distinct(&cloud::cloud(points));
        let search = Search::new(&found.positions)?;
        let nearest = search.nearest();
        let spacing = spacing(&found.positions, &nearest);
        let laid = Spacings { search: &search, positions: &found.positions, spacing: &spacing };
        let shown = Points { laid, nearest: &nearest, noise: 0.0 };
        let stage = || normals(&found, &nearest, NormalSource::Estimate, Some(&shown));
        beside(criterion, "normals", points, stage, || floor::neighbour_pass(&found.positions));
    }
    Ok(())
}
