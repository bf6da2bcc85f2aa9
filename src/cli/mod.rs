//! The subcommands: one file each, with its arguments and its wording.
//!
//! Nothing here prints. A subcommand returns the text of its result, and writes notes to the
//! writer it is given.

mod bake;
mod device;
mod edges;
mod export;
mod info;
mod measure;
mod progress;
mod render;
mod report;
mod source;
mod verify;

use std::io::Write;
use std::num::NonZeroUsize;
use std::panic::PanicHookInfo;

use clap::{Parser, Subcommand};
use qsplat::{Error, Result};

/// Bakes meshes and point clouds to curved splats with crisp edges and a guaranteed error,
/// draws them, and checks them.
#[derive(Parser)]
#[command(version, about, after_help = "Exit codes: 0 done, 1 a check failed, 2 usage or bad input.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Threads to work with; the default is one for each processor. The result never depends on it
    #[arg(long, global = true, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Only results and errors: no notes, no progress, and no summary after a bake
    #[arg(long, global = true)]
    quiet: bool,
}

#[derive(Subcommand)]
enum Command {
    Bake(bake::Arguments),
    Edges(edges::Arguments),
    Info(info::Arguments),
    Render(render::Arguments),
    Verify(verify::Arguments),
    Measure(measure::Arguments),
    Export(export::Arguments),
    Report(report::Arguments),
}

/// What a subcommand comes to.
pub(crate) struct Outcome {
    /// For standard output; empty or ending in a line break.
    pub(crate) text: String,
    /// Whether every check passed; true where nothing was checked.
    pub(crate) passed: bool,
}

impl Outcome {
    fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), passed: true }
    }
}

/// Where notes go: facts that the user did not ask for but should know.
pub(crate) struct Notes<'a> {
    out: &'a mut dyn Write,
    quiet: bool,
}

impl Notes<'_> {
    fn note(&mut self, line: &str) {
        if !self.quiet {
            // A closed standard error must not stop the work.
            let _ = writeln!(self.out, "qsplat: {line}");
        }
    }
}

impl Arguments {
    /// Does what was asked; notes and progress go to `notes`.
    ///
    /// # Errors
    /// Everything that ends in exit code 2.
    pub(crate) fn run(self, notes: &mut dyn Write) -> Result<Outcome> {
        if let Some(threads) = self.threads {
            limit_threads(threads)?;
        }
        let mut notes = Notes { out: notes, quiet: self.quiet };
        match self.command {
            Command::Bake(arguments) => arguments.run(&mut notes),
            Command::Edges(arguments) => arguments.run(),
            Command::Info(arguments) => arguments.run(),
            Command::Render(arguments) => arguments.run(&mut notes),
            Command::Verify(arguments) => arguments.run(&mut notes),
            Command::Measure(arguments) => arguments.run(&mut notes),
            Command::Export(arguments) => arguments.run(),
            Command::Report(arguments) => arguments.run(&mut notes),
        }
    }
}

/// More threads than this are a typing error, and each costs a stack.
const MOST_THREADS: usize = 1024;

fn limit_threads(threads: NonZeroUsize) -> Result<()> {
    if threads.get() > MOST_THREADS {
        return Err(Error::Usage(format!("--threads {threads} is more than {MOST_THREADS}")));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global();
    pool.map_err(|error| Error::Internal(format!("thread pool: {error}")))
}

/// What a panic says to the user.
pub(crate) fn panic_message(panic: &PanicHookInfo<'_>) -> String {
    let payload = panic.payload();
    let owned = payload.downcast_ref::<String>().map(String::as_str);
    let what = owned.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("unknown");
    let place =
        panic.location().map_or_else(String::new, |place| format!(" ({}:{})", place.file(), place.line()));
    format!("qsplat: internal error, please report it with the input: {what}{place}")
}
