//! Our numbers beside those of the source documents: `document_figures [FOLDER [SECTION]]`, by
//! default `out/figures` and all sections.
//!
//! `scripts/figures` calls it. `T` is Ivo's thesis (UFC 2020), whose Figures 33, 37 and 38
//! and Tables 1 and 2 are made again here; `P` is the paper on clip partners by Ivo, Vidal and
//! Cavalcante-Neto, with its Figures 7 to 9. Each becomes a section of `figures.md`, a CSV of the same
//! rows and, where it is a curve, an SVG. Models come from the folder that `QSPLAT_MODELS`
//! names; where one is missing, a generated surface takes its place, and the section says so.

mod equal_bound;
mod figure_33;
mod figure_37;
mod figure_38;
mod hull;
mod layout;
mod models;
mod page;
mod partners;
mod plot;
mod scatter;
mod search;
mod sheets;
mod table_1;
mod table_2;
mod uniform;

use std::path::PathBuf;
use std::process::ExitCode;

use qsplat::{Error, Result};

use page::Page;

/// Makes a section of the page.
type Section = fn(&mut Page) -> Result<()>;

/// The sections by name, in their order.
const SECTIONS: [(&str, Section); 6] = [
    ("figure-33", figure_33::make),
    ("figure-37", figure_37::make),
    ("figure-38", figure_38::make),
    ("table-1", table_1::make),
    ("table-2", table_2::make),
    ("partners", partners::make),
];

/// Makes all sections, or the one that is asked for.
fn make(page: &mut Page, only: Option<&str>) -> Result<()> {
    if let Some(name) = only.filter(|name| SECTIONS.iter().all(|(known, _)| known != name)) {
        let known: Vec<&str> = SECTIONS.iter().map(|(known, _)| *known).collect();
        return Err(Error::Usage(format!("no section `{name}`; choose one of {}", known.join(", "))));
    }
    for (_, section) in SECTIONS.iter().filter(|(name, _)| only.is_none_or(|only| only == *name)) {
        section(page)?;
    }
    page.write()
}

// An example is a program of its own: it says what it found and what went wrong.
#[allow(clippy::print_stdout, clippy::print_stderr)]
fn main() -> ExitCode {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("out/figures"), PathBuf::from);
    let mut page = Page::new(folder);
    let only = std::env::args().nth(2);
    match make(&mut page, only.as_deref()) {
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
