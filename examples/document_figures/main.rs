//! Our numbers beside those of the source documents: `document_figures [FOLDER]`, by default
//! `out/figures`.
//!
//! `scripts/figures` calls it. `T` is Ivo's thesis (UFC 2020), whose Figures 33 and 37 and
//! Tables 1 and 2 are made again here. Each becomes a section of `figures.md`, a CSV of the same
//! rows and, where it is a curve, an SVG. Models come from the folder that `QSPLAT_MODELS`
//! names; where one is missing, a generated surface takes its place, and the section says so.

mod figure_33;
mod figure_37;
mod hull;
mod layout;
mod models;
mod page;
mod plot;
mod scatter;
mod search;
mod table_1;
mod table_2;
mod uniform;

use std::path::PathBuf;
use std::process::ExitCode;

use qsplat::Result;

use page::Page;

fn make(page: &mut Page) -> Result<()> {
    figure_33::make(page)?;
    figure_37::make(page)?;
    table_1::make(page)?;
    table_2::make(page)?;
    page.write()
}

// An example is a program of its own: it says what it found and what went wrong.
#[allow(clippy::print_stdout, clippy::print_stderr)]
fn main() -> ExitCode {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("out/figures"), PathBuf::from);
    let mut page = Page::new(folder);
    match make(&mut page) {
        Ok(()) => {
            print!("{}", page.markdown());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("document_figures: {error}");
            ExitCode::FAILURE
        }
    }
}
