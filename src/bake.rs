//! The recipe: from a mesh or cloud to an asset, one stage a line.

mod bound;
pub mod found_lines;
mod growing;
pub mod kept;
pub mod looking;
pub mod meant;
pub mod noise;
pub mod options;
mod partnered;
mod patch;
pub mod quiet;
#[cfg(test)]
mod scattered;

use std::borrow::Cow;
use std::time::Instant;

use cpu_time::ProcessTime;
use glam::{DVec3, Vec3};

use crate::analyse::cloud_creases::{Sought, cloud_creases};
use crate::analyse::cloud_normals::NormalSource;
use crate::analyse::cloud_surface::{CloudSurface, Lines, OpenPlace, Sparse, cloud_surface};
use crate::analyse::mesh_surface::{Features, Found, Making, Marked, cut_lines};
use crate::analyse::partners::Tally;
use crate::analyse::sided::Sided;
use crate::analyse::surface::Surface;
use crate::analyse::thin::Reach;
use crate::analyse::worth::Worth;
use crate::error::{Error, Result};
pub use crate::fit::clip::Clips;
pub use crate::fit::pose::Shapes;
use crate::fit::pose::misfit;
use crate::ingest::Input;
use crate::model::asset::{Accuracy, Asset};
use crate::model::discs::Discs;
use crate::model::frame::Frame;
use crate::model::mesh::Mesh;
use crate::model::polyline::Polylines;
use crate::model::sight::Faults;
use crate::model::splat::Splat;
use crate::model::trial::Trial;
use crate::sample::budget::Budget;
use crate::sample::candidates::{Regions, candidates};
use crate::sample::cover::{Choice, cover};
use crate::sample::edge_cases::EdgeCases;
use crate::sample::lower_bound::LowerBound;
use crate::sample::scout::Begun;
pub use bound::model_error;
pub use found_lines::found_lines;
use growing::Growing;
pub use kept::{Kept, kept};
pub use looking::{Blind, Looking};
use looking::{MENDINGS, is_looked_at, told_margins};
use meant::check_noise;
pub use meant::{Made, Meant, meant};
pub use options::{Colors, DEFAULT_EFFORT, Edges, Holes, MaxError, Meaning, Normals, Options};
use partnered::{partnered, rule};

/// Told how the work goes on; all methods may be called from the baking thread only.
pub trait Progress {
    /// A stage begins (`read`, `analyse`, `look`, `scout`, `sample`, `cover`, `bound`, `clip`, `seal`, `partners`,
    /// `encode`, `measure`, `write`).
    fn stage(&mut self, name: &'static str);
    /// The stage now at hand has done `done` of `total` units of its own.
    fn advance(&mut self, done: u64, total: u64);
}

/// Says nothing.
pub struct Silent;

impl Progress for Silent {
    fn stage(&mut self, _: &'static str) {}
    fn advance(&mut self, _: u64, _: u64) {}
}

/// Wall and CPU time of one stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StageTime {
    /// The stage's name.
    pub name: String,
    /// Seconds on the clock.
    pub wall_seconds: f64,
    /// Seconds of processor time over all threads.
    pub cpu_seconds: f64,
}

/// What a bake made, and how it went.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The splats, rounded but for their clip curves; `fit` is not yet measured.
    pub asset: Asset,
    /// Time of each stage.
    pub stages: Vec<StageTime>,
    /// Standard deviation of a cloud's points from their surface, model units, as [`Meant::noise`].
    pub noise: Option<f64>,
    /// What was made of the input before it was baked.
    pub made: Made,
    /// What that is, unless it is the input itself.
    pub stand_in: Option<Input>,
    /// Feature edges found or matched.
    pub features: Found,
    /// How the splats were chosen.
    pub choice: Choice,
    /// What the lines do that they are cut along.
    pub edge_cases: EdgeCases,
    /// What the choice costs and what any other costs at least, if that was asked for.
    pub lower_bound: Option<LowerBound>,
    /// What came of the clip partners, if splats are cut by them.
    pub partners: Option<Tally>,
    /// Points of the surface that the splats were fitted to.
    pub samples: usize,
    /// Points of a cloud, ascending, that belong to no surface: outliers, for which the bound does not
    /// hold.
    pub left_out: Vec<u32>,
    /// Borders of a cloud and rims of its holes, those of most points first: there the sampling does not say
    /// how far the surface goes on, and splats may leave a hole or reach beyond.
    pub open_places: Vec<OpenPlace>,
    /// Where a cloud's points lie too far apart for the bound, if any do: between them the surface, and with it
    /// what splats may be off by, is known to no better than that.
    pub sparse: Option<Sparse>,
    /// Why the colours were left out, if they were.
    pub colors_left_out: Option<&'static str>,
}

/// What a splat without clip curves comes back as, under an error bound in model units, from
/// whatever will store it; `None` if it cannot be stored. For those who store nothing: `|s, _|
/// Some(s.clone())`.
pub type Rounding<'a> = dyn Fn(&Splat, f64) -> Option<Splat> + Sync + 'a;

/// Clip curves that cost whoever stores them less, within an error bound in model units, as far as they will
/// do. For those who store nothing: `|_, _, _| Ok(())`.
pub type Saving<'a> = dyn Fn(&mut [Splat], f64, &mut dyn Trial) -> Result<()> + Sync + 'a;

/// Bakes an input to splats that keep the error bound when rounded by `rounding`, and show neither hole nor
/// excess to `looking` but where no splats that keep the bound can do without.
///
/// # Errors
/// Usage errors for options out of range; input errors for an input without any surface; those of
/// `looking`.
pub fn bake(
    input: &Input,
    options: &Options,
    rounding: &Rounding<'_>,
    saving: &Saving<'_>,
    looking: &mut dyn Looking,
    progress: &mut dyn Progress,
) -> Result<Baked> {
    let mut clock = Clock::default();
    let cloud = input.cloud();
    let diagonal = diagonal(&cloud.positions);
    let max_error = model_error(options, input)?;
    clock.stage(progress, "analyse");
    let meant = meant(input, options, max_error)?;
    check_noise(&meant, options.denoise, max_error)?;
    let Analysed { mut surface, marked, features, left_out, discs, open_places, sparse } =
        analyse(&meant, options, max_error, diagonal)?;
    let mendings = if discs.is_some() { MENDINGS } else { 0 };
    if let Some(discs) = discs {
        clock.stage(progress, "look");
        looking.at(&Kept::of(&meant.input, &left_out, discs))?;
    }
    let round = |splat: &Splat| rounding(splat, max_error);
    let growing =
        Growing { budget: Budget::new(max_error, options.clips), shapes: options.shapes, round: &round };
    let mut begun = Begun::default();
    if let Some(marked) = marked {
        clock.stage(progress, "scout");
        (surface, begun) = growing.begun(surface, marked, progress);
    }
    let colors_left_out = choose_colors(&mut surface, options.colors)?;
    clock.stage(progress, "sample");
    let open = growing.open_sides(&surface);
    let grower = growing.over(&surface, &open);
    let regions = Regions::new(surface.points.len());
    let total = surface.pieces.len() as u64;
    let found = candidates(&grower, &regions, &begun, options.effort, |done| {
        progress.advance(done as u64, total);
    });
    clock.stage(progress, "cover");
    let (mut cover, mut choice) = cover(&grower, &regions, found, options.effort);
    if choice.uncovered > 0 {
        return Err(Error::Internal(format!(
            "{} pieces of the surface could not be covered",
            choice.uncovered
        )));
    }
    let lower_bound = options.lower_bound.then(|| {
        clock.stage(progress, "bound");
        cover.lower_bound()
    });
    clock.stage(progress, "clip");
    let saving = |splats: &mut [Splat], trial: &mut dyn Trial| saving(splats, max_error, trial);
    let is_along_lines = options.clips != Clips::Partners;
    if is_along_lines {
        cover.save(&grower, &regions, max_error, &saving)?;
    }
    let asset = |splats: Vec<Splat>| Asset {
        frame: cloud.frame,
        // Rounded to what a file keeps in four bytes, as the bound is.
        diagonal: f64::from(diagonal as f32),
        max_error,
        fit: Accuracy::default(),
        has_colors: !surface.colors.is_empty(),
        splats,
    };
    clock.stage(progress, "seal");
    cover.store(&grower);
    for round in 0..mendings.max(1) {
        let followed = if is_along_lines { cover.follow(&grower, &regions) } else { 0 };
        let Faults { open, beside } = looking.faults(&asset(cover.splats()))?;
        let (taken, added) =
            (cover.withdraw(&grower, &regions, &beside), cover.seal(&grower, &regions, &open));
        choice.withdrawn += taken;
        choice.sealing += added;
        choice.following += followed;
        if followed + taken + added == 0 {
            break;
        }
        // Those added leave steps, and are told anew, as the first were: what this opens is seen in the next rounds.
        if round == 0 && added > 0 && is_along_lines {
            cover.save(&grower, &regions, max_error, &saving)?;
        }
    }
    let edge_cases = cover.edge_cases(&grower, &regions);
    let chosen = cover.chosen();
    let (splats, partners) = match options.clips {
        Clips::Curved | Clips::Straight => (chosen.into_iter().map(|one| one.splat).collect(), None),
        Clips::Partners => {
            clock.stage(progress, "partners");
            let (splats, tally) = partnered(chosen, &surface, &rule(options, max_error));
            (splats, Some(tally))
        }
    };
    let asset = asset(splats);
    let samples = surface.points.len();
    let stand_in = match meant.input {
        Cow::Owned(made) => Some(made),
        Cow::Borrowed(_) => None,
    };
    let (noise, made, stages) = (meant.noise, meant.made, clock.finish());
    Ok(Baked {
        asset,
        stages,
        noise,
        made,
        stand_in,
        features,
        choice,
        edge_cases,
        lower_bound,
        partners,
        samples,
        left_out,
        open_places,
        sparse,
        colors_left_out,
    })
}

/// Length of the bounding box's diagonal.
fn diagonal(positions: &[Vec3]) -> f64 {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &p in positions {
        (low, high) = (low.min(p), high.max(p));
    }
    (high.as_dvec3() - low.as_dvec3()).length()
}

/// No refinement makes more pieces than this.
const MOST_PIECES: usize = 4_000_000;

/// Pieces are refined to this share of the radius that a splat is expected to reach.
const PIECE_SHARE: f64 = 1.0 / 6.0;

/// The size of features that a generic smooth surface has, as a share of the diagonal.
const FEATURE_SHARE: f64 = 0.25;

/// The radius that a quadric splat reaches on a generic smooth surface: there the third-order
/// term `r³ / L²` meets the error, with features of size `L`.
fn expected_radius(max_error: f64, diagonal: f64) -> f64 {
    let feature = FEATURE_SHARE * diagonal;
    libm::cbrt(max_error * feature * feature)
}

/// How a mesh becomes a surface under an error bound.
fn making(max_error: f64, diagonal: f64) -> Making<'static> {
    let reach = expected_radius(max_error, diagonal);
    let worth = Worth { reach, max_error, misfit: &misfit };
    Making { longest: piece_length(max_error, diagonal), most: MOST_PIECES, worth }
}

/// How long the sides of pieces may be.
fn piece_length(max_error: f64, diagonal: f64) -> f64 {
    PIECE_SHARE * expected_radius(max_error, diagonal)
}

/// How far points of a cloud stand for others: over areas as wide as a mesh's pieces are long.
fn thinning(max_error: f64, diagonal: f64) -> Reach {
    Reach { radius: 0.5 * piece_length(max_error, diagonal), offset: THIN_OFFSET * max_error }
}

/// A point of a cloud stands for others whose distance from its tangent plane is below this
/// share of the error bound, so that a fit to it is as good as one to all of them.
const THIN_OFFSET: f64 = 0.25;

/// The input's surface, and what was found on the way to it.
#[derive(Default)]
struct Analysed {
    surface: Surface,
    /// What a mesh's surface was made of.
    marked: Option<Marked>,
    features: Found,
    left_out: Vec<u32>,
    /// What points tell of the surface by themselves, nothing for a mesh; `None` where nobody looks.
    discs: Option<Discs>,
    open_places: Vec<OpenPlace>,
    sparse: Option<Sparse>,
}

/// Lines found that are shorter than this many error bounds, taken together with all that they
/// meet, are left out.
const SHORTEST_LINE: f64 = 8.0;

/// Given lines that lie off the edges they mean by at most this share of the diagonal are moved
/// onto them: five error bounds at the default.
const BESIDE: f64 = 0.005;

fn analyse(meant: &Meant<'_>, options: &Options, max_error: f64, diagonal: f64) -> Result<Analysed> {
    match meant.input.as_ref() {
        Input::Mesh(mesh) => {
            let features = features(mesh, &meant.edges, options.edge_angle, max_error);
            let (marked, found) = Marked::of(mesh, &features, &making(max_error, diagonal));
            // Of a smooth surface's lines, the input's are those to tell of.
            let matched = match &meant.made {
                Made::Smooth(before) => before.matched.clone(),
                Made::Itself | Made::Quiet(_) => found.matched,
            };
            let surface = marked.surface();
            let features = Found { matched, ..found };
            let (marked, discs) = (Some(marked), is_looked_at(options).then(Discs::default));
            Ok(Analysed { surface, marked, features, discs, ..Analysed::default() })
        }
        Input::Cloud(cloud) => {
            let given = given_lines(&meant.edges, &cloud.frame);
            let lines = cloud_lines(&meant.edges, &given, options.edge_angle, max_error);
            let reach = thinning(max_error, diagonal);
            let told = told_margins(options, meant.noise, diagonal);
            let CloudSurface { surface, left_out, discs, edges, open_places, sparse, matched } =
                cloud_surface(
                    cloud,
                    options.normals.into(),
                    lines,
                    meant.noise,
                    Some(reach),
                    told,
                    Some(max_error),
                )?;
            // Creases found before the cloud was smoothed are not the user's.
            let matched = matched.filter(|_| matches!(options.edges, Edges::Given(_)));
            let features = Found { feature_edges: edges, matched };
            Ok(Analysed { surface, marked: None, features, left_out, discs, open_places, sparse })
        }
    }
}

/// Which edges of a mesh are feature edges.
fn features(mesh: &Mesh, edges: &Edges, edge_angle: f64, max_error: f64) -> Features {
    match edges {
        Edges::Auto => Features::Sharp { degrees: edge_angle, shortest: SHORTEST_LINE * max_error },
        Edges::None => Features::None,
        Edges::Given(lines) => Features::Given {
            segments: segments(lines, &mesh.vertices.frame),
            beside: BESIDE * diagonal(&mesh.vertices.positions),
        },
    }
}

/// The lines that are given, model units.
fn given_lines(edges: &Edges, frame: &Frame) -> Vec<Vec<DVec3>> {
    match edges {
        Edges::Given(lines) => model_lines(lines, frame),
        Edges::Auto | Edges::None => Vec::new(),
    }
}

/// Where the feature lines of a cloud come from; those that are `given` are its [`given_lines`].
fn cloud_lines<'a>(edges: &Edges, given: &'a [Vec<DVec3>], edge_angle: f64, max_error: f64) -> Lines<'a> {
    match edges {
        Edges::Auto => Lines::Found(sought(edge_angle, max_error)),
        Edges::Given(_) | Edges::None => Lines::Given(given),
    }
}

/// Which creases of a cloud are feature lines.
fn sought(edge_angle: f64, max_error: f64) -> Sought {
    Sought { degrees: edge_angle, shortest: SHORTEST_LINE * max_error }
}

/// The lines along which a bake with these options cuts its splats, model units: feature lines,
/// and a mesh's open borders, where splats are cut as well.
///
/// A mesh's lines come as segments of two points. Lines given with a mesh are moved onto the edges
/// they mean where they lie a little off these, kept as they are where they mean none (they are lost,
/// and cut nothing). Lines given with a cloud that shows no noise are moved onto the creases they mean.
/// Lines given with a mesh or a cloud are left out where that is smooth.
/// `noise` is that of a cloud's points, model units; `edge_angle` is in degrees; `max_error`, in model
/// units, decides which found lines are too short to count. `None` where there are no lines: for a
/// smooth cloud, for a smooth closed mesh, and for [`Edges::None`].
///
/// # Errors
/// As [`cloud_creases`], for the found lines of a cloud.
pub fn feature_lines(
    input: &Input,
    edges: &Edges,
    noise: Option<f64>,
    edge_angle: f64,
    max_error: f64,
) -> Result<Option<Vec<Vec<DVec3>>>> {
    let lines = match (input, edges) {
        (_, Edges::None) => Vec::new(),
        (Input::Mesh(mesh), _) => {
            let making = making(max_error, diagonal(&mesh.vertices.positions));
            cut_lines(mesh, &features(mesh, edges, edge_angle, max_error), &making)
        }
        (Input::Cloud(cloud), Edges::Given(lines)) => {
            let lines = model_lines(lines, &cloud.frame);
            Sided::of(cloud, NormalSource::Auto, Lines::Given(&lines), noise)?.lines
        }
        (Input::Cloud(cloud), Edges::Auto) => cloud_creases(cloud, &sought(edge_angle, max_error), noise)?,
    };
    Ok((!lines.is_empty()).then_some(lines))
}

/// Lines in model units.
#[must_use]
pub fn model_lines(lines: &Polylines, frame: &Frame) -> Vec<Vec<DVec3>> {
    lines.lines.iter().map(|line| line.iter().map(|&point| frame.to_model(point)).collect()).collect()
}

/// Lines of model units in input units.
fn input_lines(lines: &[impl AsRef<[DVec3]>], frame: &Frame) -> Polylines {
    let to_input = |line: &[DVec3]| line.iter().map(|&place| frame.to_input(place)).collect();
    Polylines { lines: lines.iter().map(|line| to_input(line.as_ref())).collect() }
}

/// The segments of lines, in model units.
fn segments(lines: &Polylines, frame: &Frame) -> Vec<[DVec3; 2]> {
    let lines = model_lines(lines, frame);
    lines.iter().flat_map(|line| line.windows(2)).map(|pair| [pair[0], pair[1]]).collect()
}

/// Drops the surface's colours where they are not wanted; why, if so.
fn choose_colors(surface: &mut Surface, colors: Colors) -> Result<Option<&'static str>> {
    let differ = surface.colors.windows(2).any(|pair| pair[0] != pair[1]);
    let reason = match (colors, surface.colors.is_empty(), differ) {
        (Colors::Keep, true, _) => {
            return Err(Error::Usage("--color keep: the input has no colours".into()));
        }
        (_, true, _) => Some("the input has none"),
        (Colors::Drop, ..) => Some("dropped as asked"),
        (Colors::Auto, false, false) => Some("the input is of one colour"),
        _ => None,
    };
    if reason.is_some() {
        surface.colors.clear();
    }
    Ok(reason)
}

/// Times stages one after another.
#[derive(Default)]
pub struct Clock {
    running: Option<(&'static str, Instant, Option<ProcessTime>)>,
    done: Vec<StageTime>,
}

impl Clock {
    /// Ends the stage at hand and begins the next.
    pub fn stage(&mut self, progress: &mut dyn Progress, name: &'static str) {
        self.close();
        progress.stage(name);
        self.running = Some((name, Instant::now(), ProcessTime::try_now().ok()));
    }

    fn close(&mut self) {
        if let Some((name, wall, cpu)) = self.running.take() {
            let cpu = cpu.and_then(|start| Some(ProcessTime::try_now().ok()?.duration_since(start)));
            self.done.push(StageTime {
                name: name.into(),
                wall_seconds: wall.elapsed().as_secs_f64(),
                cpu_seconds: cpu.map_or(0.0, |time| time.as_secs_f64()),
            });
        }
    }

    /// Ends the stage at hand; the times of all.
    #[must_use]
    pub fn finish(mut self) -> Vec<StageTime> {
        self.close();
        self.done
    }
}
