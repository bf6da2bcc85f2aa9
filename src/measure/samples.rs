//! Where surfaces are looked at: places spread evenly by area, and along borders by length. The
//! same surface has the same samples every time.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::patch::Patch;
use crate::model::mesh::Mesh;

/// Samples of a surface by area, and as many again of its vertices or its borders. Their root
/// mean square is then known to well below a hundredth, and a region of a hundred-thousandth of
/// the surface is still seen; thrice as many change neither beyond that.
pub(super) const MOST: usize = 250_000;

/// The plastic number's inverse and its square: the steps of the most even sequence of places in
/// a square (Roberts 2018, *The unreasonable effectiveness of quasirandom sequences*).
const STEPS: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);

/// A patch whose share of the box around it is below a thousandth gets fewer samples than it
/// should, of the same weight together.
const TRIES: usize = 1000;

/// The place of a number in the unit square.
fn spread(number: usize) -> DVec2 {
    (0.5 + STEPS * number as f64).fract()
}

/// A place of a mesh's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) triangle: u32,
    /// Shares of the triangle's corners, sum 1.
    pub(super) weights: DVec3,
    pub(super) at: DVec3,
}

/// Area of each triangle.
pub(super) fn areas(mesh: &Mesh) -> Vec<f64> {
    let area = |n: usize| {
        let [a, b, c] = mesh.corners(n).map(Vec3::as_dvec3);
        0.5 * (b - a).cross(c - a).length()
    };
    (0..mesh.triangles.len()).into_par_iter().map(area).collect()
}

/// [`MOST`] places of a mesh, one for each equal share of its area.
pub(super) fn on_mesh(mesh: &Mesh, areas: &[f64]) -> Vec<Spot> {
    let mut spots = Vec::new();
    for (triangle, count) in shares(areas, MOST).into_iter().enumerate() {
        let corners = mesh.corners(triangle).map(Vec3::as_dvec3);
        for _ in 0..count {
            // The square folded to a triangle.
            let mut at = spread(spots.len());
            if at.element_sum() > 1.0 {
                at = 1.0 - at;
            }
            let weights = DVec3::new(1.0 - at.x - at.y, at.x, at.y);
            let at = weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2];
            spots.push(Spot { triangle: triangle as u32, weights, at });
        }
    }
    spots
}

/// How many of `count` samples, equally spaced along the sum of all sizes, each item gets.
fn shares(sizes: &[f64], count: usize) -> Vec<usize> {
    let total: f64 = sizes.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return vec![0; sizes.len()];
    }
    let (mut sum, mut before) = (0.0, 0);
    let share = |size: &f64| {
        sum += size;
        let after = ((sum / total * count as f64 + 0.5) as usize).clamp(before, count);
        let share = after - before;
        before = after;
        share
    };
    sizes.iter().map(share).collect()
}

/// At most so many of a list, evenly chosen.
pub(super) fn thinned<T: Copy>(items: &[T], most: usize) -> Vec<T> {
    let count = items.len().min(most);
    (0..count).map(|n| items[(n as u128 * items.len() as u128 / count as u128) as usize]).collect()
}

/// A place of a patch, in model units, and the area it stands for.
pub(super) type Place = (DVec3, f64);

/// [`MOST`] places over all patches by area, then as many along their borders by length; the
/// latter have no weight. One list a patch.
pub(super) fn on_patches(patches: &[Patch<'_>]) -> Vec<Vec<Place>> {
    let areas: Vec<f64> = patches.iter().map(|patch| patch.area).collect();
    let lengths: Vec<f64> =
        patches.iter().flat_map(|patch| &patch.border).map(|s| s.ends[0].distance(s.ends[1])).collect();
    let total: f64 = areas.iter().sum();
    let inner = shares(&areas, MOST);
    let mut along = shares(&lengths, MOST);
    if along.len() <= MOST {
        // Each piece begins at a corner, where most stands out.
        along.iter_mut().for_each(|count| *count = (*count).max(1));
    }
    let mut first = 0;
    let starts: Vec<usize> = (patches.iter())
        .map(|patch| {
            first += patch.border.len();
            first - patch.border.len()
        })
        .collect();
    let each = |n: usize| {
        let patch = &patches[n];
        let mut places = inside(patch, inner[n], total / MOST as f64, n);
        let counts = &along[starts[n]..starts[n] + patch.border.len()];
        places.extend(on_border(patch, counts));
        places
    };
    (0..patches.len()).into_par_iter().map(each).collect()
}

/// Places inside a patch that stand for `weight` each.
fn inside(patch: &Patch<'_>, count: usize, weight: f64, seed: usize) -> Vec<Place> {
    let (low, high) = (patch.low.truncate(), patch.high.truncate());
    // Each patch begins elsewhere in the sequence.
    let places = (0..count.saturating_mul(TRIES)).map(|n| low + (high - low) * spread(n + 7919 * seed));
    let found: Vec<DVec2> = places.filter(|&uv| patch.covers(uv)).take(count).collect();
    let stretch = |uv: DVec2| libm::sqrt(1.0 + (2.0 * patch.splat.curvature * uv).length_squared());
    let sum: f64 = found.iter().map(|&uv| stretch(uv)).sum();
    let whole = weight * count as f64;
    found.iter().map(|&uv| (patch.splat.surface_point(uv), whole * stretch(uv) / sum)).collect()
}

/// Places along a patch's border.
fn on_border<'a>(patch: &'a Patch<'_>, counts: &'a [usize]) -> impl Iterator<Item = Place> + 'a {
    patch.border.iter().zip(counts).flat_map(move |(segment, &count)| {
        (0..count).filter_map(move |n| {
            let t = n as f64 / count as f64;
            let local = segment.lifted(patch.splat.curvature, t).0;
            (!patch.splat.partners_cut(local.truncate())).then(|| (patch.splat.to_model(local), 0.0))
        })
    })
}
