//! An asset's buffers, sorted into classes.

use std::ops::Range;

use super::Gpu;
use super::pipelines::{self, Layouts, SplatPipelines};
use super::records::{self, ConicRecord, EyeRecord, PartnerRecord, SplatRecord};
use super::source::{INDEX_BITS, Needs};
use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::model::frame::Frame;
use crate::render::constants::{self, CLASSES};

/// An asset on a device.
#[derive(Debug)]
pub struct Scene {
    /// Where the model lies.
    pub frame: Frame,
    /// Half the diagonal, model units.
    pub half_diagonal: f64,
    /// Radius around the model's origin that holds every splat.
    pub reach: f64,
    /// Thickness of a surface, and how near to a clip curve it gives way.
    pub widths: [f64; 2],
    /// Whether colours are blended.
    pub colored: bool,
    /// The splats, class by class.
    pub splats: wgpu::Buffer,
    /// Where each one's clip partners are, if any has some.
    pub partners: Option<wgpu::Buffer>,
    /// The camera of the frame being drawn.
    pub eye: wgpu::Buffer,
    /// The classes that are not empty.
    pub classes: Vec<Class>,
    /// The shading pass.
    pub shading: wgpu::RenderPipeline,
    /// The camera alone, for the shading pass.
    pub eye_group: wgpu::BindGroup,
    /// Layout of the visible surfaces, for the attribute pass.
    pub surfaces_layout: wgpu::BindGroupLayout,
    /// Layout of all that the shading pass reads.
    pub shading_layout: wgpu::BindGroupLayout,
}

/// The splats of one kind of record, and how to draw them.
#[derive(Debug)]
pub struct Class {
    /// Their places in the buffer.
    pub instances: Range<u32>,
    /// The camera, and the conics and partners if any.
    pub group: wgpu::BindGroup,
    /// The passes over them.
    pub pipelines: SplatPipelines,
}

impl Scene {
    /// Moves an asset to a device.
    pub fn new(gpu: &Gpu, asset: &Asset) -> Result<Self> {
        let Sorted { records, conics, partners, partner_ranges, ranges } = Sorted::new(asset)?;
        let limits = gpu.device.limits();
        let bytes = size_of_val(records.as_slice()) as u64;
        gpu.within("the size of the splats in bytes", bytes, limits.max_buffer_size)?;
        let stored = limits.max_storage_buffer_binding_size;
        let bytes = size_of_val(conics.as_slice()) as u64;
        gpu.within("the size of the clip curves in bytes", bytes, stored)?;
        let bytes = size_of_val(partners.as_slice()) as u64;
        gpu.within("the size of the clip partners in bytes", bytes, stored)?;
        let (clipped, partnered) = (!conics.is_empty(), !partners.is_empty());
        let splats = buffer(gpu, "splats", bytemuck::cast_slice(&records), wgpu::BufferUsages::VERTEX);
        let conics = buffer(gpu, "conics", bytemuck::cast_slice(&conics), wgpu::BufferUsages::STORAGE);
        let stored = buffer(gpu, "partners", bytemuck::cast_slice(&partners), wgpu::BufferUsages::STORAGE);
        let partners = partnered.then(|| {
            buffer(
                gpu,
                "ranges of partners",
                bytemuck::cast_slice(&partner_ranges),
                wgpu::BufferUsages::VERTEX,
            )
        });
        let eye = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("eye"),
            size: size_of::<EyeRecord>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layouts = Layouts::new(gpu, asset.has_colors);
        let classes = ranges.into_iter().enumerate().filter(|(_, range)| !range.is_empty());
        let classes = classes
            .map(|(class, instances)| {
                let cut = class & 1 != 0;
                let needs = Needs {
                    quadric: class & 2 != 0,
                    clipped: cut && clipped,
                    partnered: cut && partnered,
                    colored: asset.has_colors,
                };
                let bound = match (needs.clipped, needs.partnered) {
                    (_, true) => vec![&eye, &conics, &stored],
                    (true, false) => vec![&eye, &conics],
                    (false, false) => vec![&eye],
                };
                let bound: Vec<_> = bound.into_iter().map(wgpu::Buffer::as_entire_binding).collect();
                let group = group(gpu, layouts.of(needs), &bound);
                Class { instances, group, pipelines: SplatPipelines::new(gpu, &layouts, needs) }
            })
            .collect();
        let eye_group = group(gpu, &layouts.plain, &[eye.as_entire_binding()]);
        Ok(Self {
            frame: asset.frame,
            half_diagonal: 0.5 * asset.diagonal,
            reach: records::reach(asset),
            widths: [constants::band(asset), constants::yielding(asset)],
            colored: asset.has_colors,
            splats,
            partners,
            eye_group,
            eye,
            classes,
            shading: pipelines::shading(gpu, &layouts, asset.has_colors),
            surfaces_layout: layouts.surfaces,
            shading_layout: layouts.shading,
        })
    }
}

/// The records, class by class and in the asset's order within each, with each class's range.
struct Sorted {
    records: Vec<SplatRecord>,
    conics: Vec<ConicRecord>,
    partners: Vec<PartnerRecord>,
    /// For each record, the first of its partners and their number.
    partner_ranges: Vec<[u32; 2]>,
    ranges: [Range<u32>; CLASSES],
}

impl Sorted {
    fn new(asset: &Asset) -> Result<Self> {
        if asset.splats.len() >= 1 << INDEX_BITS {
            let count = asset.splats.len();
            return Err(Error::Device(format!(
                "{count} splats are more than 2^{INDEX_BITS}; use the cpu device"
            )));
        }
        let mut ranges: [Range<u32>; CLASSES] = Default::default();
        let (mut records, mut conics) = (Vec::with_capacity(asset.splats.len()), Vec::new());
        let (mut partners, mut partner_ranges) = (Vec::new(), Vec::with_capacity(asset.splats.len()));
        for (class, range) in ranges.iter_mut().enumerate() {
            let start = records.len() as u32;
            let all = asset.splats.iter().enumerate();
            for (n, splat) in all.filter(|(_, splat)| constants::class(splat) == class) {
                records.push(records::splat(splat, n, asset.has_colors, &mut conics));
                partner_ranges.push(records::partners(splat, &mut partners));
            }
            *range = start..records.len() as u32;
        }
        Ok(Self { records, conics, partners, partner_ranges, ranges })
    }
}

/// A filled buffer. An empty one still holds one record: a binding may not be empty.
fn buffer(gpu: &Gpu, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.len().max(size_of::<PartnerRecord>()) as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

/// A bind group of these resources, numbered from 0.
pub fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
