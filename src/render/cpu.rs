//! The reference: draws an asset in 64-bit arithmetic on all threads of the current pool.

use super::camera::Camera;
use super::constants;
use super::eye::Eye;
use super::picture::{Picture, Seen, Visibility};
use super::settings::Settings;
use super::shade::{Shader, Surface};
use super::splat::Caps;
use super::tiles::{self, Mix, Scene};
use crate::error::Result;
use crate::model::asset::Asset;

/// Draws an asset. The same bytes come out for any number of threads.
///
/// # Errors
/// [`crate::Error::Usage`] for a camera or settings that cannot be drawn.
pub fn render(asset: &Asset, camera: &Camera, settings: &Settings) -> Result<Picture> {
    let eye = Eye::new(camera, &asset.frame, settings.samples()?)?;
    let mix = Mix::Band { band: constants::band(asset), agree: constants::agree_cosine() };
    picture(&Caps::new(asset, &eye), &eye, mix, settings, 0.5 * asset.diagonal)
}

/// What each pixel's ray meets first, for counting holes.
///
/// # Errors
/// As [`render`].
pub fn visibility(asset: &Asset, camera: &Camera, size: [u32; 2]) -> Result<Visibility> {
    let eye = Eye::new(camera, &asset.frame, Settings::plain(size).samples()?)?;
    Ok(nearest(&Caps::new(asset, &eye), &eye))
}

/// Draws, shades and filters any scene within `radius` of the model's origin.
pub(super) fn picture<S: Scene>(
    scene: &S,
    eye: &Eye,
    mix: Mix,
    settings: &Settings,
    radius: f64,
) -> Result<Picture> {
    let shader = Shader::new(eye, settings, radius);
    let samples = tiles::draw(scene, eye, mix, settings.background, |pixel| {
        shader.rgba(&Surface {
            normal: pixel.normal,
            color: pixel.color,
            direction: pixel.direction,
            depth: pixel.depth,
            index: pixel.item as u32,
            class: scene.class(pixel.item),
        })
    });
    Picture::from_samples(samples, eye.size, settings.factor())
}

/// The nearest hits of any scene.
pub(super) fn nearest<S: Scene>(scene: &S, eye: &Eye) -> Visibility {
    let seen = tiles::draw(scene, eye, Mix::Nearest, None, |pixel| {
        let normal = eye.turn_back(pixel.normal).as_vec3().to_array();
        Some(Seen { depth: pixel.depth, index: pixel.item as u32, normal })
    });
    Visibility { size: eye.size, seen }
}
