//! Finds and opens graphics adapters.

use std::sync::{Arc, Mutex, PoisonError};

use super::Gpu;
use crate::error::{Error, Result};
use crate::render::device::DeviceInfo;

/// What to do without an adapter.
const NO_ADAPTER: &str = "no graphics adapter found; install a Vulkan driver (on Debian without a GPU: \
                          mesa-vulkan-drivers) or use the cpu device";

/// Graphics adapters, best first.
#[must_use]
pub fn list() -> Vec<DeviceInfo> {
    adapters().iter().map(|adapter| describe(&adapter.get_info())).collect()
}

/// All adapters, best kind first, otherwise in the system's order.
fn adapters() -> Vec<wgpu::Adapter> {
    // Without any backend for this system, asking for an instance would panic.
    if wgpu::Instance::enabled_backend_features().is_empty() {
        return Vec::new();
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let mut found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    found.sort_by_key(|adapter| rank(adapter.get_info().device_type).0);
    found
}

/// Order of preference, and the name.
fn rank(kind: wgpu::DeviceType) -> (u8, &'static str) {
    match kind {
        wgpu::DeviceType::DiscreteGpu => (0, "discrete"),
        wgpu::DeviceType::IntegratedGpu => (1, "integrated"),
        wgpu::DeviceType::VirtualGpu => (2, "virtual"),
        wgpu::DeviceType::Other => (3, "other"),
        wgpu::DeviceType::Cpu => (4, "software"),
    }
}

fn describe(info: &wgpu::AdapterInfo) -> DeviceInfo {
    DeviceInfo {
        name: info.name.clone(),
        kind: rank(info.device_type).1,
        backend: info.backend.to_string(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
    }
}

/// Opens the best adapter that can be opened.
pub(super) fn open() -> Result<Gpu> {
    let mut fault = NO_ADAPTER.to_owned();
    for adapter in adapters() {
        match open_one(&adapter) {
            Ok(gpu) => return Ok(gpu),
            Err(error) => fault = format!("{}: {error}; use the cpu device", adapter.get_info().name),
        }
    }
    Err(Error::Device(fault))
}

fn open_one(adapter: &wgpu::Adapter) -> std::result::Result<Gpu, wgpu::RequestDeviceError> {
    let features = adapter.features() & wgpu::Features::FLOAT32_BLENDABLE;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("qsplat"),
        required_features: features,
        required_limits: adapter.limits(),
        ..Default::default()
    }))?;
    let faults = Arc::new(Faults::default());
    let (uncaptured, lost) = (Arc::clone(&faults), Arc::clone(&faults));
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| uncaptured.put(error.to_string())));
    device.set_device_lost_callback(move |reason, message| {
        // Dropping the device ends here too; that is no fault.
        if reason != wgpu::DeviceLostReason::Destroyed {
            lost.put(format!("device lost: {message}"));
        }
    });
    let sums =
        if features.is_empty() { wgpu::TextureFormat::Rgba16Float } else { wgpu::TextureFormat::Rgba32Float };
    Ok(Gpu { device, queue, info: describe(&adapter.get_info()), faults, sums })
}

/// The first fault that the device reported outside of any question.
#[derive(Debug, Default)]
pub(super) struct Faults(Mutex<Option<String>>);

impl Faults {
    fn put(&self, fault: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(fault);
    }

    /// The fault, if any, which is forgotten.
    pub(super) fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
