//! Splats against triangles and triangles against splats, by brute force.

use std::fmt;

use glam::{DVec2, DVec3};
use qsplat::ingest::Input;
use qsplat::model::asset::Asset;
use qsplat::model::clip_curve::Conic;
use qsplat::model::splat::Splat;
use rayon::prelude::*;

/// What was found, in error bounds.
pub struct Found {
    fit: f64,
    backward: f64,
    samples: usize,
    open: usize,
}

/// Places across an ellipse, each way.
const ACROSS: i32 = 10;

/// Places along the side of a triangle.
const ALONG: u32 = 6;

/// At the rim twice the bound is allowed.
const RIM: f64 = 2.0;

impl Found {
    /// What breaks a promise.
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if self.fit > 1.0 || self.fit.is_nan() {
            faults.push(format!("fit is {:.3} bounds", self.fit));
        }
        if self.backward > RIM || self.backward.is_nan() {
            faults.push(format!("splats stray {:.3} bounds from the triangles", self.backward));
        }
        if self.open > 0 {
            faults.push(format!("{} of {} places are bare", self.open, self.samples));
        }
        faults
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "fit {:.3}, backward {:.3} bounds, {} of {} bare",
            self.fit, self.backward, self.open, self.samples
        )
    }
}

/// Checks an asset against the mesh it was made from.
pub fn check(input: &Input, asset: &Asset) -> Found {
    let Input::Mesh(mesh) = input else { panic!("only meshes are checked") };
    let triangles: Vec<[DVec3; 3]> =
        (0..mesh.triangles.len()).map(|n| mesh.corners(n).map(|p| p.as_dvec3())).collect();
    let conics: Vec<Vec<Conic>> = asset
        .splats
        .iter()
        .map(|splat| splat.clips.iter().map(|clip| clip.conic(splat.radii)).collect())
        .collect();
    let balls: Vec<(DVec3, f64)> = triangles.iter().map(ball).collect();
    let strays = asset.splats.par_iter().zip(&conics).map(|(splat, conics)| {
        // Only triangles whose ball comes within two allowances of the splat's can matter.
        let reach = splat.bounding_radius() + 2.0 * RIM * asset.max_error;
        let near = |n: &usize| balls[*n].0.distance(splat.center) <= balls[*n].1 + reach;
        let near: Vec<usize> = (0..triangles.len()).filter(near).collect();
        let nearest = |q| near.iter().map(|&n| distance(&triangles[n], q)).fold(f64::INFINITY, f64::min);
        kept(splat, conics).into_iter().map(nearest).fold(0.0, f64::max)
    });
    let backward = strays.reduce(|| 0.0, f64::max) / asset.max_error;
    let (mut samples, mut open) = (0, 0);
    for place in triangles.iter().filter(|t| has_width(t, asset.max_error)).flat_map(places) {
        samples += 1;
        let covered = asset.splats.iter().zip(&conics).any(|(splat, conics)| {
            let local = splat.to_local(place);
            let uv = local.truncate();
            (local.z - splat.height(uv)).abs() <= RIM * asset.max_error
                && splat.ellipse(uv) <= 1.0
                && !conics.iter().any(|conic| conic.cuts(uv))
        });
        open += usize::from(!covered);
    }
    Found { fit: asset.fit.max / asset.max_error, backward, samples, open }
}

/// A ball around a triangle.
fn ball([a, b, c]: &[DVec3; 3]) -> (DVec3, f64) {
    let middle = (*a + *b + *c) / 3.0;
    (middle, middle.distance(*a).max(middle.distance(*b)).max(middle.distance(*c)))
}

/// Whether a triangle is a surface to speak of: at least as wide as the error bound.
fn has_width([a, b, c]: &[DVec3; 3], bound: f64) -> bool {
    let longest = a.distance(*b).max(b.distance(*c)).max(c.distance(*a));
    (*b - *a).cross(*c - *a).length() >= bound * longest
}

/// A grid over a triangle with its border.
fn places([a, b, c]: &[DVec3; 3]) -> Vec<DVec3> {
    let share = |n: u32| f64::from(n) / f64::from(ALONG);
    (0..=ALONG)
        .flat_map(|i| (0..=ALONG - i).map(move |j| (i, j)))
        .map(|(i, j)| *a + share(i) * (*b - *a) + share(j) * (*c - *a))
        .collect()
}

/// Points of a splat's kept domain: a grid, and the rim.
fn kept(splat: &Splat, conics: &[Conic]) -> Vec<DVec3> {
    let grid = (-ACROSS..=ACROSS).flat_map(|i| (-ACROSS..=ACROSS).map(move |j| (i, j)));
    let grid = grid.map(|(i, j)| DVec2::new(i.into(), j.into()) / f64::from(ACROSS));
    let rim = (0..96).map(|n| DVec2::from_angle(std::f64::consts::TAU * f64::from(n) / 96.0));
    grid.chain(rim)
        .filter(|unit| unit.length_squared() <= 1.0 + 1e-12)
        .map(|unit| unit * splat.radii)
        .filter(|&uv| !conics.iter().any(|conic| conic.cuts(uv)))
        .map(|uv| splat.surface_point(uv))
        .collect()
}

/// Distance from a triangle to a point: to its plane if the foot lies inside, else to a side.
fn distance(&[a, b, c]: &[DVec3; 3], q: DVec3) -> f64 {
    let side = |from: DVec3, to: DVec3| {
        let (along, length) = (to - from, from.distance_squared(to));
        let t = if length > 0.0 { ((q - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        q.distance(from + t * along)
    };
    let normal = (b - a).cross(c - a);
    let inside =
        [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| normal.dot((to - from).cross(q - from)) >= 0.0);
    if normal.length() > 0.0 && inside {
        ((q - a).dot(normal) / normal.length()).abs()
    } else {
        side(a, b).min(side(b, c)).min(side(c, a))
    }
}
