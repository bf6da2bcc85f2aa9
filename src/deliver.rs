//! The whole line in one call: bake, encode, decode again, measure.
//!
//! The error that a file states is measured on the splats as a reader will decode them.

use crate::bake::{Baked, Clock, Kept, Looking, Options, Progress, StageTime, bake};
use crate::error::{Error, Result};
use crate::format::{self, quantize::Quantizer};
use crate::ingest::Input;
use crate::measure::fit::{REACH, fit, points};
use crate::measure::sights::Sights;
use crate::measure::surface::overlap;
use crate::model::asset::Asset;
use crate::model::sight::Faults;
use crate::model::splat::Splat;
use crate::render::input::Model;

/// A finished file and how it came about.
#[derive(Clone, Debug)]
pub struct Delivery {
    /// The bytes of the `.qsplat`.
    pub bytes: Vec<u8>,
    /// The asset as those bytes decode.
    pub asset: Asset,
    /// Sum of the clipped splats' areas over the area of the mesh; `None` for a cloud.
    pub overlap: Option<f64>,
    /// Time of each stage.
    pub stages: Vec<StageTime>,
    /// The bake.
    pub baked: Baked,
}

/// Bakes an input to a file's bytes.
///
/// # Errors
/// Those of [`bake`]; [`Error::Internal`] should the decoded splats break the bound.
pub fn deliver(input: &Input, options: &Options, progress: &mut dyn Progress) -> Result<Delivery> {
    let rounding = |splat: &Splat, max_error, fineness| {
        let quantizer = Quantizer::new(max_error);
        quantizer.snap_within(splat, fineness).ok()
    };
    let baked = bake(input, options, &rounding, &format::thrift::save, &mut Onlooker::default(), progress)?;
    let mut clock = Clock::default();
    clock.stage(progress, "encode");
    let bytes = format::encode(&baked.asset)?;
    let mut asset = format::decode(&bytes, &format::Limits::default())?;
    clock.stage(progress, "measure");
    let meant = baked.stand_in.as_ref().unwrap_or(input);
    measure(model(meant), &baked.left_out, &mut asset)?;
    let overlap = match meant {
        Input::Mesh(mesh) => overlap(&asset, mesh),
        Input::Cloud(_) => None,
    };
    clock.stage(progress, "encode");
    // Encoding what was decoded changes nothing but the measured error, which the header rounds.
    let bytes = format::encode(&asset)?;
    let asset = format::decode(&bytes, &format::Limits::default())?;
    let mut stages = baked.stages.clone();
    stages.extend(clock.finish());
    Ok(Delivery { bytes, asset, overlap, stages, baked })
}

/// Looks at assets as they are once they are stored.
#[derive(Default)]
struct Onlooker {
    /// What is known of the input.
    sights: Option<Sights>,
}

impl Looking for Onlooker {
    fn at(&mut self, kept: &Kept<'_>) -> Result<()> {
        self.sights = Some(Sights::of(surface(kept))?);
        Ok(())
    }

    fn faults(&mut self, asset: &Asset) -> Result<Faults> {
        let Some(sights) = &mut self.sights else { return Ok(Faults::default()) };
        sights.faults(&format::snap(asset)?)
    }
}

/// Measures the fit of the decoded splats and holds it against the bound.
fn measure(model: Model<'_>, left_out: &[u32], asset: &mut Asset) -> Result<()> {
    let points = points(model, left_out);
    let found = fit(&points, asset, REACH * asset.max_error);
    if found.uncovered > 0 || found.accuracy.max > asset.max_error {
        return Err(Error::Internal(format!(
            "of {} points {} are not covered, and the greatest error is {:.3} of the bound",
            points.len(),
            found.uncovered,
            found.accuracy.max / asset.max_error
        )));
    }
    asset.fit = found.accuracy;
    Ok(())
}

/// What a bake keeps of an input as it is measured: a cloud as the surface that it tells of.
#[must_use]
pub fn surface<'a>(kept: &'a Kept<'_>) -> Model<'a> {
    match kept.input.as_ref() {
        Input::Mesh(mesh) => Model::Mesh(mesh),
        Input::Cloud(cloud) => Model::Surface(cloud, &kept.discs),
    }
}

/// An input as it is drawn by itself.
#[must_use]
pub fn model(input: &Input) -> Model<'_> {
    match input {
        Input::Mesh(mesh) => Model::Mesh(mesh),
        Input::Cloud(cloud) => Model::Cloud(cloud),
    }
}
