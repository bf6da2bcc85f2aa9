//! The schema `qsplat-sweep/1`, as `docs/sweep-schema.md` documents it.

use serde::{Deserialize, Serialize};

use crate::bake::StageTime;
use crate::measure::Measures;

/// Name and version of the schema. The number grows when a key changes its meaning or goes;
/// new keys may come without.
pub const SCHEMA: &str = "qsplat-sweep/1";

/// Everything that a sweep found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// [`SCHEMA`].
    pub schema: String,
    /// Program and version that wrote the report.
    pub generator: String,
    /// How it ran.
    pub run: Run,
    /// The inputs, in the order given.
    pub models: Vec<Model>,
}

/// How a sweep ran.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Threads of the pool.
    pub threads: u64,
    /// Cases at a time. Times can be compared only where this is 1.
    pub jobs: u64,
    /// Frames drawn for a frame time, which is their median.
    pub frames: u64,
    /// Width and height of these frames, pixels.
    pub frame_size: [u32; 2],
    /// What drew them.
    pub frame_device: String,
}

/// One input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// The file's name without its ending.
    pub name: String,
    /// The file, as given.
    pub path: String,
    /// `auto`, `none`, or the file of the feature lines.
    pub edges: String,
    /// `mesh` or `cloud`; `None` if it could not be read.
    pub kind: Option<String>,
    /// Points or vertices.
    pub points: u64,
    /// Triangles; 0 for a cloud.
    pub triangles: u64,
    /// Seconds to read it.
    pub read_seconds: f64,
    /// Why it could not be read or has no surface to measure, if so; then it has no cases.
    pub failure: Option<String>,
    /// Its bakes: everything by effort, then planes alone, then chords alone.
    pub cases: Vec<Case>,
    /// Fitted exponents.
    pub slopes: Vec<Slope>,
}

/// One bake of an input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// `all`, `flat` (planes alone) or `straight` (chords alone).
    pub variant: String,
    /// The error budget as given: a percentage of the diagonal, or input units.
    pub max_error: String,
    /// 1 to 9.
    pub effort: u8,
    /// Why there is no outcome, if so.
    pub failure: Option<String>,
    /// What it came to.
    pub outcome: Option<Outcome>,
    /// The Pareto fronts it is on, as `error/cost`: no other case of the input is at most as
    /// large in both and smaller in one.
    pub fronts: Vec<String>,
}

/// What a bake came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Seconds on the clock, from the input in memory to the bytes of the file.
    pub bake_seconds: f64,
    /// Seconds of processor time over all threads for the same.
    pub bake_cpu_seconds: f64,
    /// Both for each stage in order.
    pub stages: Vec<StageTime>,
    /// Milliseconds to draw one frame, the median.
    pub frame_ms: f64,
    /// Every error and cost (`docs/measure-schema.md`), bytes by chunk among them.
    pub measures: Measures,
}

/// A fitted exponent: `cost ~ error^slope` over the budgets of one variant and effort.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// `all`, `flat` or `straight`.
    pub variant: String,
    /// 1 to 9.
    pub effort: u8,
    /// `budget`, `fit_max`, `backward_max` or `flip_mean`.
    pub error: String,
    /// `splats`, `bytes`, `bake_seconds` or `frame_ms`.
    pub cost: String,
    /// The exponent, by least squares of the logarithms.
    pub slope: f64,
    /// The exponent that theory expects of the splats' number, where it expects one.
    pub expected: Option<f64>,
}
