//! `sample`: growing candidates and choosing from them, at the default error and effort 5.
//! Floor: the neighbour pass.

use criterion::Criterion;
use qsplat::Result;
use qsplat::bake::{Blind, Options, Silent, bake};
use qsplat::format::quantize::Quantizer;
use qsplat::ingest::Input;
use serde_json::json;

use crate::harness::{affordable, beside_timed};
use crate::notes::Notes;
use crate::{cloud, floor};

/// The stages of a bake that choose the splats.
const STAGES: [&str; 2] = ["sample", "cover"];

pub fn bench(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    for points in affordable() {
        let input = Input::Cloud(cloud::cloud(points));
        let rounding = |splat: &_, max_error, fineness| {
            let quantizer = Quantizer::new(max_error);
            quantizer.snap_within(splat, fineness).ok()
        };
        let mut outcome = Ok(0);
        let options = Options::default();
        let seconds = || match bake(&input, &options, &rounding, &|_, _, _| Ok(()), &mut Blind, &mut Silent) {
            Ok(baked) => {
                outcome = Ok(baked.asset.splats.len());
                let chosen = baked.stages.iter().filter(|stage| STAGES.contains(&stage.name.as_str()));
                chosen.map(|stage| stage.wall_seconds).sum()
            }
            Err(error) => {
                outcome = Err(error);
                0.0
            }
        };
        let positions = &input.cloud().positions;
        beside_timed(criterion, "sample", points, seconds, || floor::neighbour_pass(positions));
        let splats = outcome?;
        if splats > 0 {
            notes.add("sample", points, json!({ "splats": splats }));
        }
    }
    Ok(())
}
