//! Every stage of the pipeline beside its floor, on generated inputs of growing size.
//!
//! `scripts/bench` runs this and writes `docs/benchmarks.md`. Each group holds the stage and its
//! floor, measured one after the other in one process with the same threads, so that the ratio
//! of the two means the same on any machine. `QSPLAT_BENCH_FULL=1` adds the inputs of 4 million
//! points to the stages that take minutes there.

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

fn run(criterion: &mut Criterion, notes: &mut Notes) -> Result<()> {
    read::bench(criterion)?;
    neighbours::bench(criterion)?;
    normals::bench(criterion)?;
    fit::bench(criterion)?;
    clip_fit::bench(criterion, notes)?;
    sample::bench(criterion, notes)?;
    bake::bench(criterion, notes)?;
    encode::bench(criterion, notes)?;
    decode::bench(criterion)?;
    cpu_frame::bench(criterion, notes)?;
    #[cfg(feature = "gpu")]
    wgpu_frame::bench(criterion, notes)?;
    notes.threads(rayon::current_num_threads());
    notes.save()
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
