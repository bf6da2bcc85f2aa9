//! Every stage of the pipeline beside its floor, on generated inputs of growing size.
//!
//! `scripts/bench` runs this and writes `docs/benchmarks.md`. Each group holds the stage and its
//! floor, measured one after the other in one process with the same threads, so that the ratio
//! of the two means the same on any machine. `QSPLAT_BENCH_MOST` is the greatest number of points of
//! an input; without it stages that take minutes on 4 million stop at 1 million.

mod assets;
mod cloud;
mod floor;
mod harness;
#[path = "../../examples/make_fixtures/catalogue/head.rs"]
mod head;
mod notes;

mod bake;
mod clip_fit;
mod cpu_frame;
mod decode;
mod encode;
mod fit;
mod frame;
mod neighbours;
mod normals;
mod read;
mod sample;
#[cfg(feature = "gpu")]
mod wgpu_frame;

use std::process::ExitCode;

use criterion::Criterion;
use qsplat::Result;

use notes::Notes;

/// Measures one stage on every input.
type Bench = fn(&mut Criterion, &mut Notes) -> Result<()>;

/// The stages in the order of the pipeline.
const STAGES: &[(&str, Bench)] = &[
    ("read", read::bench),
    ("neighbours", neighbours::bench),
    ("normals", normals::bench),
    ("fit", fit::bench),
    ("clip fit", clip_fit::bench),
    ("sample", sample::bench),
    ("bake", bake::bench),
    ("encode", encode::bench),
    ("decode", decode::bench),
    ("cpu frame", cpu_frame::bench),
    #[cfg(feature = "gpu")]
    ("wgpu frame", wgpu_frame::bench),
];

fn run(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    notes.threads(rayon::current_num_threads());
    for (name, bench) in STAGES {
        if harness::asked(name) {
            bench(criterion, notes)?;
            notes.save()?;
        }
    }
    Ok(())
}

// A benchmark is a program of its own: it says what went wrong.
#[allow(clippy::print_stderr)]
fn main() -> ExitCode {
    let mut criterion = harness::criterion();
    let outcome = run(&mut criterion, &mut Notes::default());
    criterion.final_summary();
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("stages: {error}");
            ExitCode::FAILURE
        }
    }
}
