//! Many bakes of the same inputs: what each budget, effort and kind of splat costs and brings.
//!
//! [`run`] bakes, measures and draws every case of a [`Plan`]; [`page`] shows the curves of error
//! against cost, [`csv`] and [`Sweep::json`] keep the numbers. A case that fails keeps its
//! message and the rest goes on.

pub mod axis;
mod bars;
mod case;
mod chart;
pub mod csv;
pub mod front;
mod models;
pub mod page;
mod pictures;
pub mod plan;
pub mod schema;
pub mod slope;
mod table;

use std::path::{Path, PathBuf};

pub use plan::{Lines, Plan};
pub use schema::{Case, Model, Sweep};

use crate::error::{Error, Result};
use crate::format;
use pictures::Album;

/// What happens while a sweep runs.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// An input is being read.
    Reading(&'a Path),
    /// A case begins: its input, and its variant, budget and effort in words.
    Began(&'a str, &'a str),
    /// A case of an input ended.
    Ended {
        /// The input's name.
        model: &'a str,
        /// The case with its outcome or failure.
        case: &'a Case,
        /// Cases of this input that ended so far.
        done: usize,
        /// Cases of this input, as far as is known.
        total: usize,
    },
    /// All cases of an input ended: everything so far, to be written before the next begins.
    Finished(&'a Swept),
}

/// A sweep and the pictures of its cases.
#[derive(Clone, Debug)]
pub struct Swept {
    /// The numbers.
    pub sweep: Sweep,
    /// The pictures.
    album: Album,
}

/// Bakes, measures and draws every case. What cannot be read or baked is kept as a failure.
///
/// The order of the results depends on the inputs and the plan alone.
///
/// # Errors
/// [`Error::Usage`] for a plan that cannot be carried out.
pub fn run(inputs: &[PathBuf], plan: &Plan, watch: &mut dyn FnMut(&Event<'_>)) -> Result<Swept> {
    plan.check(inputs.len())?;
    let run = schema::Run {
        threads: rayon::current_num_threads() as u64,
        jobs: plan.jobs as u64,
        frames: plan.frames as u64,
        frame_size: case::FRAME_SIZE,
        frame_device: "CPU reference".into(),
    };
    let generator = format!("qsplat {}", env!("CARGO_PKG_VERSION"));
    let sweep = Sweep { schema: schema::SCHEMA.into(), generator, run, models: Vec::new() };
    let mut swept = Swept { sweep, album: Album::default() };
    for path in inputs {
        watch(&Event::Reading(path));
        let (model, pictures) = models::sweep(path, plan, watch);
        swept.sweep.models.push(model);
        swept.album.models.push(pictures);
        watch(&Event::Finished(&swept));
    }
    Ok(swept)
}

impl Sweep {
    /// How many inputs and cases failed.
    #[must_use]
    pub fn failures(&self) -> usize {
        let of = |model: &Model| {
            let cases = model.cases.iter().filter(|case| case.failure.is_some()).count();
            cases + usize::from(model.failure.is_some())
        };
        self.models.iter().map(of).sum()
    }

    /// The numbers as indented JSON, ending in a line break.
    ///
    /// # Errors
    /// [`Error::Internal`] if it cannot be written, which no finite numbers cause.
    pub fn json(&self) -> Result<String> {
        let json = serde_json::to_string_pretty(self);
        json.map(|text| text + "\n").map_err(|error| Error::Internal(format!("sweep report: {error}")))
    }
}

impl Swept {
    /// Writes `report.json`, `report.csv` and `report.html` into a directory, making it if it is
    /// not there; the page's path.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, directory: &Path) -> Result<PathBuf> {
        std::fs::create_dir_all(directory).map_err(Error::io(directory))?;
        format::write_file(&directory.join("report.json"), self.sweep.json()?.as_bytes())?;
        format::write_file(&directory.join("report.csv"), csv::csv(&self.sweep)?.as_bytes())?;
        let page = directory.join("report.html");
        format::write_file(&page, page::html(&self.sweep, &self.album)?.as_bytes())?;
        Ok(page)
    }
}

#[cfg(test)]
mod tests;
