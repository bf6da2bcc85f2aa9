//! Which device draws.

use super::camera::Camera;
use super::cpu;
use super::picture::Picture;
use super::settings::Settings;
use crate::error::{Error, Result};
use crate::model::asset::Asset;

/// Who should draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// The best graphics adapter, software adapters included; the CPU reference when there is
    /// none or it fails.
    #[default]
    Auto,
    /// The CPU reference.
    Cpu,
    /// The best graphics adapter, or an error.
    Gpu,
}

impl std::str::FromStr for Choice {
    type Err = Error;

    /// `auto`, `cpu` or `gpu`.
    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            "cpu" => Ok(Self::Cpu),
            "gpu" => Ok(Self::Gpu),
            _ => Err(Error::Usage(format!("no device `{text}`; choose one of auto, cpu, gpu"))),
        }
    }
}

/// What can draw.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct DeviceInfo {
    /// As the driver names it; [`DeviceInfo::reference`] for the CPU reference.
    pub name: String,
    /// `reference`, `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// Graphics interface, such as `vulkan`; empty for the reference.
    pub backend: String,
    /// Driver and its version; empty for the reference.
    pub driver: String,
}

impl DeviceInfo {
    /// The CPU reference.
    #[must_use]
    pub fn reference() -> Self {
        Self {
            name: "CPU reference".into(),
            kind: "reference",
            backend: String::new(),
            driver: String::new(),
        }
    }
}

/// All that can draw here: the CPU reference, then the graphics adapters, best first.
#[must_use]
pub fn list_devices() -> Vec<DeviceInfo> {
    #[cfg(feature = "gpu")]
    let adapters = super::gpu::list();
    #[cfg(not(feature = "gpu"))]
    let adapters = Vec::new();
    [vec![DeviceInfo::reference()], adapters].concat()
}

/// A picture and who drew it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// Who drew it.
    pub device: DeviceInfo,
    /// Why [`Choice::Auto`] fell back to the CPU reference, if it did.
    pub note: Option<String>,
}

/// Draws an asset on the device of choice.
///
/// # Errors
/// [`Error::Usage`] for a camera or settings that cannot be drawn; with [`Choice::Gpu`] also
/// [`Error::Device`].
pub fn render(asset: &Asset, camera: &Camera, settings: &Settings, choice: Choice) -> Result<Drawn> {
    let reference = |note| {
        let picture = cpu::render(asset, camera, settings)?;
        Ok(Drawn { picture, device: DeviceInfo::reference(), note })
    };
    match choice {
        Choice::Cpu => reference(None),
        Choice::Gpu => on_gpu(asset, camera, settings),
        Choice::Auto => match on_gpu(asset, camera, settings) {
            Err(Error::Device(why)) => reference(Some(format!("drawn by the CPU reference: {why}"))),
            drawn => drawn,
        },
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(asset: &Asset, camera: &Camera, settings: &Settings) -> Result<Drawn> {
    let gpu = super::gpu::Gpu::new()?;
    let picture = gpu.render(asset, camera, settings)?;
    Ok(Drawn { picture, device: gpu.info().clone(), note: None })
}

#[cfg(not(feature = "gpu"))]
fn on_gpu(_: &Asset, _: &Camera, _: &Settings) -> Result<Drawn> {
    Err(Error::Device("this program was built without the `gpu` feature; use the cpu device".into()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::model::asset::Accuracy;
    use crate::model::frame::Frame;
    use crate::render::camera::{Framing, View};

    #[test]
    fn auto_always_draws() {
        let asset = Asset {
            frame: Frame::default(),
            diagonal: 1.0,
            max_error: 1e-3,
            fit: Accuracy::default(),
            has_colors: false,
            splats: Vec::new(),
        };
        let settings = Settings { size: [4, 4], ..Settings::default() };
        let camera = Camera::framing(&asset.frame, 1.0, View::Front, Framing::default(), settings.size);
        let drawn = render(&asset, &camera, &settings, "auto".parse().unwrap()).unwrap();
        let devices = list_devices();
        assert_eq!(devices[0], DeviceInfo::reference());
        assert_eq!(drawn.device, *devices.get(1).unwrap_or(&devices[0]));
        assert_eq!(drawn.note.is_some(), devices.len() == 1);
        assert!("quantum".parse::<Choice>().is_err());
    }
}
