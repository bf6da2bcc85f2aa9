//! A compute pipeline around the renderer's own WGSL of the clip test.

use std::io::Write;
use std::sync::mpsc;
use std::time::Duration;

use glam::DVec2;
use qsplat::model::clip_curve::Conic;
use qsplat::render::gpu;
use wgpu::util::DeviceExt;

/// Questions answered by one workgroup: the least that WGSL promises for one side is 256.
const GROUP: u32 = 64;

/// Far more than a software adapter needs for a million tests.
const PATIENCE: Duration = Duration::from_secs(120);

/// Asks the clip test of the renderer about one place after another.
const QUESTIONS: &str = "
struct Question {
    place: vec2<f32>,
    conic: u32,
    _pad: u32,
}

@group(0) @binding(0) var<storage, read> questions: array<Question>;
@group(0) @binding(2) var<storage, read_write> answers: array<u32>;

@compute @workgroup_size(GROUP)
fn answer(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&questions) {
        let question = questions[id.x];
        answers[id.x] = u32(clipped_away(question.conic, 1u, question.place));
    }
}
";

/// A place to test against the conic of this number.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Question {
    place: [f32; 2],
    conic: u32,
    pad: u32,
}

impl Question {
    /// The place must be one of 32-bit numbers.
    pub fn new(place: DVec2, conic: usize) -> Self {
        Self { place: place.as_vec2().to_array(), conic: conic as u32, pad: 0 }
    }
}

/// A graphics device.
pub struct Device {
    /// The adapter's name.
    pub name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Device {
    /// The adapter, by the rule of the twins' own test: without one the comparison is left out,
    /// which is said on standard error even when the test passes; where CI or QSPLAT_REQUIRE_GPU
    /// say so it is an error.
    #[allow(clippy::explicit_write)] // `eprintln` is held back by the test harness
    pub fn open() -> Option<Self> {
        let fault = match Self::best() {
            Ok(device) => return Some(device),
            Err(fault) => fault,
        };
        let set = |name: &str, value: &str| std::env::var(name).is_ok_and(|given| given == value);
        let required = set("CI", "true") || set("QSPLAT_REQUIRE_GPU", "1");
        assert!(!required, "the WGSL clip test cannot be tested: {fault}");
        writeln!(
            std::io::stderr(),
            "\n*** NO GRAPHICS ADAPTER: THE WGSL CLIP TEST IS NOT TESTED ***\n{fault}"
        )
        .unwrap();
        None
    }

    fn best() -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let wanted = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&wanted)).map_err(|e| e.to_string())?;
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|e| e.to_string())?;
        Ok(Self { name: adapter.get_info().name, device, queue })
    }

    /// Which of the questions the shader says are cut away.
    pub fn cuts(&self, conics: &[Conic], questions: &[Question]) -> Vec<bool> {
        let records: Vec<[f32; 8]> = conics.iter().map(record).collect();
        let size = size_of::<u32>() as u64 * questions.len() as u64;
        let buffers = [
            self.filled(bytemuck::cast_slice(questions)),
            self.filled(bytemuck::cast_slice(&records)),
            self.empty(size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC),
        ];
        let pipeline = self.pipeline();
        let entries: Vec<_> = (0..)
            .zip(&buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = pipeline.get_bind_group_layout(0);
        let bound = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        let read = self.empty(size, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bound, &[]);
        pass.dispatch_workgroups((questions.len() as u32).div_ceil(GROUP), 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&buffers[2], 0, &read, 0, size);
        self.answers(encoder.finish(), &read)
    }

    fn pipeline(&self) -> wgpu::ComputePipeline {
        let source = format!("const GROUP: u32 = {GROUP}u;\n{}{QUESTIONS}", gpu::clip_source());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("clip test"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("clip test"),
            layout: None,
            module: &module,
            entry_point: Some("answer"),
            compilation_options: Default::default(),
            cache: None,
        })
    }

    fn filled(&self, contents: &[u8]) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE;
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    fn empty(&self, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        self.device.create_buffer(&descriptor)
    }

    fn answers(&self, commands: wgpu::CommandBuffer, read: &wgpu::Buffer) -> Vec<bool> {
        let submission = self.queue.submit([commands]);
        let (sender, receiver) = mpsc::channel();
        read.map_async(wgpu::MapMode::Read, .., move |mapped| sender.send(mapped).unwrap());
        let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
        self.device.poll(wait).unwrap();
        receiver.try_recv().unwrap().unwrap();
        let mapped = read.get_mapped_range(..).unwrap();
        bytemuck::cast_slice::<u8, u32>(&mapped).iter().map(|&answer| answer != 0).collect()
    }
}

/// `Conic` of `clip.wgsl`.
fn record(conic: &Conic) -> [f32; 8] {
    let [p1, p2, p3] = [conic.p1, conic.p2, conic.p3].map(|p| p.as_vec2());
    [p1.x, p1.y, p2.x, p2.y, p3.x, p3.y, conic.rho as f32, 0.0]
}
