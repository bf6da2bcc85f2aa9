//! How noisy a cloud is.
//!
//! Points scatter about the surface that they were taken from. No splat of more than a few points
//! keeps a bound that is below this scatter, and a splat for every few points says nothing of the
//! surface; so the scatter is measured before anything is baked.

use glam::{DQuat, Vec3};
use rayon::prelude::*;

use super::patch::Patch;
use crate::analyse::canonical::order_along;
use crate::ingest::Input;
use crate::model::cloud::Cloud;

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

/// A place turned by an odd angle about an odd axis, at half the size. Faces lie along the axes more often than
/// not; so do the planes between cells of the Morton curve, and one that lies in a face would part
/// the points above it from those below, which scatter less.
fn turned(p: Vec3) -> Vec3 {
    // Half the size: a turned corner of the cube is as far out as √3.
    (0.5 * (DQuat::from_xyzw(2.0, 3.0, 5.0, 7.0).normalize() * p.as_dvec3())).as_vec3()
}

/// The standard deviation of a cloud's points from its surface, model units; `None` where they show
/// no surface at any scale, and for fewer than the smallest patch has.
///
/// It is the median over patches, each fitted by a quadric, of what each point's distance from the
/// quadric differs from that of the point beside it. Detail of the surface, however fine, is much
/// the same at both and hardly counts; scatter is not (von Neumann 1941, "Distribution of the ratio
/// of the mean square successive difference to the variance").
#[must_use]
pub fn noise(cloud: &Cloud) -> Option<f64> {
    let order = settled(cloud);
    let sizes = SIZES.into_iter().take_while(|&size| size <= order.len());
    sizes.map(|size| typical(cloud, &order, size)).find_map(|Typical { noise, rms, radius }| {
        let shown = WIDE * rms <= radius;
        shown.then_some(noise)
    })
}

/// That of an input: none for a mesh.
#[must_use]
pub fn input_noise(input: &Input) -> Option<f64> {
    match input {
        Input::Mesh(_) => None,
        Input::Cloud(cloud) => noise(cloud),
    }
}

/// The points in the order of where they lie and which way they face, whatever their order in the file.
fn settled(cloud: &Cloud) -> Vec<u32> {
    let mut order = order_along(&cloud.positions, turned);
    let place = |n: u32| cloud.positions[n as usize];
    if !cloud.normals.is_empty() {
        for same in order.chunk_by_mut(|&a, &b| place(a) == place(b)) {
            same.sort_unstable_by_key(|&n| cloud.normals[n as usize].to_array().map(f32::to_bits));
        }
    }
    order
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
fn typical(cloud: &Cloud, order: &[u32], size: usize) -> Typical {
    let patches = PATCHES.min(order.len());
    let found: Vec<[f64; 3]> = (0..patches)
        .into_par_iter()
        .map(|n| {
            let seed = (2 * n + 1) * order.len() / (2 * patches);
            let from = seed.saturating_sub(WINDOW * size / 2);
            let window = &order[from..(from + WINDOW * size).min(order.len())];
            let (patch, radius) = around(cloud, window, order[seed], size);
            let [noise, rms] = Patch::of(&patch).scatter(&patch);
            [noise, rms, radius]
        })
        .collect();
    let median = |which: usize| {
        let mut values: Vec<f64> = found.iter().map(|found| found[which]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    Typical { noise: median(0), rms: median(1), radius: median(2) }
}

/// The nearest points to one of a window, so many, and how far they reach. Those whose normals say that they
/// are of another sheet are left out, unless too few are left.
fn around(cloud: &Cloud, window: &[u32], seed: u32, size: usize) -> (Vec<Vec3>, f64) {
    let here = cloud.positions[seed as usize].as_dvec3();
    let away = |&p: &u32| cloud.positions[p as usize].as_dvec3().distance_squared(here);
    let mut near: Vec<(f64, u32)> = window.iter().map(|p| (away(p), *p)).collect();
    // Stable: of those equally far the first on the curve, whatever their order in the file.
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some(normal) = cloud.normals.get(seed as usize) {
        let faces = |&(_, p): &(f64, u32)| cloud.normals[p as usize].dot(*normal) > 0.0;
        let same: Vec<(f64, u32)> = near.iter().copied().filter(faces).take(size).collect();
        if same.len() == size {
            near = same;
        }
    }
    near.truncate(size);
    let radius = near.last().map_or(0.0, |farthest| farthest.0.sqrt());
    (near.iter().map(|&(_, p)| cloud.positions[p as usize]).collect(), radius)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::{normal, random};
    use crate::bake::scattered::sphere;

    fn cloud(places: impl Iterator<Item = [f64; 3]>) -> Cloud {
        Cloud { positions: places.map(|place| place.map(|x| x as f32).into()).collect(), ..Cloud::default() }
    }

    #[test]
    fn sheets_that_face_either_way_are_two() {
        // Of either sheet the points lie 0.02 apart, as far as the sheets do.
        let side = |n: u64| if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        let place = |n: u64| [random(2 * n), random(2 * n + 1), 0.01 * side(n) + 1e-3 * normal(n)];
        let cloud = cloud((0..20_000).map(place));
        let normals = (0..20_000).map(|n| Vec3::Z * side(n) as f32).collect();
        assert!((0.9e-3..1.1e-3).contains(&noise(&Cloud { normals, ..cloud }).unwrap()));
    }

    #[test]
    fn faces_along_the_axes_scatter_as_much_as_others() {
        // 0.25 is a plane between cells of the Morton curve; the points lie 0.02 apart.
        for scatter in [1e-3, 0.01] {
            let place = |n: u64| [random(2 * n), random(2 * n + 1), 0.25 + scatter * normal(n)];
            let found = noise(&cloud((0..10_000).map(place))).unwrap();
            assert!((0.9..1.1).contains(&(found / scatter)), "{found} for {scatter}");
        }
    }

    #[test]
    fn planted_scatter_is_found_and_shape_is_not_taken_for_it() {
        // Points of this sphere lie 0.02 apart.
        for scatter in [1e-4, 1e-3, 0.01, 0.02, 0.04] {
            let found = noise(&sphere(20_000, scatter)).unwrap();
            assert!((0.75..1.25).contains(&(found / scatter)), "{found} for {scatter}");
        }
        assert!(noise(&sphere(20_000, 0.0)).unwrap() < 2e-5);
        let solid = cloud((0..5000).map(|n| [3 * n, 3 * n + 1, 3 * n + 2].map(random)));
        assert_eq!(noise(&solid), None, "a solid shows no surface");
        let few = Cloud { positions: solid.positions[..20].to_vec(), ..solid };
        assert_eq!(noise(&few), None);
    }
}
