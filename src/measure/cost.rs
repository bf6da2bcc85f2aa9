//! What a file costs: bytes, decoding, drawing.

use std::time::Instant;

use super::measures::{Chunk, Cost, GpuFrame};
use super::views::{SIDE, View};
#[cfg(not(feature = "gpu"))]
use crate::error::Error;
use crate::error::Result;
use crate::format;
use crate::model::asset::Asset;
#[cfg(feature = "gpu")]
use crate::render::gpu::Gpu;
use crate::render::{Camera, Picture, Settings, cpu};

/// How often the file is decoded for its time.
const DECODES: usize = 5;

/// One of so many views is drawn for its time: seven of 26, of faces, edges and corners.
const EVERY: usize = 4;

/// The cost of a file whose input has so many points. Without what other measures find along the
/// way: `overlap`, `fragments` and `gpu`.
///
/// # Errors
/// Those of [`format::decode`] for the bytes, and of [`cpu::render`] for the views.
pub fn cost<'a>(
    bytes: &[u8],
    asset: &Asset,
    input_points: usize,
    views: impl Iterator<Item = &'a View>,
) -> Result<Cost> {
    let limits = format::Limits::default();
    let info = format::inspect(bytes, &limits)?;
    let counts = asset.counts();
    let per = |count: usize| bytes.len() as f64 / count.max(1) as f64;
    let decode_seconds = median((0..DECODES).map(|_| seconds(|| format::decode(bytes, &limits))))?;
    let raw: u64 = info.chunks.iter().map(|chunk| chunk.raw_bytes).sum();
    let chunk = |chunk: &format::ChunkInfo| Chunk {
        name: chunk.id.clone(),
        raw_bytes: chunk.raw_bytes,
        coded_bytes: chunk.coded_bytes,
    };
    Ok(Cost {
        bytes: info.bytes,
        head_bytes: info.head_bytes,
        chunks: info.chunks.iter().map(chunk).collect(),
        splats: counts.splats as u64,
        flat: counts.flat as u64,
        cylinder: counts.cylinder as u64,
        quadric: counts.quadric as u64,
        clipped: counts.clipped as u64,
        input_points: input_points as u64,
        bytes_per_splat: per(counts.splats),
        bytes_per_point: per(input_points),
        decode_seconds,
        decode_megabytes_per_second: raw as f64 / 1e6 / decode_seconds.max(f64::MIN_POSITIVE),
        cpu_frame_ms: frame_ms(views, &mut |camera, settings| cpu::render(asset, camera, settings))?,
        threads: rayon::current_num_threads() as u64,
        ..Cost::default()
    })
}

/// Milliseconds that something takes to draw a view, one sample a pixel: the median over seven
/// of the 26.
///
/// # Errors
/// Those of the drawing.
pub fn frame_ms<'a>(
    views: impl Iterator<Item = &'a View>,
    draw: &mut dyn FnMut(&Camera, &Settings) -> Result<Picture>,
) -> Result<f64> {
    let settings = Settings::plain([SIDE; 2]);
    let times = views.step_by(EVERY).map(|view| seconds(|| draw(&view.camera, &settings)));
    Ok(1e3 * median(times)?)
}

/// The time of a frame on the best graphics device.
///
/// # Errors
/// [`crate::Error::Device`] if there is none or it fails.
#[cfg(feature = "gpu")]
pub fn gpu_frame<'a>(asset: &Asset, views: impl Iterator<Item = &'a View> + Clone) -> Result<GpuFrame> {
    let gpu = Gpu::new()?;
    let loaded = gpu.load(asset)?;
    let mut draw = |camera: &Camera, settings: &Settings| loaded.draw(camera, settings);
    // The first picture also pays for what a device puts off until it is used.
    frame_ms(views.clone().take(1), &mut draw)?;
    Ok(GpuFrame { adapter: gpu.info().name.clone(), frame_ms: frame_ms(views, &mut draw)? })
}

/// Stands in for the renderer that this build leaves out.
///
/// # Errors
/// [`crate::Error::Device`], always.
#[cfg(not(feature = "gpu"))]
pub fn gpu_frame<'a>(_: &Asset, _: impl Iterator<Item = &'a View> + Clone) -> Result<GpuFrame> {
    Err(Error::Device("this program was built without the `gpu` feature".into()))
}

/// Seconds on the clock that some work takes.
fn seconds<T>(work: impl FnOnce() -> Result<T>) -> Result<f64> {
    let start = Instant::now();
    let result = work();
    let seconds = start.elapsed().as_secs_f64();
    result.map(|_| seconds)
}

/// The median, of an even number the upper; 0 of none.
fn median(times: impl Iterator<Item = Result<f64>>) -> Result<f64> {
    let mut times = times.collect::<Result<Vec<f64>>>()?;
    times.sort_unstable_by(f64::total_cmp);
    Ok(times.get(times.len() / 2).copied().unwrap_or(0.0))
}
