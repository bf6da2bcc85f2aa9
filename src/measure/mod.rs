//! Numbers that say how good a result is: every error and cost of a file against its input.

pub mod align;
mod area;
mod border;
mod box_tree;
mod climb;
mod cloud_fit;
pub mod cost;
mod covered;
#[cfg(test)]
pub(crate) mod documented;
pub mod edge;
mod feet;
pub mod fit;
pub mod holes;
pub mod image;
pub mod input_surface;
pub mod measures;
mod patch;
#[cfg(test)]
mod patch_tests;
mod patches;
#[cfg(test)]
mod planted;
mod point_grid;
pub mod recall;
pub mod reference;
mod roots;
mod samples;
pub mod seen;
mod segment;
pub mod sights;
mod spread;
mod steps;
pub mod surface;
mod triangles;
pub mod views;

use glam::DVec3;

use crate::error::Result;
use crate::model::asset::Asset;
use crate::render::input::Model;
pub use measures::Measures;
use measures::{CLOUD, Cost, Distances, MESH, SCHEMA, Steps};
pub use reference::Reference;

/// What is measured, and against what.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The file as it is.
    pub bytes: &'a [u8],
    /// The file as decoded.
    pub asset: &'a Asset,
    /// The input it was baked from. One that lies in another frame is sampled and drawn again in
    /// the asset's; [`align::bring`] brings it there beforehand.
    pub against: &'a Reference<'a>,
    /// The feature lines, in the reference's model units; `None` leaves `edge` out.
    pub lines: Option<&'a [Vec<DVec3>]>,
}

/// Measures everything but the graphics device.
///
/// # Errors
/// [`crate::Error::Usage`] if file and input do not belong together.
pub fn measure(subject: &Subject<'_>) -> Result<Measures> {
    measure_telling(subject, &mut |_| ())
}

/// As [`measure`]; `tell` hears the name of each stage as it begins.
///
/// # Errors
/// As [`measure`].
pub fn measure_telling(subject: &Subject<'_>, tell: &mut dyn FnMut(&'static str)) -> Result<Measures> {
    let model = subject.against.model;
    let frames = [&model.cloud().frame, &subject.asset.frame];
    align::check(frames[0], subject.against.diagonal, subject.asset)?;
    if frames[0] == frames[1] {
        return against(subject.against, subject, subject.lines, tell);
    }
    tell("reference");
    let lines = subject.lines.map(|lines| align::lines(lines, frames[0], frames[1]));
    let aligned = align::bring(model, subject.asset);
    let again = Reference::standing_for(aligned.model(), subject.asset.diagonal)?;
    let reference = Reference { outliers: subject.against.outliers, ..again };
    against(&reference, subject, lines.as_deref(), tell)
}

/// Measures against a reference in the asset's frame, with lines in that frame.
fn against(
    reference: &Reference<'_>,
    subject: &Subject<'_>,
    lines: Option<&[Vec<DVec3>]>,
    tell: &mut dyn FnMut(&'static str),
) -> Result<Measures> {
    let asset = subject.asset;
    tell("fit");
    let fit = fit::fit(&reference.points, asset, fit::REACH * asset.max_error);
    tell("surface");
    let surface = surface::surface(asset, &reference.surface)?;
    tell("edge");
    let edge = lines.and_then(|lines| edge::edge(asset, lines));
    let steps = steps::steps(asset);
    tell("views");
    let seen = seen::seen(asset, &reference.drawn)?;
    tell("cost");
    let (model, outliers) = (reference.model, reference.outliers);
    let read = model.cloud().positions.len() + outliers;
    let cost = cost::cost(subject.bytes, asset, read, reference.views())?;
    // An asset of one point has no diagonal: its errors are zero, not infinite.
    let share = |length: f64| if asset.diagonal > 0.0 { length / asset.diagonal } else { 0.0 };
    let at = fit.worst.map(|at| at.as_dvec3().to_array());
    let accuracy = Distances { rms: fit.accuracy.rms, p99: fit.accuracy.p99, max: fit.accuracy.max, at };
    let shares = |d: Distances| Distances {
        rms: share(d.rms),
        p99: share(d.p99),
        max: share(d.max),
        at: d.at.map(|at| asset.frame.to_input(at.into()).to_array()),
    };
    Ok(Measures {
        schema: SCHEMA.into(),
        diagonal: asset.diagonal * asset.frame.scale(),
        kind: if matches!(model, Model::Mesh(_)) { MESH } else { CLOUD }.into(),
        budget: share(asset.max_error),
        outliers: outliers as u64,
        fit: shares(accuracy),
        uncovered: fit.uncovered as u64,
        forward: shares(surface.forward),
        backward: shares(surface.backward),
        normal: surface.normal,
        edge: edge.map(shares),
        steps: steps.map(|steps| Steps { max: share(steps.max), ..steps }),
        holes: seen.holes,
        image: seen.image,
        views: seen.views,
        cost: Cost { overlap: surface.overlap, fragments: seen.fragments, ..cost },
    })
}
