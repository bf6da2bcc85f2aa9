//! The recipe: from a mesh or cloud to an asset, one stage a line.

mod analysed;
mod bound;
mod clock;
pub mod found_lines;
mod growing;
pub mod kept;
mod lines;
pub mod looking;
pub mod meant;
mod mending;
pub mod noise;
pub mod options;
mod partnered;
mod patch;
pub mod quiet;
#[cfg(test)]
mod scattered;

use std::borrow::Cow;

use crate::analyse::cloud_surface::{OpenPlace, Sparse};
use crate::analyse::mesh_surface::Found;
use crate::analyse::partners::Tally;
use crate::analyse::surface::Surface;
use crate::error::{Error, Result};
pub use crate::fit::clip::Clips;
pub use crate::fit::pose::Shapes;
use crate::ingest::Input;
use crate::model::asset::{Accuracy, Asset};
use crate::model::splat::Splat;
use crate::model::trial::Trial;
use crate::sample::budget::Budget;
use crate::sample::candidates::{Regions, candidates};
use crate::sample::cover::{Choice, cover};
use crate::sample::edge_cases::EdgeCases;
use crate::sample::lower_bound::LowerBound;
use crate::sample::scout::Begun;
use analysed::{Analysed, analyse};
use bound::diagonal;
pub use bound::model_error;
pub use clock::{Clock, Progress, Silent, StageTime};
pub use found_lines::found_lines;
use growing::Growing;
pub use kept::{Kept, kept};
pub use lines::{feature_lines, model_lines};
pub use looking::{Blind, Looking};
use meant::check_noise;
pub use meant::{Made, Meant, meant};
use mending::{MENDINGS, Mending};
pub use options::{Colors, DEFAULT_EFFORT, Edges, Holes, MaxError, Meaning, Normals, Options};
use partnered::{partnered, rule};

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
/// whatever will store it; `None` if it cannot be stored. The last number is how many times the steps
/// that it is rounded to are halved at least. For those who store nothing: `|s, _, _| Some(s.clone())`.
pub type Rounding<'a> = dyn Fn(&Splat, f64, u8) -> Option<Splat> + Sync + 'a;

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
    let mendings = if discs.is_some() { MENDINGS } else { 1 };
    if let Some(discs) = discs {
        clock.stage(progress, "look");
        looking.at(&Kept::of(&meant.input, &left_out, discs))?;
    }
    let round = |splat: &Splat, fineness: u8| rounding(splat, max_error, fineness);
    let budget = Budget::new(max_error, options.clips).moved_by(features.sewn.moved);
    let growing = Growing { budget, shapes: options.shapes, round: &round };
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
    check_covered(&choice)?;
    let lower_bound = options.lower_bound.then(|| {
        clock.stage(progress, "bound");
        cover.lower_bound()
    });
    let asset = |splats: Vec<Splat>| Asset {
        frame: cloud.frame,
        // Rounded to what a file keeps in four bytes, as the bound is.
        diagonal: f64::from(diagonal as f32),
        max_error,
        fit: Accuracy::default(),
        has_colors: !surface.colors.is_empty(),
        splats,
    };
    let saving = (options.clips != Clips::Partners).then_some(saving);
    let mending = Mending { grower: &grower, regions: &regions, max_error, saving, asset: &asset };
    clock.stage(progress, "clip");
    mending.save(&mut cover)?;
    clock.stage(progress, "seal");
    cover.store(&grower);
    mending.mend(&mut cover, &mut choice, mendings, looking)?;
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

fn check_covered(choice: &Choice) -> Result<()> {
    match choice.uncovered {
        0 => Ok(()),
        some => Err(Error::Internal(format!("{some} pieces of the surface could not be covered"))),
    }
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
