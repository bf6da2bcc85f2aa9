//! Which splats the quantiser takes, and in which of their two spellings.

use glam::{DMat3, DVec2};

use crate::error::{Error, Result};
use crate::model::splat::Splat;

/// Axes may deviate this much from orthonormal; a bake's stay below 1e-12.
const ORTHONORMAL: f64 = 1e-6;

/// The same splat with its axes named the other way round: `u' = v, v' = -u`.
#[must_use]
pub fn quarter_turn(splat: &Splat) -> Splat {
    let [i, j, k] = [splat.axes.x_axis, splat.axes.y_axis, splat.axes.z_axis];
    let mut turned = splat.clone();
    turned.axes = DMat3::from_cols(j, -i, k);
    turned.radii = DVec2::new(splat.radii.y, splat.radii.x);
    turned.curvature = DVec2::new(splat.curvature.y, splat.curvature.x);
    for clip in &mut turned.clips {
        for alpha in [&mut clip.alpha1, &mut clip.alpha3] {
            *alpha -= std::f64::consts::FRAC_PI_2;
            if *alpha < 0.0 {
                *alpha += std::f64::consts::TAU;
            }
        }
        clip.p2 = DVec2::new(clip.p2.y, -clip.p2.x);
    }
    turned
}

/// Refuses a splat that no file can hold.
///
/// # Errors
/// [`Error::Usage`].
pub fn check(splat: &Splat) -> Result<()> {
    let axes = splat.axes;
    let finite = splat.center.is_finite() && axes.is_finite() && splat.curvature.is_finite();
    let clips = splat.clips.iter().all(|clip| {
        clip.alpha1.is_finite()
            && clip.alpha3.is_finite()
            && clip.p2.is_finite()
            && (0.0..=1.0).contains(&clip.rho)
    });
    if !finite || !splat.radii.is_finite() || !clips {
        return Err(refused(splat, "has a number that is not finite or a rho outside [0, 1]; drop it"));
    }
    if splat.radii.min_element() <= 0.0 {
        return Err(refused(splat, "has a radius that is not positive; drop it"));
    }
    let off = axes.transpose() * axes - DMat3::IDENTITY;
    let most = off.to_cols_array().iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    if most > ORTHONORMAL || axes.determinant() < 0.0 {
        return Err(refused(splat, "has axes that are not orthonormal and right-handed"));
    }
    Ok(())
}

/// A [`Error::Usage`] that shows the splat.
#[must_use]
pub fn refused(splat: &Splat, why: &str) -> Error {
    Error::Usage(format!(
        "cannot store a splat: the one at {} with radii {} and curvature {} {why}",
        splat.center, splat.radii, splat.curvature
    ))
}
