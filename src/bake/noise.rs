//! How noisy a cloud is.
//!
//! Points scatter about the surface that they were taken from. No splat of more than a few points
//! keeps a bound that is below this scatter, and a splat for every few points says nothing of the
//! surface; so the scatter is measured before anything is baked.

use glam::Vec3;
use rayon::prelude::*;

use super::patch::Patch;
use crate::analyse::canonical::order;

/// Patches that are looked at, spread evenly along the Morton curve: their medians count, since
/// some patches lie across an edge.
const PATCHES: usize = 512;

/// Sizes of the patches tried, points: the least in which the surface shows. Where points scatter
/// by more than they lie apart, few of them are no patch of a surface but a ball.
const SIZES: [usize; 4] = [24, 64, 256, 1024];

/// A patch shows a surface if its radius is this many times the scatter, or more.
const WIDE: f64 = 4.0;

/// The nearest to a point are sought among this many times as many along the Morton curve.
const WINDOW: usize = 8;

/// The standard deviation of a cloud's points from its surface, model units; `None` where they show
/// no surface at any scale, and for fewer than the smallest patch has.
///
/// It is the median over patches, each fitted by a quadric, of what each point's distance from the
/// quadric differs from that of the point beside it. Detail of the surface, however fine, is much
/// the same at both and hardly counts; scatter is not (von Neumann 1941, "Distribution of the ratio
/// of the mean square successive difference to the variance").
#[must_use]
pub fn noise(positions: &[Vec3]) -> Option<f64> {
    let order = order(positions);
    let sizes = SIZES.into_iter().take_while(|&size| size <= positions.len());
    sizes.map(|size| typical(positions, &order, size)).find_map(|Typical { noise, rms, radius }| {
        let shown = WIDE * rms <= radius;
        shown.then_some(noise)
    })
}

/// Medians over patches, model units.
struct Typical {
    /// Of what the distances differ by between neighbours, as a standard deviation.
    noise: f64,
    /// Of the distances.
    rms: f64,
    radius: f64,
}

/// What patches of so many points typically are.
fn typical(positions: &[Vec3], order: &[u32], size: usize) -> Typical {
    let patches = PATCHES.min(order.len());
    let found: Vec<[f64; 3]> = (0..patches)
        .into_par_iter()
        .map(|n| {
            let seed = (2 * n + 1) * order.len() / (2 * patches);
            let from = seed.saturating_sub(WINDOW * size / 2);
            let window = &order[from..(from + WINDOW * size).min(order.len())];
            let here = positions[order[seed] as usize].as_dvec3();
            let away = |&p: &u32| positions[p as usize].as_dvec3().distance_squared(here);
            let mut near: Vec<(f64, u32)> = window.iter().map(|p| (away(p), *p)).collect();
            // Stable: of those equally far the first on the curve, whatever their order in the file.
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            near.truncate(size);
            let patch: Vec<Vec3> = near.iter().map(|&(_, p)| positions[p as usize]).collect();
            let [noise, rms] = Patch::of(&patch).scatter(&patch);
            [noise, rms, near.last().map_or(0.0, |farthest| farthest.0.sqrt())]
        })
        .collect();
    let median = |which: usize| {
        let mut values: Vec<f64> = found.iter().map(|found| found[which]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    Typical { noise: median(0), rms: median(1), radius: median(2) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::random;
    use crate::bake::scattered::sphere;

    #[test]
    fn planted_scatter_is_found_and_shape_is_not_taken_for_it() {
        // Points of this sphere lie 0.02 apart.
        for scatter in [1e-4, 1e-3, 0.01, 0.02, 0.04] {
            let found = noise(&sphere(20_000, scatter).positions).unwrap();
            assert!((0.75..1.25).contains(&(found / scatter)), "{found} for {scatter}");
        }
        assert!(noise(&sphere(20_000, 0.0).positions).unwrap() < 2e-5);
        let solid: Vec<Vec3> =
            (0..5000).map(|n| [3 * n, 3 * n + 1, 3 * n + 2].map(|n| random(n) as f32).into()).collect();
        assert_eq!(noise(&solid), None, "a solid shows no surface");
        assert_eq!(noise(&solid[..20]), None);
    }
}
