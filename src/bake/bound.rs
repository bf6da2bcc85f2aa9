//! The error bound that a bake keeps to.

use glam::Vec3;

use super::noise::noise;
use super::options::{Edges, Holes, MaxError, Options};
use super::quiet::is_noisy;
use crate::error::{Error, Result};
use crate::fit::clip::Clips;
use crate::ingest::Input;
use crate::model::outlook::outlooks;
use crate::tolerance::COARSEST_CLOSED;

/// Bounds below this share of the diagonal drown in the rounding of 32-bit positions.
const LEAST_ERROR_SHARE: f64 = 1e-6;

/// Pixels that the bound spans at most in a view along a slender mesh, which magnifies it. What stands out by two is
/// mended, but for a few pixels; where all of an outline stands out by five, mending leaves more of it and takes more
/// bytes than the narrower bound does. A pixel and a half would make parts four times as long as wide 16 % larger.
const MOST_PIXELS: f64 = 2.0;

/// The error bound of a bake in model units: that of the options to 32 bits, or less where
/// [`Holes::Close`] asks for it.
///
/// # Errors
/// [`Error::Usage`] for options out of range, and for an input without extent.
pub fn model_error(options: &Options, input: &Input) -> Result<f64> {
    let (diagonal, scale) = (diagonal(&input.cloud().positions), input.cloud().frame.scale());
    if options.clips == Clips::Partners && matches!(options.edges, Edges::Given(_)) {
        return Err(Error::Usage(
            "clip partners take no feature lines: leave --edges out, or cut along them with --clips curved"
                .into(),
        ));
    }
    if !(1..=9).contains(&options.effort) {
        return Err(Error::Usage(format!("effort {} is not within 1 to 9", options.effort)));
    }
    let error = match options.max_error {
        MaxError::Relative(share) => share * diagonal,
        MaxError::Absolute(units) => units / scale,
    };
    if diagonal <= 0.0 {
        return Err(Error::Usage(
            "all points of the input lie at one place: there is no surface to bake".into(),
        ));
    }
    if !(error > 0.0 && error.is_finite()) {
        return Err(Error::Usage(
            "the error bound must be greater than zero; give --max-error in the input's units".into(),
        ));
    }
    if error < LEAST_ERROR_SHARE * diagonal {
        return Err(Error::Usage(format!(
            "the error bound is {:.1e} of the model's size, finer than positions are kept; the least is {:.1e}",
            error / diagonal,
            LEAST_ERROR_SHARE
        )));
    }
    let closed = closed(input, diagonal);
    let narrowed = options.holes == Holes::Close && error > closed && !is_rough(input, closed);
    Ok(no_looser(if narrowed { closed } else { error }))
}

/// The coarsest bound, model units, at which pictures of an input need show neither hole nor excess.
///
/// A cloud's is that of a model as wide as it is long: views that magnify a slender one show more of the gaps between
/// its points than the bound does.
fn closed(input: &Input, diagonal: f64) -> f64 {
    let widest = COARSEST_CLOSED * diagonal;
    match input {
        Input::Cloud(_) => widest,
        Input::Mesh(mesh) => {
            let pixels = outlooks(&mesh.vertices.positions).into_iter().map(|outlook| outlook.pixel());
            let magnified = MOST_PIXELS * pixels.fold(f64::INFINITY, f64::min);
            widest.min(magnified).max(LEAST_ERROR_SHARE * diagonal)
        }
    }
}

/// Whether a cloud scatters too much for a bound (model units) to be worth keeping unasked, or shows no surface.
fn is_rough(input: &Input, bound: f64) -> bool {
    match input {
        Input::Mesh(_) => false,
        Input::Cloud(cloud) => noise(cloud).is_none_or(|noise| is_noisy(noise, bound)),
    }
}

/// The greatest bound of 32 bits, which a file keeps in four bytes, that is no looser than this one.
fn no_looser(bound: f64) -> f64 {
    let nearest = bound as f32;
    f64::from(if f64::from(nearest) > bound { nearest.next_down() } else { nearest })
}

/// Length of the bounding box's diagonal.
pub(super) fn diagonal(positions: &[Vec3]) -> f64 {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &p in positions {
        (low, high) = (low.min(p), high.max(p));
    }
    (high.as_dvec3() - low.as_dvec3()).length()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::random;
    use crate::bake::scattered::sphere;
    use crate::model::cloud::Cloud;
    use crate::model::mesh::Mesh;
    use glam::Vec3;

    /// The bound of a cloud that 1 % is asked for, as a share of its diagonal.
    fn kept(cloud: Cloud, holes: Holes) -> f64 {
        let diagonal = diagonal(&cloud.positions);
        let options = Options { max_error: MaxError::Relative(0.01), holes, ..Options::default() };
        model_error(&options, &Input::Cloud(cloud)).unwrap() / diagonal
    }

    /// A bar of some length, one wide, that 0.1 % is asked for: the bound kept, as a share of its diagonal.
    fn kept_of_bar(length: f32, holes: Holes) -> f64 {
        let corner = |n: u8| {
            let side = |bit: u8, size: f32| if n >> bit & 1 == 0 { 0.0 } else { size };
            Vec3::new(side(0, 1.0), side(1, length), side(2, 1.0))
        };
        let vertices = Cloud { positions: (0..8).map(corner).collect(), ..Cloud::default() };
        let diagonal = diagonal(&vertices.positions);
        let bar = Mesh { vertices, triangles: vec![[0, 1, 2], [1, 2, 3]], ..Mesh::default() };
        let options = Options { max_error: MaxError::Relative(1e-3), holes, ..Options::default() };
        model_error(&options, &Input::Mesh(bar)).unwrap() / diagonal
    }

    #[test]
    fn the_bound_of_a_slender_mesh_is_narrowed_to_what_views_along_it_show() {
        let near = |found: f64, to: f64| (found / to - 1.0).abs() < 1e-3;
        assert!(near(kept_of_bar(3.0, Holes::Close), 1e-3), "1.6 pixels");
        // Seen from its end, its width fills 0.95 of 512 pixels.
        let two_pixels = 2.0 / (0.95 * 512.0);
        for length in [10.0, 100.0_f32] {
            let diagonal = f64::from(length).hypot(2.0_f64.sqrt());
            assert!(near(kept_of_bar(length, Holes::Close), two_pixels / diagonal), "{length}");
        }
        assert!(near(kept_of_bar(1e6, Holes::Close), LEAST_ERROR_SHARE), "no finer than positions are kept");
        assert!(near(kept_of_bar(100.0, Holes::Leave), 1e-3));
    }

    #[test]
    fn a_coarse_bound_of_a_cloud_is_narrowed_to_a_pixel_unless_it_is_noisy() {
        let near = |found: f64, to: f64| (found / to - 1.0).abs() < 1e-6;
        // The sphere's diagonal is 2.77, a pixel's share of it 0.0035.
        for scatter in [0.0, 4e-4] {
            assert!(near(kept(sphere(20_000, scatter), Holes::Close), COARSEST_CLOSED), "{scatter}");
        }
        let asked = [kept(sphere(20_000, 8e-4), Holes::Close), kept(sphere(20_000, 0.0), Holes::Leave)];
        assert!(asked.iter().all(|&kept| near(kept, 0.01)), "{asked:?}");
        let solid = (0..5000).map(|n| [3 * n, 3 * n + 1, 3 * n + 2].map(|n| random(n) as f32).into());
        let solid = Cloud { positions: solid.collect(), ..Cloud::default() };
        assert!(near(kept(solid, Holes::Close), 0.01), "points that show no surface have no outline");
    }
}
