//! What the two frame benchmarks draw.

use glam::DVec2;
use qsplat::model::asset::Asset;
use qsplat::render::camera::{Camera, Framing, View};
use qsplat::render::settings::Settings;

/// Width and height, pixels.
const SIZE: [u32; 2] = [512, 512];

/// One sample a pixel.
pub fn settings() -> Settings {
    Settings::plain(SIZE)
}

/// The whole asset from one side.
pub fn camera(asset: &Asset) -> Camera {
    let framing = Framing::default();
    Camera::framing(&asset.frame, asset.diagonal, View::Iso, framing, SIZE)
}

/// The same splats as pieces of their tangent planes.
pub fn flat(asset: &Asset) -> Asset {
    let mut flat = asset.clone();
    for splat in &mut flat.splats {
        splat.curvature = DVec2::ZERO;
    }
    flat
}
