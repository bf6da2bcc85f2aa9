//! Which device draws.

use std::fmt::Write as _;

use qsplat::error::{Error, Result};
use qsplat::model::asset::Asset;
use qsplat::render::device::{Choice, list_devices};
#[cfg(feature = "gpu")]
use qsplat::render::gpu::Gpu;
use qsplat::render::{Camera, Picture, Settings, cpu};

use super::Notes;

/// What the arguments of the subcommands show for a [`Choice`].
pub(super) const NAMES: &str = "auto|cpu|gpu";

/// Draws one picture of the asset at hand.
pub(super) type Draw<'a> = dyn FnMut(&Camera, &Settings) -> Result<Picture> + 'a;

/// Opens the device of choice and lends it to some work, for as many pictures as that needs.
///
/// # Errors
/// [`Error::Device`] if the GPU is asked for and there is none; whatever the work returns.
pub(super) fn with<T>(
    choice: Choice,
    asset: &Asset,
    notes: &mut Notes<'_>,
    work: impl FnOnce(&mut Draw<'_>) -> Result<T>,
) -> Result<T> {
    let reference = &mut |camera: &Camera, settings: &Settings| cpu::render(asset, camera, settings);
    if choice == Choice::Cpu {
        return work(reference);
    }
    match open() {
        Ok(gpu) => {
            let loaded = gpu.load(asset)?;
            work(&mut |camera, settings| loaded.draw(camera, settings))
        }
        Err(Error::Device(why)) if choice == Choice::Auto => {
            notes.note(&format!("drawn by the CPU reference: {why}"));
            work(reference)
        }
        Err(error) => Err(error),
    }
}

#[cfg(feature = "gpu")]
fn open() -> Result<Gpu> {
    Gpu::new()
}

/// Stands in for the renderer that this build leaves out; it is never made.
#[cfg(not(feature = "gpu"))]
enum Absent {}

#[cfg(not(feature = "gpu"))]
impl Absent {
    fn load(&self, _: &Asset) -> Result<&Self> {
        match *self {}
    }

    fn draw(&self, _: &Camera, _: &Settings) -> Result<Picture> {
        match *self {}
    }
}

#[cfg(not(feature = "gpu"))]
fn open() -> Result<Absent> {
    Err(Error::Device("this program was built without the `gpu` feature".into()))
}

/// The devices of this machine, one a line.
pub(super) fn list() -> String {
    let mut text = String::new();
    for device in list_devices() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{:<12} {}", device.kind, device.name);
        if !device.backend.is_empty() {
            let _ = write!(text, " ({}, {})", device.backend, device.driver);
        }
        text.push('\n');
    }
    text
}
