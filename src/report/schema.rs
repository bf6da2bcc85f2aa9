//! The parts of a report, as `docs/report-schema.md` documents them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::memory;
use crate::bake::StageTime;
use crate::format::{self, ChunkInfo, FieldInfo, FileInfo};
use crate::model::asset::Asset;
pub use crate::sample::edge_cases::{EdgeCases, Meeting};
pub use crate::sample::lower_bound::LowerBound;

/// What was baked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// The file, as given.
    pub path: String,
    /// `mesh` or `cloud`.
    pub kind: String,
    /// Points or vertices read.
    pub points: u64,
    /// Triangles read; 0 for a cloud.
    pub triangles: u64,
    /// Points left out because a coordinate was NaN or infinite.
    pub dropped_points: u64,
    /// Triangles left out because they are degenerate or used a dropped point.
    pub dropped_triangles: u64,
    /// Triangles turned because they faced the other way than most of the surface they belong to.
    #[serde(default)]
    pub turned_triangles: u64,
    /// Vertices beside cracks much narrower than the bound that were joined to what lies across.
    #[serde(default)]
    pub sewn_vertices: u64,
    /// Points of a cloud that belong to no surface and were left out: the bound does not hold for them.
    #[serde(default)]
    pub outliers: u64,
    /// Borders of a cloud and rims of its holes wider than the sampling leaves elsewhere, those of most points
    /// first, at most [`MOST_OPEN_PLACES`]: there it is open how far the surface goes on.
    #[serde(default)]
    pub open_places: Vec<OpenPlace>,
    /// How many there are in all.
    #[serde(default)]
    pub open_place_count: u64,
    /// Where a cloud's points lie too far apart for the bound; `None` where nowhere, and for a mesh.
    #[serde(default)]
    pub sparse: Option<Sparse>,
    /// Whether a mesh's facets were taken for a smooth surface: the errors are then those against it.
    pub smooth: bool,
    /// Standard deviation of a cloud's points from their surface, a fraction of the diagonal; `None`
    /// for a mesh and where the points show no surface.
    pub noise: Option<f64>,
    /// How far a cloud's points were moved to smooth them; `None` if they were not: the errors are
    /// then those of the smoothed points.
    pub moved: Option<Moved>,
    /// Whether the input has normals.
    pub normals: bool,
    /// Whether the input has colours.
    pub colors: bool,
    /// Why the colours were left out; `None` if they were kept.
    pub colors_left_out: Option<String>,
    /// Mesh edges taken for feature edges, found or matched; of a cloud, segments of the lines it is
    /// cut along, a spacing long.
    pub feature_edges: u64,
    /// Segments of the feature lines that were given; `None` if none were.
    pub line_segments: Option<u64>,
    /// Share of the given lines' length that was found on the mesh or cloud; `None` without lines.
    pub lines_matched: Option<f64>,
    /// Share of the given lines' length along which the mesh or cloud is smooth: nothing is cut there;
    /// `None` without lines.
    #[serde(default)]
    pub lines_smooth: Option<f64>,
    /// Share of the given lines' length that lies off the edges of the mesh or the creases of the cloud
    /// that are meant, and was moved onto them; `None` without lines.
    #[serde(default)]
    pub lines_moved: Option<f64>,
    /// Share of the given lines' length that runs beside others of them, closer than the points of a
    /// cloud lie apart: one line stands for both; `None` without lines.
    #[serde(default)]
    pub lines_merged: Option<f64>,
    /// Given lines, by their number in the file, from 1, that lie beside no edge of the mesh, or far
    /// from the cloud, and were left out.
    #[serde(default)]
    pub lines_lost: Vec<u64>,
}

/// No more open places than these are listed.
pub const MOST_OPEN_PLACES: usize = 64;

/// A border of a cloud, or the rim of a hole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpenPlace {
    /// Points along it.
    pub points: u64,
    /// The middle of the box around these, input units.
    pub middle: [f64; 3],
    /// Half the diagonal of that box, input units.
    pub reach: f64,
}

/// Points of a cloud between which and those around the surface bends by more than the bound: there splats that fit
/// all points may lie off it by as much, and edges off their lines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sparse {
    /// How many there are.
    pub points: u64,
    /// The one around which it bends the most, input units.
    pub worst: [f64; 3],
    /// By how much there, a fraction of the diagonal.
    pub by: f64,
}

/// How far points were moved, fractions of the diagonal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Root mean square.
    pub rms: f64,
    /// The farthest.
    pub max: f64,
}

/// How it was baked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// The error bound as given: a fraction of the diagonal, or input units.
    pub max_error: f64,
    /// `diagonal` or `input`: what `max_error` is measured in.
    pub max_error_unit: String,
    /// `auto`, `none`, or the file of the feature lines.
    pub edges: String,
    /// Dihedral angle in degrees from which a mesh edge is a feature edge.
    pub edge_angle: f64,
    /// `facets`, `smooth` or `auto`: what a mesh's facets stand for.
    pub surface: String,
    /// Whether a cloud is smoothed where its points scatter too much for the bound.
    pub denoise: bool,
    /// 1 to 9.
    pub effort: u8,
    /// `auto`, `keep` or `estimate`.
    pub normals: String,
    /// `auto`, `keep` or `drop`.
    pub color: String,
    /// `all` or `flat`.
    pub shapes: String,
    /// `curved`, `straight` or `partners`.
    pub clips: String,
    /// `close` or `leave`.
    #[serde(default)]
    pub holes: String,
}

/// How the splats were chosen, with every case in which a fit fell back to less.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// Points of the surface that the splats were fitted to.
    pub samples: u64,
    /// Candidates grown.
    pub candidates: u64,
    /// Splats dropped because others cover all that they cover.
    pub redundant: u64,
    /// Splats saved by moving and merging them.
    pub merged: u64,
    /// Splats added where no other is cut along a line.
    #[serde(default)]
    pub following: u64,
    /// Splats added to close holes that views of a mesh showed.
    #[serde(default)]
    pub sealing: u64,
    /// Splats taken out, and replaced, that views of a mesh showed beside its outline.
    #[serde(default)]
    pub withdrawn: u64,
    /// Pieces of surface that only a splat of their own could cover.
    pub last_resorts: u64,
    /// Splats whose points did not determine a whole quadric.
    pub low_rank: u64,
    /// What the lines do that splats are cut along.
    #[serde(default)]
    pub edge_cases: EdgeCases,
    /// What the choice costs and what any other by the same candidates costs at least; `None` where
    /// that was not asked for.
    #[serde(default)]
    pub lower_bound: Option<LowerBound>,
}

/// The file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct File {
    /// Where it is, as given.
    pub path: String,
    /// Version of the format.
    pub version: u16,
    /// Feature bits a reader must know.
    pub required_features: u32,
    /// Feature bits a reader may ignore.
    pub optional_features: u32,
    /// Bytes in all.
    pub bytes: u64,
    /// Bytes of header, of what stands before each chunk, and of the checksum; with the chunks' coded bytes
    /// they make all.
    pub head_bytes: u64,
    /// The chunks in the order of the file.
    pub chunks: Vec<Chunk>,
    /// What the chunk of splats tells of.
    #[serde(default)]
    pub fields: Vec<Field>,
    /// Chunks that the file does without.
    pub absent: Vec<Absent>,
}

impl File {
    /// From what the format says of a file.
    #[must_use]
    pub fn new(path: &Path, info: &FileInfo) -> Self {
        let chunk = |chunk: &ChunkInfo| Chunk {
            name: chunk.id.clone(),
            coder: chunk.coder.clone(),
            raw_bytes: chunk.raw_bytes,
            coded_bytes: chunk.coded_bytes,
        };
        let field = |field: &FieldInfo| Field { name: field.name.clone(), bytes: field.bytes };
        let absent = |absent: &format::Absent| Absent {
            name: absent.id.clone(),
            what: absent.what.clone(),
            reason: absent.why.clone(),
        };
        Self {
            path: path.display().to_string(),
            version: info.version,
            required_features: info.required_features,
            optional_features: info.optional_features,
            bytes: info.bytes,
            head_bytes: info.head_bytes,
            chunks: info.chunks.iter().map(chunk).collect(),
            fields: info.fields.iter().map(field).collect(),
            absent: info.absent.iter().map(absent).collect(),
        }
    }
}

/// One chunk of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Chunk {
    /// Its four characters.
    pub name: String,
    /// `zstd` or `none`.
    pub coder: String,
    /// Bytes decoded.
    pub raw_bytes: u64,
    /// Bytes in the file.
    pub coded_bytes: u64,
}

/// A part of what is told of splats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Its name in `format-spec.md`, or `place`.
    pub name: String,
    /// Bytes that it takes of the chunk of splats, to their fractions.
    pub bytes: f64,
}

/// A chunk that the file does without.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Absent {
    /// Its four characters.
    pub name: String,
    /// What it would hold.
    pub what: String,
    /// Why it is not there.
    pub reason: String,
}

/// Where the model lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// A place within half a thousandth of a model unit of the centre of the bounding box, input units.
    pub origin: [f64; 3],
    /// One model unit is this power of two of input units.
    pub exponent: i32,
    /// Diagonal of the bounding box, input units.
    pub diagonal: f64,
}

/// Bytes beside what they stand for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Density {
    /// Bytes of the file for each splat.
    pub bytes_per_splat: f64,
    /// Bytes of the file for each input point.
    pub bytes_per_point: Option<f64>,
    /// Sum of the clipped splats' areas over the area of the mesh that was baked; `None` for a cloud.
    #[serde(default)]
    pub overlap: Option<f64>,
}

/// The error bound and what was achieved, as fractions of the bounding box's diagonal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// The bound that the bake was asked to keep.
    pub budget: f64,
    /// Distances of the input's points to the splats, measured on the decoded file.
    pub fit: Fit,
    /// Whether `fit.max` is within `budget`.
    pub within_budget: bool,
}

/// Distances of the input's points, outliers aside, to the splats that cover them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// Root mean square.
    pub rms: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub max: f64,
}

/// Time, memory and threads of the bake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Each stage in order.
    pub stages: Vec<StageTime>,
    /// Seconds on the clock over all stages.
    pub wall_seconds: f64,
    /// Seconds of processor time over all stages and threads.
    pub cpu_seconds: f64,
    /// Greatest resident memory of the process; `None` where the system does not say.
    pub peak_bytes: Option<u64>,
    /// Threads of the pool.
    pub threads: u64,
}

impl Run {
    /// Sums the stages. Those of one name, such as an `encode` before and after measuring,
    /// become one at the place of the first.
    #[must_use]
    pub fn of_stages(parts: Vec<StageTime>, threads: usize) -> Self {
        let mut stages: Vec<StageTime> = Vec::with_capacity(parts.len());
        for part in parts {
            match stages.iter_mut().find(|stage| stage.name == part.name) {
                Some(stage) => {
                    stage.wall_seconds += part.wall_seconds;
                    stage.cpu_seconds += part.cpu_seconds;
                }
                None => stages.push(part),
            }
        }
        let wall_seconds = stages.iter().map(|stage| stage.wall_seconds).sum();
        let cpu_seconds = stages.iter().map(|stage| stage.cpu_seconds).sum();
        Self { stages, wall_seconds, cpu_seconds, peak_bytes: memory::peak_bytes(), threads: threads as u64 }
    }
}

impl Model {
    pub(super) fn of(asset: &Asset) -> Self {
        let frame = &asset.frame;
        let diagonal = asset.diagonal * frame.scale();
        Self { origin: frame.origin.into(), exponent: frame.exponent, diagonal }
    }
}

impl Accuracy {
    pub(super) fn of(asset: &Asset) -> Self {
        // An asset of one point has no diagonal: its errors are zero, not infinite.
        let share = |length: f64| if asset.diagonal > 0.0 { length / asset.diagonal } else { 0.0 };
        let fit = Fit { rms: share(asset.fit.rms), p99: share(asset.fit.p99), max: share(asset.fit.max) };
        Self { budget: share(asset.max_error), fit, within_budget: asset.fit.max <= asset.max_error }
    }
}
