//! The reference: draws an asset in 64-bit arithmetic on all threads of the current pool.

use super::camera::Camera;
use super::constants;
use super::eye::Eye;
use super::picture::{Picture, Seen, Survey, Visibility};
use super::settings::{Settings, Show};
use super::shade::{Shader, Surface};
use super::splat::Caps;
use super::tiles::{self, Mix, Pixel, Scene};
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

/// What a camera sees, drawn shaded and as normals in one pass, one sample a pixel.
///
/// # Errors
/// As [`render`].
pub fn survey(asset: &Asset, camera: &Camera, size: [u32; 2]) -> Result<Survey> {
    let eye = Eye::new(camera, &asset.frame, Settings::plain(size).samples()?)?;
    let mix = Mix::Band { band: constants::band(asset), agree: constants::agree_cosine() };
    survey_of(&Caps::new(asset, &eye), &eye, mix, 0.5 * asset.diagonal)
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
    let samples =
        tiles::draw(scene, eye, mix, settings.background, |pixel| shader.rgba(&surface(scene, pixel)));
    Picture::from_samples(samples, eye.size, settings.factor())
}

/// Surveys any scene within `radius` of the model's origin.
pub(super) fn survey_of<S: Scene>(scene: &S, eye: &Eye, mix: Mix, radius: f64) -> Result<Survey> {
    let settings = Settings::plain(eye.size);
    let shaded = Shader::new(eye, &settings, radius);
    let normals = Shader::new(eye, &Settings { show: Show::Normals, ..settings }, radius);
    let background = (None, settings.background, settings.background, 0);
    let samples = tiles::draw(scene, eye, mix, background, |pixel| {
        let surface = surface(scene, pixel);
        (Some(seen(eye, pixel)), shaded.rgba(&surface), normals.rgba(&surface), pixel.met)
    });
    let picture = |rgba: Vec<[u8; 4]>| Picture::from_samples(rgba, eye.size, 1);
    Ok(Survey {
        shaded: picture(samples.iter().map(|sample| sample.1).collect())?,
        normals: picture(samples.iter().map(|sample| sample.2).collect())?,
        fragments: samples.iter().map(|sample| u64::from(sample.3)).sum(),
        visibility: Visibility { size: eye.size, seen: samples.into_iter().map(|sample| sample.0).collect() },
    })
}

/// A pixel as the shader takes it.
fn surface<S: Scene>(scene: &S, pixel: &Pixel) -> Surface {
    Surface {
        normal: pixel.normal,
        color: pixel.color,
        direction: pixel.direction,
        depth: pixel.depth,
        index: pixel.item as u32,
        tint: scene.tint(pixel.item),
    }
}

/// A pixel as its visibility.
fn seen(eye: &Eye, pixel: &Pixel) -> Seen {
    let normal = eye.turn_back(pixel.normal).as_vec3().to_array();
    Seen { depth: pixel.depth, index: pixel.item as u32, normal }
}

/// The nearest hits of any scene.
pub(super) fn nearest<S: Scene>(scene: &S, eye: &Eye) -> Visibility {
    let seen = tiles::draw(scene, eye, Mix::Nearest, None, |pixel| Some(seen(eye, pixel)));
    Visibility { size: eye.size, seen }
}
