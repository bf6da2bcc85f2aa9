//! Writes the analytic test models: `make_fixtures [FOLDER]`, by default `fixtures`.
//!
//! `scripts/make-fixtures` calls it. What each model is stands in `fixtures/README.md`.

mod catalogue;

use std::path::PathBuf;
use std::process::ExitCode;

use qsplat::{Error, Result};

fn write_all(folder: PathBuf) -> Result<usize> {
    std::fs::create_dir_all(&folder).map_err(Error::io(&folder))?;
    let mut total = 0;
    for file in catalogue::all()? {
        let path = folder.join(file.name);
        std::fs::write(&path, &file.bytes).map_err(Error::io(&path))?;
        total += file.bytes.len();
    }
    Ok(total)
}

// An example is a program of its own: it says what it did and what went wrong.
#[allow(clippy::print_stderr)]
fn main() -> ExitCode {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("fixtures"), PathBuf::from);
    match write_all(folder) {
        Ok(total) => {
            eprintln!("{total} bytes of fixtures");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("make_fixtures: {error}");
            ExitCode::FAILURE
        }
    }
}
