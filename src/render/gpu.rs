//! The wgpu renderer: the WGSL twins on a graphics adapter, in 32-bit arithmetic.
//!
//! Three passes, as in `composite`: visibility writes depth, normal, view depth and index of
//! the nearest hit; attributes adds weighted normals and colours; shading covers the picture
//! once. Pictures that show identities take one more, which finds the splat seen nearest its
//! centre. Splats are sorted into four classes (flat or curved, clipped or not), and each
//! class that is not empty gets pipelines compiled without what it does not need.

mod adapter;
mod frame;
mod pipelines;
mod records;
mod scene;
mod source;

use std::sync::Arc;

use super::camera::Camera;
use super::device::DeviceInfo;
use super::picture::Picture;
use super::settings::Settings;
use crate::error::{Error, Result};
use crate::model::asset::Asset;

pub use adapter::list;

/// What to try when a device cannot do it.
const REMEDY: &str = "give a smaller size, turn antialiasing off, or use the cpu device";

/// An open graphics device.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: DeviceInfo,
    faults: Arc<adapter::Faults>,
    /// Format of the attribute sums: 32 bits where the adapter can blend them, else 16.
    sums: wgpu::TextureFormat,
}

/// An asset on a device, ready for any camera.
#[derive(Debug)]
pub struct Loaded<'a> {
    gpu: &'a Gpu,
    scene: scene::Scene,
}

/// The WGSL of the clip test, as it is compiled into every pass over clipped splats, for tests of
/// it alone.
///
/// It has the struct `Conic` (`p1`, `p2`, `p3`, `rho` and padding: 32 bytes), the read-only storage
/// array `conics` of them at group 0, binding 1, over the unit disc, and the function
/// `clipped_away(first, count, place)`: whether any of `count` conics cuts the place away.
#[must_use]
pub fn clip_source() -> String {
    source::clip()
}

impl Gpu {
    /// Opens the best adapter: discrete, integrated, virtual, then software.
    ///
    /// # Errors
    /// [`Error::Device`] when there is none or it cannot be opened.
    pub fn new() -> Result<Self> {
        adapter::open()
    }

    /// The adapter.
    #[must_use]
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Draws an asset once; see [`Gpu::load`] for many pictures of one asset.
    ///
    /// # Errors
    /// [`Error::Usage`] for a camera or settings that cannot be drawn, [`Error::Device`] when
    /// the device fails or is too small.
    pub fn render(&self, asset: &Asset, camera: &Camera, settings: &Settings) -> Result<Picture> {
        self.load(asset)?.draw(camera, settings)
    }

    /// Moves an asset to the device and compiles its pipelines.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails or its buffers are too small.
    pub fn load(&self, asset: &Asset) -> Result<Loaded<'_>> {
        let scene = self.guarded("loading the splats", || scene::Scene::new(self, asset))?;
        Ok(Loaded { gpu: self, scene })
    }

    /// Runs some work and turns whatever the device reports of it into an error.
    fn guarded<T>(&self, what: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let filters =
            [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let result = work();
        let mut fault = None;
        for scope in scopes.into_iter().rev() {
            fault = fault.or(pollster::block_on(scope.pop()).map(|error| error.to_string()));
        }
        match fault.or_else(|| self.faults.take()) {
            Some(fault) => Err(Error::Device(format!("{what} on {}: {fault}; {REMEDY}", self.info.name))),
            None => result,
        }
    }

    /// Refuses what passes a limit of the device.
    fn within(&self, what: &str, value: u64, limit: u64) -> Result<()> {
        if value <= limit {
            return Ok(());
        }
        let name = &self.info.name;
        Err(Error::Device(format!("{what} is {value}, above the limit {limit} of {name}; {REMEDY}")))
    }
}

impl Loaded<'_> {
    /// Draws a picture.
    ///
    /// # Errors
    /// As [`Gpu::render`].
    pub fn draw(&self, camera: &Camera, settings: &Settings) -> Result<Picture> {
        let size = settings.samples()?;
        let samples =
            self.gpu.guarded("drawing", || frame::draw(self.gpu, &self.scene, camera, settings, size))?;
        Picture::from_samples(samples, size, settings.factor())
    }

    /// How many classes are not empty and so have pipelines.
    #[must_use]
    pub fn classes(&self) -> usize {
        self.scene.classes.len()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::model::asset::Accuracy;
    use crate::model::frame::Frame;
    use crate::render::camera::{Framing, View};
    use std::io::Write;

    fn asset() -> Asset {
        Asset {
            frame: Frame::default(),
            diagonal: 1.0,
            max_error: 1e-3,
            fit: Accuracy::default(),
            has_colors: true,
            splats: Vec::new(),
        }
    }

    #[allow(clippy::explicit_write)] // `eprintln` is held back by the test harness
    fn gpu() -> Option<Gpu> {
        let gpu = Gpu::new();
        if let Err(fault) = &gpu {
            writeln!(std::io::stderr(), "\n*** NO GRAPHICS ADAPTER: ITS FAULTS ARE NOT TESTED ***\n{fault}")
                .unwrap();
        }
        gpu.ok()
    }

    #[test]
    fn a_lost_device_is_an_error() {
        let Some(gpu) = gpu() else { return };
        let asset = asset();
        let settings = Settings { size: [4, 4], ..Settings::default() };
        let camera = Camera::framing(&asset.frame, 1.0, View::Front, Framing::default(), settings.size);
        let loaded = gpu.load(&asset).unwrap();
        loaded.draw(&camera, &settings).unwrap();
        gpu.device.destroy();
        let message = |result: Result<Picture>| match result {
            Err(Error::Device(message)) => message,
            other => panic!("{other:?}"),
        };
        assert!(message(loaded.draw(&camera, &settings)).contains("cpu device"));
        assert!(message(gpu.render(&asset, &camera, &settings)).contains("cpu device"));
    }

    #[test]
    fn both_formats_of_the_sums_work() {
        let Some(mut gpu) = gpu() else { return };
        let settings = Settings { size: [4, 4], ..Settings::default() };
        let camera = Camera::framing(&Frame::default(), 1.0, View::Front, Framing::default(), settings.size);
        gpu.sums = wgpu::TextureFormat::Rgba16Float;
        gpu.render(&asset(), &camera, &settings).unwrap();
    }
}
