//! The whole line in one call: bake, encode, decode again, measure.
//!
//! The error that a file states is measured on the splats as a reader will decode them.

use glam::Vec3;

use crate::analyse::canonical;
use crate::bake::{Baked, Clock, Options, Progress, StageTime, bake};
use crate::error::{Error, Result};
use crate::format::{self, quantize::Quantizer};
use crate::ingest::Input;
use crate::measure::fit::fit;
use crate::model::asset::Asset;
use crate::model::splat::Splat;

/// A finished file and how it came about.
#[derive(Clone, Debug)]
pub struct Delivery {
    /// The bytes of the `.qsplat`.
    pub bytes: Vec<u8>,
    /// The asset as those bytes decode.
    pub asset: Asset,
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
    let rounding = |splat: &Splat, max_error| Quantizer::new(max_error).snap(splat).ok();
    let baked = bake(input, options, &rounding, progress)?;
    let mut clock = Clock::default();
    clock.stage(progress, "encode");
    let bytes = format::encode(&baked.asset)?;
    let mut asset = format::decode(&bytes, &format::Limits::default())?;
    clock.stage(progress, "measure");
    measure(input, &baked.left_out, &mut asset)?;
    clock.stage(progress, "encode");
    // Encoding what was decoded changes nothing but the measured error.
    let bytes = format::encode(&asset)?;
    let mut stages = baked.stages.clone();
    stages.extend(clock.finish());
    Ok(Delivery { bytes, asset, stages, baked })
}

/// Measures the fit of the decoded splats and holds it against the bound.
fn measure(input: &Input, left_out: &[u32], asset: &mut Asset) -> Result<()> {
    let points = measured_points(input, left_out);
    // Farther off than a few bounds lies another sheet of the surface.
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

/// Bounds of distance within which a splat is taken to stand for a point.
const REACH: f64 = 4.0;

/// The points the bound holds for: those of a cloud that belong to its surface, those of a
/// mesh that its triangles use.
///
/// Each place counts once, in an order of its own: how often an input repeats a point, along
/// seams say, tells nothing of the surface, and neither may change the last bit of a sum.
fn measured_points(input: &Input, left_out: &[u32]) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = match input {
        Input::Cloud(cloud) => {
            let mut rest = left_out.iter().peekable();
            let all = (0_u32..).zip(&cloud.positions);
            all.filter(|(n, _)| rest.next_if_eq(&n).is_none()).map(|(_, p)| *p).collect()
        }
        Input::Mesh(mesh) => {
            let mut used = vec![false; mesh.vertices.positions.len()];
            for &vertex in mesh.triangles.as_flattened() {
                used[vertex as usize] = true;
            }
            mesh.vertices.positions.iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| *p).collect()
        }
    };
    points = canonical::order(&points).into_iter().map(|n| points[n as usize]).collect();
    points.dedup();
    points
}
