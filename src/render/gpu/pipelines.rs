//! The pipelines, compiled for what a class of splats needs and no more.

use super::Gpu;
use super::records::SplatRecord;
use super::source::{self, Needs};

/// Format of the depth buffer.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of the visible normal and depth.
pub const SURFACES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Format of the visible index and class.
pub const WORDS: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Format of the picture.
pub const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The bind group layouts.
pub struct Layouts {
    /// The camera.
    pub plain: wgpu::BindGroupLayout,
    /// The camera and the conics.
    pub clipped: wgpu::BindGroupLayout,
    /// The visible surfaces, for the attribute pass.
    pub surfaces: wgpu::BindGroupLayout,
    /// All that the shading pass reads.
    pub shading: wgpu::BindGroupLayout,
}

impl Layouts {
    /// The layouts for an asset with or without colours.
    pub fn new(gpu: &Gpu, colored: bool) -> Self {
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let float = texture(wgpu::TextureSampleType::Float { filterable: false });
        let eye = buffer(wgpu::BufferBindingType::Uniform);
        let conics = buffer(wgpu::BufferBindingType::Storage { read_only: true });
        let word = texture(wgpu::TextureSampleType::Uint);
        let shaded = [float, word, float, float];
        Self {
            plain: layout(gpu, &[eye]),
            clipped: layout(gpu, &[eye, conics]),
            surfaces: layout(gpu, &[float]),
            shading: layout(gpu, if colored { &shaded } else { &shaded[..3] }),
        }
    }
}

fn layout(gpu: &Gpu, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty,
            count: None,
        })
        .collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

/// The passes over the splats of one class.
#[derive(Debug)]
pub struct SplatPipelines {
    /// Pass 1.
    pub visibility: wgpu::RenderPipeline,
    /// Pass 2.
    pub attributes: wgpu::RenderPipeline,
    /// The pass between for pictures that show identities.
    pub identity: wgpu::RenderPipeline,
}

impl SplatPipelines {
    /// Compiles the passes for what a class needs.
    pub fn new(gpu: &Gpu, layouts: &Layouts, needs: Needs) -> Self {
        let layout = if needs.clipped { &layouts.clipped } else { &layouts.plain };
        let module = module(gpu, "splats", source::splats(needs));
        let plain = |format| Some(wgpu::ColorTargetState::from(format));
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = Some(wgpu::BlendState { color: add, alpha: add });
        let sum = Some(wgpu::ColorTargetState { blend, ..wgpu::ColorTargetState::from(gpu.sums) });
        let sums = if needs.colored { vec![sum.clone(), sum] } else { vec![sum] };
        let pass = |layouts: &[&wgpu::BindGroupLayout], fragment, targets: &[_], depth| {
            Pass { layouts, module: &module, entries: ["vertex", fragment], targets, depth }.pipeline(gpu)
        };
        let read = [layout, &layouts.surfaces];
        Self {
            visibility: pass(&[layout], "visibility", &[plain(SURFACES), plain(WORDS)], true),
            attributes: pass(&read, "attributes", &sums, false),
            identity: pass(&read, "identity", &[plain(WORDS)], true),
        }
    }
}

/// The pipeline of the shading pass.
pub fn shading(gpu: &Gpu, layouts: &Layouts, colored: bool) -> wgpu::RenderPipeline {
    Pass {
        layouts: &[&layouts.plain, &layouts.shading],
        module: &module(gpu, "shading", source::shading(colored)),
        entries: ["whole", "shade"],
        targets: &[Some(PICTURE.into())],
        depth: false,
    }
    .pipeline(gpu)
}

fn module(gpu: &Gpu, label: &str, source: String) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

/// What the pipelines differ in.
struct Pass<'a> {
    layouts: &'a [&'a wgpu::BindGroupLayout],
    module: &'a wgpu::ShaderModule,
    /// Vertex and fragment entry points; `vertex` reads splat records.
    entries: [&'static str; 2],
    targets: &'a [Option<wgpu::ColorTargetState>],
    /// Whether the nearest fragment wins.
    depth: bool,
}

impl Pass<'_> {
    fn pipeline(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let attributes = wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x3, 4 => Float32x4, 5 => Float32x3,
            6 => Uint32x3
        ];
        let records = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<SplatRecord>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &attributes,
        })];
        let bind_group_layouts: Vec<_> = self.layouts.iter().map(|&layout| Some(layout)).collect();
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &bind_group_layouts,
            ..Default::default()
        });
        let [vertex, fragment] = self.entries;
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: if vertex == "vertex" { &records } else { &[] },
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..Default::default()
            },
            depth_stencil: self.depth.then(|| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: self.targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
