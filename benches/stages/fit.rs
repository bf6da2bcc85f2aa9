//! `fit`: a quadric in its principal frame through every point's neighbours. Floor: the
//! neighbour pass.

use criterion::Criterion;
use qsplat::Result;
use qsplat::fit::pose::Principal;
use rayon::prelude::*;

use crate::cloud::{Analysed, analysed};
use crate::harness::{beside, inputs};
use crate::notes::Notes;
use crate::{assets, floor};

pub fn bench(criterion: &mut Criterion, _: &mut Notes) -> Result<()> {
    for points in inputs() {
        let analysed = analysed(points)?;
        let positions = &analysed.points.positions;
        beside(criterion, "fit", points, || quadrics(&analysed), || floor::neighbour_pass(positions));
    }
    Ok(())
}

fn quadrics(analysed: &Analysed) -> Vec<Principal> {
    (0..analysed.nearest.len()).into_par_iter().map(|n| assets::quadric(analysed, n).0).collect()
}
