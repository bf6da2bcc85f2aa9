//! `qsplat bake`: a mesh or cloud in, a `.qsplat` out.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use qsplat::analyse::cloud_surface::{OpenPlace, Sparse};
use qsplat::analyse::mesh_surface::Found;
use qsplat::bake::meant::Quiet;
use qsplat::bake::{
    Baked, Clips, Clock, Colors, DEFAULT_EFFORT, Edges, Holes, Made, MaxError, Meaning, Normals, Options,
    Shapes,
};
use qsplat::error::Result;
use qsplat::ingest::Input;
use qsplat::model::frame::Frame;
use qsplat::report::{self, Report};
use qsplat::tolerance::DEFAULT_EDGE_ANGLE;
use qsplat::{deliver, format};

use super::progress::Style;
use super::{Notes, Outcome, source};

/// Bakes a mesh or a point cloud to a .qsplat.
#[derive(Args)]
pub(super) struct Arguments {
    /// A mesh or cloud: PLY, OBJ, glTF, GLB
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// Feature lines: an OBJ with `l` records or a PLY with an `edge` element, moved onto the edges
    /// of a mesh where they lie off them by up to 0.5 % of the diagonal, onto the creases of a cloud
    /// without noise where they do by up to three spacings; `auto` finds them on a mesh by dihedral
    /// angle and border, in a cloud by the planes on both sides of a crease
    #[arg(long, value_name = "FILE|auto|none", default_value = "auto")]
    edges: String,
    /// Dihedral angle from which `--edges auto` takes an edge of a mesh, or a crease of a cloud, for a
    /// feature edge, degrees
    #[arg(long, value_name = "DEG", default_value_t = DEFAULT_EDGE_ANGLE, value_parser = edge_angle)]
    edge_angle: f64,
    /// What the facets of a mesh stand for, and so what the error bound holds against
    #[arg(long, value_enum, default_value_t)]
    surface: SurfaceArgument,
    /// Smooths the points of a cloud where they scatter by more than a sixth of the error bound, which
    /// then holds against the smoothed points; without it a cloud is refused that scatters by more than
    /// a third
    #[arg(long)]
    denoise: bool,
    /// The file to write
    #[arg(short, long, value_name = "OUT.qsplat")]
    output: PathBuf,
    /// Greatest distance of an input point from the splats: a percentage of the bounding box's
    /// diagonal, or a length in the input's units
    #[arg(long, value_name = "0.1%|0.002", default_value_t, allow_hyphen_values = true)]
    max_error: MaxError,
    /// 1 (fastest) to 9 (fewest bytes)
    #[arg(long, value_name = "1..9", default_value_t = DEFAULT_EFFORT, value_parser = clap::value_parser!(u8).range(1..=9))]
    effort: u8,
    /// Whether to trust the input's normals
    #[arg(long, value_enum, default_value_t)]
    normals: NormalsArgument,
    /// Whether to keep the input's colours
    #[arg(long, value_enum, default_value_t)]
    color: ColorArgument,
    /// What splats may be pieces of. `flat` is for comparison: the same guarantees, more splats
    #[arg(long, value_enum, default_value_t)]
    shapes: ShapesArgument,
    /// What splats are cut by. `straight` is for comparison: the same guarantees, more splats. So is
    /// `partners`, which takes no feature lines (`--edges FILE` is refused): edges are as sharp as
    /// the splats across them make them, and only what the bound says of the input holds
    #[arg(long, visible_alias = "clip", value_enum, default_value_t)]
    clips: ClipsArgument,
    /// What becomes of holes that pictures of the splats show, and of what shows beside the outline
    #[arg(long, value_enum, default_value_t)]
    holes: HolesArgument,
    /// Finds out how little a cover of the surface by the same candidates could cost, and says how far
    /// the chosen one is from that at most, in the table and the report; takes a few percent of the
    /// bake's time, and the file stays the same
    #[arg(long)]
    lower_bound: bool,
    /// Writes the report as JSON (docs/report-schema.md)
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// How to tell the progress, on standard error
    #[arg(long, value_enum, default_value_t)]
    progress: Style,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum SurfaceArgument {
    /// Themselves
    #[default]
    Facets,
    /// A smooth surface through the vertices, at right angles to their normals
    Smooth,
    /// A smooth surface where normals, or without them the angles between facets, say so
    Auto,
}

impl From<SurfaceArgument> for Meaning {
    fn from(argument: SurfaceArgument) -> Self {
        match argument {
            SurfaceArgument::Facets => Self::Facets,
            SurfaceArgument::Smooth => Self::Smooth,
            SurfaceArgument::Auto => Self::Auto,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum NormalsArgument {
    /// Keep them where they are sound, else estimate
    #[default]
    Auto,
    /// Keep them; refuse an input without sound ones
    Keep,
    /// Estimate them from the positions
    Estimate,
}

impl From<NormalsArgument> for Normals {
    fn from(argument: NormalsArgument) -> Self {
        match argument {
            NormalsArgument::Auto => Self::Auto,
            NormalsArgument::Keep => Self::Keep,
            NormalsArgument::Estimate => Self::Estimate,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum ColorArgument {
    /// Keep them if they differ
    #[default]
    Auto,
    /// Keep them; refuse an input without
    Keep,
    /// Leave them out
    Drop,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum ShapesArgument {
    /// Quadrics, and planes where those do
    #[default]
    All,
    /// Planes alone
    Flat,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum ClipsArgument {
    /// Conics, and chords where those do
    #[default]
    Curved,
    /// Chords alone
    Straight,
    /// No curves but where the surface ends: each splat is cut by those across the edge
    Partners,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum HolesArgument {
    /// What pictures 512 pixels wide from 26 directions show is mended as far as splats within the bound
    /// can do without; a bound wider than a pixel of theirs, 0.125% of the diagonal, is narrowed to that
    /// (not that of a cloud whose noise is above a sixth of it), that of a slender mesh to two pixels of the
    /// views along it
    #[default]
    Close,
    /// They stay: the bound alone rules, and coarse ones make smaller files
    Leave,
}

pub(super) fn edge_angle(text: &str) -> std::result::Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "give an angle in degrees, such as 40".to_owned())?;
    if degrees > 0.0 && degrees <= 180.0 {
        Ok(degrees)
    } else {
        Err("give an angle in degrees within 0 and 180".into())
    }
}

impl Arguments {
    pub(super) fn run(self, notes: &mut Notes<'_>) -> Result<Outcome> {
        let quiet = notes.quiet;
        let mut progress = self.progress.teller(quiet, notes.out);
        let mut clock = Clock::default();
        clock.stage(progress.as_mut(), "read");
        let options = self.options()?;
        let input = source::input(&self.input)?;
        let mut stages = clock.finish();
        let delivery =
            deliver::deliver(&input, &options, progress.as_mut()).map_err(source::of(&self.input))?;
        stages.extend(delivery.stages.iter().cloned());
        let mut clock = Clock::default();
        clock.stage(progress.as_mut(), "write");
        format::write_file(&self.output, &delivery.bytes)?;
        stages.extend(clock.finish());
        drop(progress);
        let origin = report::Origin {
            input: self.facts(&input, &options, &delivery.baked),
            options: self.stated(),
            choice: choice(&delivery.baked),
            overlap: delivery.overlap,
            run: report::Run::of_stages(stages, rayon::current_num_threads()),
        };
        let info = format::inspect(&delivery.bytes, &format::Limits::default())?;
        let report = Report::new(&delivery.asset, report::File::new(&self.output, &info), Some(origin));
        if let Some(path) = &self.report {
            format::write_file(path, report.json()?.as_bytes())?;
        }
        if let Some(note) = self.narrowed_note(&report) {
            notes.note(&note);
        }
        if let Some(input) = report.input.as_ref().filter(|input| input.turned_triangles > 0) {
            notes.note(&turned_note(input));
        }
        if let Some(input) = report.input.as_ref().filter(|input| input.sewn_vertices > 0) {
            notes.note(&sewn_note(input));
        }
        if let Some(input) = report.input.as_ref().filter(|input| input.outliers > 0) {
            notes.note(&outliers_note(input));
        }
        if let Some(input) = report.input.as_ref().filter(|input| !input.lines_lost.is_empty()) {
            notes.note(&lost_note(&self.edges, &input.lines_lost));
        }
        let text = if quiet { String::new() } else { report.table() };
        // The bake refuses to break its bound; if it ever did, this is a failed check.
        Ok(Outcome { text, passed: report.error.within_budget })
    }

    /// What to say of a bound that was narrowed.
    fn narrowed_note(&self, report: &Report) -> Option<String> {
        let asked = match self.max_error {
            MaxError::Relative(share) => share,
            MaxError::Absolute(length) => length / report.model.diagonal,
        };
        let kept = report.error.budget;
        (kept < asked * (1.0 - ROUNDED)).then(|| {
            format!(
                "the bound is {:.3}% of the diagonal: {} would show in pictures 512 pixels wide as holes or \
                 beside the outline; --holes leave keeps to it, for a smaller file",
                100.0 * kept,
                self.max_error
            )
        })
    }

    fn options(&self) -> Result<Options> {
        Ok(Options {
            max_error: self.max_error,
            edges: source::edges(&self.edges)?,
            edge_angle: self.edge_angle,
            meaning: self.surface.into(),
            denoise: self.denoise,
            effort: self.effort,
            normals: self.normals.into(),
            colors: match self.color {
                ColorArgument::Auto => Colors::Auto,
                ColorArgument::Keep => Colors::Keep,
                ColorArgument::Drop => Colors::Drop,
            },
            shapes: match self.shapes {
                ShapesArgument::All => Shapes::All,
                ShapesArgument::Flat => Shapes::Flat,
            },
            clips: match self.clips {
                ClipsArgument::Curved => Clips::Curved,
                ClipsArgument::Straight => Clips::Straight,
                ClipsArgument::Partners => Clips::Partners,
            },
            holes: match self.holes {
                HolesArgument::Close => Holes::Close,
                HolesArgument::Leave => Holes::Leave,
            },
            lower_bound: self.lower_bound,
        })
    }

    fn facts(&self, input: &Input, options: &Options, baked: &Baked) -> report::Input {
        let cloud = input.cloud();
        let (kind, triangles, dropped_triangles, turned_triangles) = match input {
            Input::Mesh(mesh) => ("mesh", mesh.triangles.len(), mesh.dropped, mesh.turned),
            Input::Cloud(_) => ("cloud", 0, 0, 0),
        };
        let line_segments = match &options.edges {
            Edges::Given(lines) => Some(lines.segments() as u64),
            Edges::Auto | Edges::None => None,
        };
        let matched = baked.features.matched.as_ref().filter(|matched| matched.length > 0.0);
        let share = |length: f64| length / baked.asset.diagonal;
        report::Input {
            path: self.input.display().to_string(),
            kind: kind.into(),
            points: cloud.positions.len() as u64,
            triangles: triangles as u64,
            dropped_points: cloud.dropped as u64,
            dropped_triangles: dropped_triangles as u64,
            turned_triangles: turned_triangles as u64,
            sewn_vertices: baked.features.sewn.vertices as u64,
            outliers: baked.left_out.len() as u64,
            open_places: open_places(&baked.open_places, &cloud.frame),
            open_place_count: baked.open_places.len() as u64,
            sparse: baked.sparse.as_ref().map(|found| sparse(found, &cloud.frame, baked.asset.diagonal)),
            smooth: matches!(baked.made, Made::Smooth(_)),
            noise: baked.noise.map(share),
            moved: match baked.made {
                Made::Quiet(Quiet { moved_rms, moved_max, .. }) => {
                    Some(report::Moved { rms: share(moved_rms), max: share(moved_max) })
                }
                Made::Itself | Made::Smooth(_) => None,
            },
            normals: !cloud.normals.is_empty(),
            colors: !cloud.colors.is_empty(),
            colors_left_out: baked.colors_left_out.map(Into::into),
            feature_edges: baked.features.feature_edges as u64,
            line_segments,
            lines_matched: matched.map(|matched| matched.matched_length / matched.length),
            lines_smooth: matched.map(|matched| matched.smooth_length / matched.length),
            lines_moved: matched.map(|matched| matched.moved_length / matched.length),
            lines_merged: matched.map(|matched| matched.merged_length / matched.length),
            lines_lost: lost(options, &baked.features),
        }
    }

    /// The options as the report states them.
    fn stated(&self) -> report::Options {
        let (max_error, unit) = match self.max_error {
            MaxError::Relative(share) => (share, "diagonal"),
            MaxError::Absolute(length) => (length, "input"),
        };
        let name = |value: Option<clap::builder::PossibleValue>| {
            value.map_or_else(String::new, |v| v.get_name().into())
        };
        report::Options {
            max_error,
            max_error_unit: unit.into(),
            edges: self.edges.clone(),
            edge_angle: self.edge_angle,
            surface: name(self.surface.to_possible_value()),
            denoise: self.denoise,
            effort: self.effort,
            normals: name(self.normals.to_possible_value()),
            color: name(self.color.to_possible_value()),
            shapes: name(self.shapes.to_possible_value()),
            clips: name(self.clips.to_possible_value()),
            holes: name(self.holes.to_possible_value()),
        }
    }
}

/// By how much a share of the diagonal may change on its way to the model's units and back.
const ROUNDED: f64 = 1e-6;

/// The longest open places of a cloud in input units.
fn open_places(found: &[OpenPlace], frame: &Frame) -> Vec<report::OpenPlace> {
    let stated = |place: &OpenPlace| report::OpenPlace {
        points: place.points as u64,
        middle: frame.to_input(place.middle).into(),
        reach: place.reach * frame.scale(),
    };
    found.iter().take(report::MOST_OPEN_PLACES).map(stated).collect()
}

/// Where a cloud's points lie too far apart, in input units.
fn sparse(found: &Sparse, frame: &Frame, diagonal: f64) -> report::Sparse {
    let worst = frame.to_input(found.worst).into();
    report::Sparse { points: found.points as u64, worst, by: found.by / diagonal }
}

fn turned_note(input: &report::Input) -> String {
    let report::Input { turned_triangles, triangles, .. } = input;
    format!(
        "{turned_triangles} of {triangles} triangles faced the other way than most of the surface they belong to \
         and were turned"
    )
}

fn sewn_note(input: &report::Input) -> String {
    let sewn = input.sewn_vertices;
    format!(
        "{sewn} vertices beside cracks narrower than a sixteenth of the bound were joined to what lies across"
    )
}

fn outliers_note(input: &report::Input) -> String {
    let report::Input { outliers, points, .. } = input;
    format!(
        "{outliers} of {points} points are outliers and were left out: too far from all others, or too few of \
         them together, to belong to any surface; the bound holds for all others"
    )
}

/// Lines named in a note, at most.
const MOST_NAMED: usize = 8;

fn lost_note(path: &str, lost: &[u64]) -> String {
    let named: Vec<String> = lost.iter().take(MOST_NAMED).map(u64::to_string).collect();
    let more = if lost.len() > MOST_NAMED {
        format!(" and {} more", lost.len() - MOST_NAMED)
    } else {
        String::new()
    };
    format!(
        "{path}: left out what lies beside no edge of the input, {} of its lines (number {}{more}); check \
         that they belong to it, in the same units",
        lost.len(),
        named.join(", ")
    )
}

/// The given lines, counted from 1, that mean no edge of the input.
fn lost(options: &Options, features: &Found) -> Vec<u64> {
    let (Edges::Given(lines), Some(matched)) = (&options.edges, &features.matched) else {
        return Vec::new();
    };
    lines.whole(&matched.lost).into_iter().map(|line| line as u64 + 1).collect()
}

fn choice(baked: &Baked) -> report::Choice {
    report::Choice {
        samples: baked.samples as u64,
        candidates: baked.choice.candidates as u64,
        redundant: baked.choice.redundant as u64,
        merged: baked.choice.merged as u64,
        following: baked.choice.following as u64,
        sealing: baked.choice.sealing as u64,
        withdrawn: baked.choice.withdrawn as u64,
        last_resorts: baked.choice.last_resorts as u64,
        low_rank: baked.choice.low_rank as u64,
        edge_cases: baked.edge_cases.clone(),
        lower_bound: baked.lower_bound,
    }
}
