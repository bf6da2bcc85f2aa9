//! One picture: the targets, the three passes, and the way back to the CPU.

use std::sync::mpsc;
use std::time::Duration;

use super::Gpu;
use super::pipelines::{DEPTH, PICTURE, SURFACES, SplatPipelines, WORDS};
use super::records::EyeRecord;
use super::scene::{self, Scene};
use crate::error::{Error, Result};
use crate::render::camera::Camera;
use crate::render::eye::Eye;
use crate::render::settings::Settings;

/// A device that takes longer than this for one picture is taken to hang; software adapters
/// need seconds for the largest.
const PATIENCE: Duration = Duration::from_secs(300);

/// The most samples of one picture on a device: their targets, 60 bytes each, fill 2 GB.
const MAX_SAMPLES: u64 = 1 << 25;

/// Draws a scene; samples in rows from the top.
pub fn draw(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    size: [u32; 2],
) -> Result<Vec<[u8; 4]>> {
    let eye = Eye::new(camera, &scene.frame, size)?;
    let limit = u64::from(gpu.device.limits().max_texture_dimension_2d);
    gpu.within("the picture's greater side in samples", u64::from(size[0].max(size[1])), limit)?;
    gpu.within("the number of samples", u64::from(size[0]) * u64::from(size[1]), MAX_SAMPLES)?;
    let record = EyeRecord::new(&eye, scene.half_diagonal, scene.reach, scene.widths, settings);
    gpu.queue.write_buffer(&scene.eye, 0, bytemuck::bytes_of(&record));
    let targets = Targets::new(gpu, size, scene.colored);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    targets.visibility(scene, &mut encoder);
    targets.attributes(gpu, scene, &mut encoder);
    if settings.show.is_identity() {
        targets.identity(gpu, scene, &mut encoder);
    }
    targets.shading(gpu, scene, &mut encoder);
    let bytes = read_back(gpu, encoder, &targets.picture, size)?;
    Ok(bytes)
}

/// What the passes write.
struct Targets {
    depth: wgpu::TextureView,
    surfaces: wgpu::TextureView,
    words: wgpu::TextureView,
    normals: wgpu::TextureView,
    colors: Option<wgpu::TextureView>,
    picture: wgpu::Texture,
}

impl Targets {
    fn new(gpu: &Gpu, size: [u32; 2], colored: bool) -> Self {
        let texture = |format, extra| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: extent(size),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | extra,
                view_formats: &[],
            })
        };
        let view = |format, extra| texture(format, extra).create_view(&Default::default());
        let read = wgpu::TextureUsages::TEXTURE_BINDING;
        Self {
            depth: view(DEPTH, wgpu::TextureUsages::empty()),
            surfaces: view(SURFACES, read),
            words: view(WORDS, read),
            normals: view(gpu.sums, read),
            colors: colored.then(|| view(gpu.sums, read)),
            picture: texture(PICTURE, wgpu::TextureUsages::COPY_SRC),
        }
    }

    /// Pass 1: the nearest hit of each sample.
    fn visibility(&self, scene: &Scene, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("visibility"),
            color_attachments: &[cleared(&self.surfaces), cleared(&self.words)],
            depth_stencil_attachment: self.cleared_depth(),
            ..Default::default()
        });
        splats(&mut pass, scene, |passes| &passes.visibility);
    }

    /// Pass 2: weighted sums over the splats of the visible surface.
    fn attributes(&self, gpu: &Gpu, scene: &Scene, encoder: &mut wgpu::CommandEncoder) {
        let mut attachments = vec![cleared(&self.normals)];
        attachments.extend(self.colors.as_ref().map(cleared));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("attributes"),
            color_attachments: &attachments,
            ..Default::default()
        });
        pass.set_bind_group(1, &self.visible(gpu, scene), &[]);
        splats(&mut pass, scene, |passes| &passes.attributes);
    }

    /// Of the visible surface's splats, the one seen nearest its centre. Where rounding finds
    /// none, the word of the nearest hit stays.
    fn identity(&self, gpu: &Gpu, scene: &Scene, encoder: &mut wgpu::CommandEncoder) {
        let words = cleared(&self.words).map(|mut attachment| {
            attachment.ops.load = wgpu::LoadOp::Load;
            attachment
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("identity"),
            color_attachments: &[words],
            depth_stencil_attachment: self.cleared_depth(),
            ..Default::default()
        });
        pass.set_bind_group(1, &self.visible(gpu, scene), &[]);
        splats(&mut pass, scene, |passes| &passes.identity);
    }

    /// The visible surfaces, for a pass to read.
    fn visible(&self, gpu: &Gpu, scene: &Scene) -> wgpu::BindGroup {
        let surfaces = wgpu::BindingResource::TextureView(&self.surfaces);
        scene::group(gpu, &scene.surfaces_layout, &[surfaces])
    }

    /// A depth buffer that starts at 1 and is dropped after the pass.
    fn cleared_depth(&self) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard };
        Some(wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(ops),
            stencil_ops: None,
        })
    }

    /// Pass 3: the colour of each sample.
    fn shading(&self, gpu: &Gpu, scene: &Scene, encoder: &mut wgpu::CommandEncoder) {
        let views = [&self.surfaces, &self.words, &self.normals].into_iter().chain(&self.colors);
        let views: Vec<_> = views.map(wgpu::BindingResource::TextureView).collect();
        let sums = scene::group(gpu, &scene.shading_layout, &views);
        let picture = self.picture.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shading"),
            color_attachments: &[cleared(&picture)],
            ..Default::default()
        });
        pass.set_pipeline(&scene.shading);
        pass.set_bind_group(0, &scene.eye_group, &[]);
        pass.set_bind_group(1, &sums, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Draws all splats, class by class.
fn splats(
    pass: &mut wgpu::RenderPass<'_>,
    scene: &Scene,
    pipeline: impl Fn(&SplatPipelines) -> &wgpu::RenderPipeline,
) {
    pass.set_vertex_buffer(0, scene.splats.slice(..));
    if let Some(partners) = &scene.partners {
        pass.set_vertex_buffer(1, partners.slice(..));
    }
    for class in &scene.classes {
        pass.set_pipeline(pipeline(&class.pipelines));
        pass.set_bind_group(0, &class.group, &[]);
        pass.draw(0..4, class.instances.clone());
    }
}

fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 }
}

/// An attachment that starts at zero and is kept.
fn cleared(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Store,
        },
    })
}

/// Submits the work and waits for its picture.
fn read_back(
    gpu: &Gpu,
    mut encoder: wgpu::CommandEncoder,
    picture: &wgpu::Texture,
    size: [u32; 2],
) -> Result<Vec<[u8; 4]>> {
    let row = size[0] as usize * size_of::<[u8; 4]>();
    let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
    let bytes = stride as u64 * u64::from(size[1]);
    gpu.within("the size of the picture in bytes", bytes, gpu.device.limits().max_buffer_size)?;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: bytes,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride as u32), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), target, extent(size));
    let submission = gpu.queue.submit([encoder.finish()]);
    let (sender, receiver) = mpsc::channel();
    // A receiver that is gone means that the wait below gave up: nobody cares any more.
    buffer.map_async(wgpu::MapMode::Read, .., move |mapped| drop(sender.send(mapped)));
    let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
    let fault = |what: String| {
        Error::Device(format!("{} did not deliver the picture: {what}; {}", gpu.info.name, super::REMEDY))
    };
    gpu.device.poll(wait).map_err(|error| fault(error.to_string()))?;
    receiver
        .try_recv()
        .map_err(|error| fault(error.to_string()))?
        .map_err(|error| fault(error.to_string()))?;
    let mapped = buffer.get_mapped_range(..).map_err(|error| fault(error.to_string()))?;
    let rows = mapped.chunks_exact(stride).map(|line| &line[..row]);
    Ok(rows.flat_map(|line| line.as_chunks::<4>().0).copied().collect())
}
