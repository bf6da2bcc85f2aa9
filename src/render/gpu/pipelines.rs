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
    /// The camera, the conics and the clip partners.
    pub partnered: wgpu::BindGroupLayout,
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
        let storage = buffer(wgpu::BufferBindingType::Storage { read_only: true });
        let word = texture(wgpu::TextureSampleType::Uint);
        let shaded = [float, word, float, float];
        Self {
            plain: layout(gpu, &[eye]),
            clipped: layout(gpu, &[eye, storage]),
            partnered: layout(gpu, &[eye, storage, storage]),
            surfaces: layout(gpu, &[float]),
            shading: layout(gpu, if colored { &shaded } else { &shaded[..3] }),
        }
    }
}

impl Layouts {
    /// What the passes over splats with these needs are bound to.
    pub fn of(&self, needs: Needs) -> &wgpu::BindGroupLayout {
        match (needs.clipped, needs.partnered) {
            (_, true) => &self.partnered,
            (true, false) => &self.clipped,
            (false, false) => &self.plain,
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
        let layout = layouts.of(needs);
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
            let vertex = Vertex::Splats { partnered: needs.partnered };
            Pass { layouts, module: &module, vertex, fragment, targets, depth }.pipeline(gpu)
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
        vertex: Vertex::Whole,
        fragment: "shade",
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

/// What a pass reads vertices from.
#[derive(Clone, Copy)]
enum Vertex {
    /// Splat records and, where some have partners, where each one's are.
    Splats { partnered: bool },
    /// Nothing: one triangle holds the picture.
    Whole,
}

/// What the pipelines differ in.
struct Pass<'a> {
    layouts: &'a [&'a wgpu::BindGroupLayout],
    module: &'a wgpu::ShaderModule,
    vertex: Vertex,
    /// The fragment entry point.
    fragment: &'static str,
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
        let instances = |stride: usize, attributes| {
            Some(wgpu::VertexBufferLayout {
                array_stride: stride as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes,
            })
        };
        let partners = wgpu::vertex_attr_array![7 => Uint32x2];
        let records = [
            instances(size_of::<SplatRecord>(), &attributes[..]),
            instances(size_of::<[u32; 2]>(), &partners[..]),
        ];
        let (vertex, buffers) = match self.vertex {
            Vertex::Splats { partnered } => ("vertex", &records[..1 + usize::from(partnered)]),
            Vertex::Whole => ("whole", &[][..]),
        };
        let bind_group_layouts: Vec<_> = self.layouts.iter().map(|&layout| Some(layout)).collect();
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &bind_group_layouts,
            ..Default::default()
        });
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
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
                entry_point: Some(self.fragment),
                compilation_options: Default::default(),
                targets: self.targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
