//! `forward`, `backward`, `normal` and `overlap`: the splats' surface against the input's.
//!
//! The splats' surface is what they are, quadrics over their clipped domains; nothing is
//! tessellated. A mesh's surface is its triangles. A cloud's is what fits its points locally:
//! around each point the least-squares quadric of its 20 nearest neighbours, as far to the side
//! as the first ring of them.
//!
//! Samples are spread evenly by area, 250 thousand for either way, so that `rms` and `p99` are
//! means over the area. `max` looks at more: at a mesh's vertices, along the splats' rims and
//! clip curves, where what stands out does so the farthest, and uphill from the worst samples.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::climb;
use super::input_surface::{InputSurface, Probe, Shape};
use super::measures::{Angles, Distances};
use super::patches::Patches;
use super::samples::{self, MOST};
use super::spread::{self, Sample};
use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::model::mesh::Mesh;
use crate::tolerance::DEFAULT_EDGE_ANGLE;

/// How far the splats' surfaces and the input's lie from each other. Distances and places in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceErrors {
    /// From samples of the input's surface to the union of the clipped splats. Of a cloud, from
    /// its points.
    pub forward: Distances,
    /// From samples of the clipped splats to the input's surface.
    pub backward: Distances,
    /// Between the normal of the input's surface, as a picture of it is shaded by default, and the
    /// splats' at the nearest place.
    ///
    /// Beside a feature edge the nearest place may lie on the splat across it. So where the nearest
    /// normal is off by more than the default edge angle, all places count that are farther than
    /// the nearest by at most the error bound, and of them the one whose normal agrees best. A
    /// cloud's own normals count as they are, fitted ones for either sign.
    pub normal: Angles,
    /// Sum of the clipped splats' areas over the mesh's area; `None` for a cloud.
    pub overlap: Option<f64>,
}

/// Samples that one thread takes in a row: near to each other, each bounds the search of the next.
const RUN: usize = 1024;

/// Measures the surfaces against each other.
///
/// # Errors
/// [`Error::Usage`] if the file has no surface, or they do not lie in one frame.
pub fn surface(asset: &Asset, input: &InputSurface<'_>) -> Result<SurfaceErrors> {
    if asset.frame != input.frame {
        return Err(Error::Usage(
            "the file was baked from another input: the two do not lie at the same place".into(),
        ));
    }
    let patches = Patches::new(asset);
    if patches.area() <= 0.0 {
        return Err(Error::Usage("the file has no splat of which anything is left to measure".into()));
    }
    let Forward { samples, normal, worst } = forward(asset, &patches, &input.probes);
    Ok(match &input.shape {
        Shape::Mesh { triangles, area } => {
            let step = (area / MOST as f64).sqrt();
            let around = |at, step| climb::around(at, step).filter_map(|place| triangles.closest(place));
            let distance = |at| patches.nearest(at, &mut None).map(|nearest| nearest.distance);
            let forward = spread::placed(&samples, climb::highest(&worst, step, around, distance));
            let backward = backward(&patches, |at, last| triangles.distance(at, last));
            SurfaceErrors { forward, backward, normal, overlap: Some(patches.area() / area) }
        }
        Shape::Cloud(fit) => {
            let forward = spread::placed(&samples, None);
            let backward = backward(&patches, |at, _| Some(fit.distance(at)));
            SurfaceErrors { forward, backward, normal, overlap: None }
        }
    })
}

/// Sum of the clipped splats' areas over a mesh's area, as in [`SurfaceErrors`]; `None` if it has none.
#[must_use]
pub fn overlap(asset: &Asset, mesh: &Mesh) -> Option<f64> {
    let area: f64 = samples::areas(mesh).iter().sum();
    (area > 0.0).then(|| Patches::new(asset).area() / area)
}

/// What the probes find.
struct Forward {
    /// The probes' distances.
    samples: Vec<(DVec3, Sample)>,
    /// Their angles.
    normal: Angles,
    /// The worst of them with their distances.
    worst: Vec<(DVec3, f64)>,
}

fn forward(asset: &Asset, patches: &Patches<'_>, probes: &[Probe]) -> Forward {
    let measured: Vec<((DVec3, Sample), Option<Sample>)> = probes
        .par_chunks(RUN)
        .flat_map_iter(|run| {
            let mut last = None;
            run.iter().filter_map(move |probe| {
                let nearest = patches.nearest(probe.at, &mut last)?;
                let turned = probe.weight > 0.0 && probe.normal != DVec3::ZERO;
                let angle = turned.then(|| {
                    let angle = probe.angle(patches.normal(&nearest));
                    if angle <= DEFAULT_EDGE_ANGLE {
                        return angle;
                    }
                    let near = patches.within(probe.at, nearest.distance + asset.max_error);
                    near.iter().map(|place| probe.angle(patches.normal(place))).fold(angle, f64::min)
                });
                let angle = angle.map(|angle| (angle, probe.weight));
                Some(((probe.at, (nearest.distance, probe.weight)), angle))
            })
        })
        .collect();
    let (samples, angles): (Vec<(DVec3, Sample)>, Vec<Option<Sample>>) = measured.into_iter().unzip();
    let angles: Vec<Sample> = angles.into_iter().flatten().collect();
    let heights: Vec<(DVec3, f64)> = samples.iter().map(|&(at, (distance, _))| (at, distance)).collect();
    let starts = climb::starts(&heights, (patches.area() / MOST as f64).sqrt());
    let worst = starts.into_iter().map(|n| heights[n]).collect();
    Forward { samples, normal: spread::angles(&angles), worst }
}

/// From the splats to whatever gives distances; it is handed the place before and its distance.
fn backward(
    patches: &Patches<'_>,
    distance: impl Fn(DVec3, &mut Option<(DVec3, f64)>) -> Option<f64> + Sync,
) -> Distances {
    let places = samples::on_patches(&patches.patches);
    let measured: Vec<(usize, DVec3, Sample)> = places
        .par_iter()
        .enumerate()
        .flat_map_iter(|(patch, places)| {
            let mut last = None;
            let distance = &distance;
            places
                .iter()
                .filter_map(move |&(at, weight)| Some((patch, at, (distance(at, &mut last)?, weight))))
        })
        .collect();
    let samples: Vec<(DVec3, f64)> = measured.iter().map(|sample| (sample.1, sample.2.0)).collect();
    let step = (patches.area() / MOST as f64).sqrt();
    let start = |n: usize| {
        let (patch, at, (height, _)) = measured[n];
        ((patch, patches.patches[patch].splat.to_local(at).truncate()), height)
    };
    let worst: Vec<_> = climb::starts(&samples, step).into_iter().map(start).collect();
    let around = |(patch, uv): (usize, DVec2), step| {
        patches.patches[patch].around(uv, step).map(move |to| (patch, to))
    };
    let place = |(patch, uv): (usize, DVec2)| patches.patches[patch].splat.surface_point(uv);
    let top = climb::highest(&worst, step, around, |at| distance(place(at), &mut None));
    let samples: Vec<(DVec3, Sample)> = measured.iter().map(|&(_, at, sample)| (at, sample)).collect();
    spread::placed(&samples, top.map(|(at, height)| (place(at), height)))
}

#[cfg(test)]
#[path = "surface_tests.rs"]
mod tests;
