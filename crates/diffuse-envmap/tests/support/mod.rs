//! Runs the technique's WGSL for a list of queries, as a host's compute shader would.

#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part of the support")]

use diffuse_envmap::{Camera, Desc, DiffuseEnvmap, Environment, Frame, Gpu, Settings, Work, model, wgpu};
use gpu_context::{HeadlessDesc, readback, upload};

/// One evaluation: unit normal, unit view direction towards the surface, roughness.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    pub normal: [f32; 3],
    pub view: [f32; 3],
    pub roughness: f32,
}

impl Query {
    /// A query whose mirror direction and normal are both `axis`, so that every lobe is about it.
    pub fn along(axis: [f32; 3], roughness: f32) -> Self {
        Self { normal: axis, view: axis.map(|x| -x), roughness }
    }
}

/// A device, and a technique that may already have built its environment.
pub struct Probe {
    pub gpu: Gpu,
    pub technique: DiffuseEnvmap,
    texture: Option<wgpu::Texture>,
    revision: u64,
}

const SHADER: &str = r"
@group(0) @binding(0) var<uniform> parameters: DiffuseEnvmapParameters;
@group(0) @binding(1) var map: texture_2d<f32>;
@group(0) @binding(2) var residual: texture_2d<f32>;
@group(0) @binding(3) var chain: texture_cube<f32>;
@group(0) @binding(4) var tables: texture_2d<f32>;
@group(0) @binding(5) var linear: sampler;
struct Query { normal_t: vec4f, view: vec4f }
@group(1) @binding(0) var<storage, read> queries: array<Query>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) { return; }
    let q = queries[id.x];
    answers[id.x] = vec4f(diffuse_envmap_radiance(map, residual, chain, tables, linear, parameters,
        q.normal_t.xyz, q.view.xyz, vec3f(0.0), q.normal_t.w, vec2u(id.x, 7u)), 1.0);
}
";

impl Probe {
    pub fn new() -> Self {
        Self::on(Gpu::headless(&HeadlessDesc::default()).expect("an adapter"))
    }

    pub fn on(gpu: Gpu) -> Self {
        let desc = Desc { target_format: wgpu::TextureFormat::Rgba16Float };
        let technique = DiffuseEnvmap::new(&gpu, &desc).expect("the technique");
        Self { gpu, technique, texture: None, revision: 0 }
    }

    /// Uploads a map as half floats and returns what the GPU then holds of it, in f64.
    pub fn set_map(&mut self, width: u32, height: u32, texels: &[[f32; 3]]) -> model::Map {
        let rgba: Vec<_> = texels.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        let texture =
            upload::rgba16_float(&self.gpu, "map", width, height, &rgba, None).expect("the map fits");
        self.set_texture(texture);
        let held = |x: f32| f64::from(half::f16::from_f32(x.min(65504.0)).to_f32());
        model::Map {
            width: width as usize,
            height: height as usize,
            texels: texels.iter().map(|texel| texel.map(held)).collect(),
        }
    }

    /// Takes a texture as it is.
    pub fn set_texture(&mut self, texture: wgpu::Texture) {
        self.texture = Some(texture);
        self.revision += 1;
    }

    /// Prepares a frame around the map without a surface buffer.
    pub fn prepare(&mut self, settings: &Settings, rotation_rad: f32, max_roughness: f32) -> Work {
        let view =
            self.texture.as_ref().map(|texture| texture.create_view(&wgpu::TextureViewDescriptor::default()));
        let frame = Frame {
            environment: view.as_ref().map(|view| Environment {
                view,
                revision: self.revision,
                intensity: 1.0,
                rotation_rad,
            }),
            surface: None,
            camera: Camera { world_from_clip: [[0.0; 4]; 4], eye_world: [0.0; 3] },
            max_roughness,
        };
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = self.technique.prepare(&self.gpu, &mut encoder, settings, &frame).expect("prepare");
        self.gpu.queue().submit([encoder.finish()]);
        work
    }

    /// Prepares and evaluates; one radiance a query.
    pub fn radiance(&mut self, settings: &Settings, queries: &[Query]) -> Vec<[f32; 3]> {
        self.prepare(settings, 0.0, 1.0);
        self.evaluate(queries)
    }

    /// Evaluates with what the last `prepare` left.
    pub fn evaluate(&self, queries: &[Query]) -> Vec<[f32; 3]> {
        use wgpu::util::DeviceExt as _;
        let device = self.gpu.device();
        let data: Vec<[f32; 8]> = queries
            .iter()
            .map(|q| {
                let ([a, b, c], [x, y, z]) = (q.normal, q.view);
                [a, b, c, q.roughness, x, y, z, 0.0]
            })
            .collect();
        let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("queries"),
            contents: bytemuck::cast_slice(&data),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let output = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("answers"),
            size: 16 * queries.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let pipeline = self.pipeline();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(1),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, self.technique.bind_group().expect("an environment"), &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups((queries.len() as u32).div_ceil(64), 1, 1);
        }
        self.gpu.queue().submit([encoder.finish()]);
        let bytes = readback::read_buffer(&self.gpu, &output).expect("the answers");
        bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().map(|&[r, g, b, _]| [r, g, b]).collect()
    }

    fn pipeline(&self) -> wgpu::ComputePipeline {
        let device = self.gpu.device();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(format!("{}{SHADER}", DiffuseEnvmap::library()).into()),
        });
        let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let queries = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[entry(0, true), entry(1, false)],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(self.technique.bind_group_layout()), Some(&queries)],
            immediate_size: 0,
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("probe"),
            layout: Some(&layout),
            module: &module,
            entry_point: Some("probe"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
    }
}

/// Evenly spread unit vectors (a Fibonacci sphere).
pub fn directions(count: usize) -> Vec<[f32; 3]> {
    (0..count)
        .map(|i| {
            let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
            let radius = (1.0 - y * y).sqrt();
            let angle = std::f64::consts::TAU * (i as f64 * 0.618_033_988_749_895).fract();
            [(radius * angle.cos()) as f32, y as f32, (radius * angle.sin()) as f32]
        })
        .collect()
}

/// Mean of (x - y)^2 / (y^2 + eps), eps = 0.01 of the mean squared reference.
pub fn relative_mse(found: &[[f32; 3]], reference: &[[f64; 3]]) -> f64 {
    let values = reference.len() as f64 * 3.0;
    let mean = reference.iter().flatten().sum::<f64>() / values;
    let eps = 0.01 * mean * mean;
    let pairs = found.iter().flatten().zip(reference.iter().flatten());
    pairs.map(|(&x, &y)| (f64::from(x) - y).powi(2) / (y * y + eps)).sum::<f64>() / values
}
