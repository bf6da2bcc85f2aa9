//! What is said of a bake and of a file: one JSON schema, a table for people, and a page with
//! pictures.
//!
//! `docs/report-schema.md` documents every key; a test holds it to this file.

pub mod measured;
pub mod memory;
pub mod optional;
pub mod page;
pub mod png;
pub mod schema;
pub mod table;

use serde::{Deserialize, Serialize};

use crate::model::asset::{Asset, Counts};
pub use optional::Optional;
pub use schema::{
    Absent, Accuracy, Choice, Chunk, Density, EdgeCases, Field, File, Fit, Input, LowerBound,
    MOST_OPEN_PLACES, Meeting, Model, Moved, OpenPlace, Options, Run, Sparse,
};

/// Name and version of the schema. The number grows when a key changes its meaning or goes;
/// new keys may come without.
pub const SCHEMA: &str = "qsplat-report/1";

/// Everything that is said of one bake or one file. Parts that are not known are `None`, and
/// `null` in the JSON: a file alone says nothing of its input or of the run that made it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: String,
    /// Program and version that wrote the report.
    pub generator: String,
    /// What was baked.
    pub input: Option<Input>,
    /// How it was baked, after defaults.
    pub options: Option<Options>,
    /// How the splats were chosen.
    pub choice: Option<Choice>,
    /// The file.
    pub file: File,
    /// Where the model lies and how large it is.
    pub model: Model,
    /// Splats by kind.
    pub counts: Counts,
    /// Bytes beside what they stand for.
    pub density: Density,
    /// The error bound and what was achieved.
    pub error: Accuracy,
    /// Everything optional: whether it is in the file and, if not, why.
    pub optional: Vec<Optional>,
    /// Time, memory and threads of the bake.
    pub run: Option<Run>,
}

/// What only the run that baked a file knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// What was baked.
    pub input: Input,
    /// How.
    pub options: Options,
    /// How the splats were chosen.
    pub choice: Choice,
    /// Sum of the clipped splats' areas over the area of the mesh, if it is one.
    pub overlap: Option<f64>,
    /// Time, memory and threads.
    pub run: Run,
}

impl Report {
    /// Reports on an asset as decoded from a file, with its origin where that is known.
    #[must_use]
    pub fn new(asset: &Asset, file: File, origin: Option<Origin>) -> Self {
        let counts = asset.counts();
        let optional = optional::all(asset, &counts, origin.as_ref());
        let per = |count: u64| if count > 0 { file.bytes as f64 / count as f64 } else { 0.0 };
        let density = Density {
            bytes_per_splat: per(counts.splats as u64),
            bytes_per_point: origin.as_ref().map(|origin| per(origin.input.points)),
            overlap: origin.as_ref().and_then(|origin| origin.overlap),
        };
        let (input, options, choice, run) = match origin {
            Some(Origin { input, options, choice, run, .. }) => {
                (Some(input), Some(options), Some(choice), Some(run))
            }
            None => (None, None, None, None),
        };
        Self {
            schema: SCHEMA.into(),
            generator: format!("qsplat {}", env!("CARGO_PKG_VERSION")),
            input,
            options,
            choice,
            file,
            model: Model::of(asset),
            counts,
            density,
            error: Accuracy::of(asset),
            optional,
            run,
        }
    }

    /// The report as indented JSON, ending in a line break.
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if it cannot be written, which no finite numbers cause.
    pub fn json(&self) -> crate::Result<String> {
        let json = serde_json::to_string_pretty(self);
        json.map(|text| text + "\n").map_err(|error| crate::Error::Internal(format!("report: {error}")))
    }
}

#[cfg(test)]
mod tests;
