//! Runs the library's WGSL on tables of the tests' own making, as a host's compute shader would.

#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part of the support")]

pub mod random;

use gpu_context::{Gpu, HeadlessDesc, readback};
use horizon_shadow::wgpu::{self, util::DeviceExt as _};

/// `HorizonShadowParameters`, as `tables-library.wgsl` declares it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Parameters {
    pub size: [f32; 2],
    pub uv_scale: [f32; 2],
    pub heights: [f32; 2],
    pub height_scale_m: f32,
    pub texels_per_height: f32,
    pub curvature: [f32; 2],
    pub radius_texels: f32,
    pub slope_scale: f32,
    pub azimuths: u32,
    pub candidates: u32,
    pub contents: u32,
    pub wrap: u32,
    pub baked_azimuths: [u32; 2],
    pub method: u32,
    pub march_steps: u32,
    pub flags: u32,
    pub reserved: [u32; 3],
}

pub const NONE: u32 = 0;
pub const FLAT: u32 = 1;
pub const PAPER: u32 = 2;
pub const EXACT: u32 = 3;
pub const SHEEN: u32 = 4;
pub const CERTIFIED: u32 = 5;
pub const MARCHED: u32 = 6;

pub const CONTENTS_BETA_AND_DISTANCE: u32 = 1;
pub const CONTENTS_DISTANCE_AND_HEIGHT: u32 = 2;
pub const CONTENTS_COMPACT: u32 = 3;
pub const CONTENTS_FULL: u32 = 4;

/// What the shader reads.
#[derive(Clone, Debug)]
pub struct Tables {
    pub parameters: Parameters,
    pub heights: Vec<f32>,
    /// Angle and distance codes of each azimuth, row and texel.
    pub published: Vec<[u8; 2]>,
    /// Words of each azimuth, row and texel.
    pub candidates: Vec<u32>,
    pub words: u32,
    /// Least and greatest of each azimuth, row and texel of the tiles.
    pub extents: Vec<[u8; 2]>,
    /// As half floats would have them, for one level of the size of `moments_size`.
    pub moments: Vec<[f32; 4]>,
    pub moments_size: [u32; 2],
}

/// One evaluation.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Query {
    pub uv: [f32; 2],
    pub uv_step: [f32; 2],
    pub normal: [f32; 3],
    pub light_radius_rad: f32,
    pub along_u: [f32; 3],
    pub unused_0: f32,
    pub along_v: [f32; 3],
    pub unused_1: f32,
    pub second_form: [f32; 3],
    pub unused_2: f32,
    pub light: [f32; 3],
    pub unused_3: f32,
}

impl Query {
    /// A point of a plane whose mesh uv 0..1 spans `extent_m` metres along x and y.
    pub fn on_plane(uv: [f32; 2], extent_m: [f32; 2], light: [f32; 3]) -> Self {
        Self {
            uv,
            uv_step: [0.0; 2],
            normal: [0.0, 0.0, 1.0],
            light_radius_rad: 0.0,
            along_u: [extent_m[0], 0.0, 0.0],
            unused_0: 0.0,
            along_v: [0.0, extent_m[1], 0.0],
            unused_1: 0.0,
            second_form: [0.0; 3],
            unused_2: 0.0,
            light,
            unused_3: 0.0,
        }
    }
}

/// What the library says.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Answer {
    pub normal: [f32; 3],
    pub visibility: f32,
    pub ambient: [f32; 4],
    pub horizon: f32,
    pub height_m: f32,
    pub unused: [f32; 2],
}

impl Answer {
    pub fn numbers(&self) -> &[f32] {
        bytemuck::cast_slice(std::slice::from_ref(self))
    }
}

const SHADER: &str = r"
@group(0) @binding(0) var<uniform> parameters: HorizonShadowParameters;
@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var published: texture_2d_array<f32>;
@group(0) @binding(3) var candidates: texture_2d_array<u32>;
@group(0) @binding(4) var extents: texture_2d_array<f32>;
@group(0) @binding(5) var moments: texture_2d_array<f32>;
@group(0) @binding(6) var ambient: texture_2d_array<f32>;
@group(0) @binding(7) var linear: sampler;
struct Query {
    uv: vec2f, uv_step: vec2f, normal: vec3f, light_radius_rad: f32, along_u: vec3f, along_v: vec3f,
    second_form: vec3f, light: vec3f,
}
struct Answer { normal: vec3f, visibility: f32, ambient: vec4f, horizon: f32, height_m: f32, unused: vec2f }
@group(1) @binding(0) var<storage, read> queries: array<Query>;
@group(1) @binding(1) var<storage, read_write> answers: array<Answer>;

fn surface_of(q: Query) -> HorizonShadowSurface {
    return HorizonShadowSurface(q.uv, vec2f(q.uv_step.x, 0.0), vec2f(0.0, q.uv_step.y), q.normal, q.along_u,
        q.along_v, q.second_form);
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if at >= arrayLength(&queries) { return; }
    let q = queries[at];
    let surface = surface_of(q);
    answers[at].visibility = horizon_shadow_visibility(heights, published, candidates, extents, moments, linear,
        parameters, surface, q.light, q.light_radius_rad);
    answers[at].normal = horizon_shadow_normal(heights, parameters, surface);
    answers[at].ambient = horizon_shadow_ambient(ambient, linear, parameters, surface);
    answers[at].height_m = horizon_shadow_height_m(heights, parameters, q.uv);
}

@compute @workgroup_size(64)
fn probe_horizon(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if at >= arrayLength(&queries) { return; }
    let q = queries[at];
    answers[at].horizon = horizon_shadow_horizon(heights, published, candidates, extents, moments, linear,
        parameters, surface_of(q), q.light);
}
";

/// A device and the library's functions on it.
pub struct Probe {
    pub gpu: Gpu,
    layout: wgpu::BindGroupLayout,
    queries: wgpu::BindGroupLayout,
    pipelines: [wgpu::ComputePipeline; 2],
}

impl Probe {
    pub fn new() -> Self {
        let gpu = Gpu::headless(&HeadlessDesc::default()).expect("an adapter");
        let device = gpu.device();
        let layout = tables_layout(device);
        let storage = |binding, read_only| {
            entry(
                binding,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
            )
        };
        let queries = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[storage(0, true), storage(1, false)],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(
                format!("{}{SHADER}", shaders::HORIZON_SHADOW_LIBRARY.source()).into(),
            ),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout), Some(&queries)],
            immediate_size: 0,
        });
        let pipelines = ["probe", "probe_horizon"].map(|entry_point| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        });
        Self { gpu, layout, queries, pipelines }
    }

    /// One answer a query.
    pub fn evaluate(&self, tables: &Tables, queries: &[Query]) -> Vec<Answer> {
        let device = self.gpu.device();
        let group = self.bind(tables);
        let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("queries"),
            contents: bytemuck::cast_slice(queries),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let output = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("answers"),
            size: (size_of::<Answer>() * queries.len()) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let buffers = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.queries,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for pipeline in &self.pipelines {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, &buffers, &[]);
            pass.dispatch_workgroups((queries.len() as u32).div_ceil(64), 1, 1);
        }
        self.gpu.queue().submit([encoder.finish()]);
        let bytes = readback::read_buffer(&self.gpu, &output).expect("the answers");
        bytemuck::cast_slice::<u8, Answer>(&bytes).to_vec()
    }

    fn texture(&self, format: wgpu::TextureFormat, size: [u32; 3], bytes: &[u8]) -> wgpu::TextureView {
        let texture = self.gpu.device().create_texture_with_data(
            self.gpu.queue(),
            &wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: size[2] },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
            wgpu::util::TextureDataOrder::LayerMajor,
            bytes,
        );
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        })
    }

    fn bind(&self, tables: &Tables) -> wgpu::BindGroup {
        use wgpu::TextureFormat as Format;
        let device = self.gpu.device();
        let parameters = &tables.parameters;
        let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("parameters"),
            contents: bytemuck::bytes_of(parameters),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let [width, height] = parameters.size.map(|texels| texels as u32);
        let layers = parameters.azimuths;
        let heights = self.gpu.device().create_texture_with_data(
            self.gpu.queue(),
            &wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: Format::R32Float,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
            wgpu::util::TextureDataOrder::LayerMajor,
            bytemuck::cast_slice(&tables.heights),
        );
        let format = [Format::R32Uint, Format::Rg32Uint, Format::Rgba32Uint][tables.words as usize / 2];
        let halves: Vec<u16> = tables.moments.iter().flatten().map(|&x| half_bits(x)).collect();
        let [moments_width, moments_height] = tables.moments_size;
        let views = [
            heights.create_view(&wgpu::TextureViewDescriptor::default()),
            self.texture(Format::Rg8Unorm, [width, height, layers], bytemuck::cast_slice(&tables.published)),
            self.texture(format, [width, height, layers], bytemuck::cast_slice(&tables.candidates)),
            self.texture(
                Format::Rg8Unorm,
                [width.div_ceil(8), height.div_ceil(8), layers],
                bytemuck::cast_slice(&tables.extents),
            ),
            self.texture(
                Format::Rgba16Float,
                [moments_width, moments_height, layers],
                bytemuck::cast_slice(&halves),
            ),
            self.texture(Format::Rgba8Unorm, [1, 1, 2], &[128, 128, 255, 255, 128, 128, 255, 255]),
        ];
        let address = |bit: u32| {
            if parameters.wrap & bit != 0 {
                wgpu::AddressMode::Repeat
            } else {
                wgpu::AddressMode::ClampToEdge
            }
        };
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: address(1),
            address_mode_v: address(2),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }];
        entries.extend((1..).zip(&views).map(|(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        }));
        entries.push(wgpu::BindGroupEntry { binding: 7, resource: wgpu::BindingResource::Sampler(&sampler) });
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &entries,
        })
    }
}

fn entry(binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None }
}

fn tables_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    use wgpu::{TextureSampleType as Sample, TextureViewDimension as Dimension};
    let texture = |binding, sample_type, view_dimension| {
        entry(binding, wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false })
    };
    let filterable = Sample::Float { filterable: true };
    let unfilterable = Sample::Float { filterable: false };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[
            entry(
                0,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
            ),
            texture(1, unfilterable, Dimension::D2),
            texture(2, filterable, Dimension::D2Array),
            texture(3, Sample::Uint, Dimension::D2Array),
            texture(4, unfilterable, Dimension::D2Array),
            texture(5, filterable, Dimension::D2Array),
            texture(6, filterable, Dimension::D2Array),
            entry(7, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
        ],
    })
}

/// The half float nearest to a number of moderate size.
fn half_bits(x: f32) -> u16 {
    let bits = x.to_bits();
    let exponent = ((bits >> 23) & 255) as i32 - 127;
    let sign = ((bits >> 16) & 0x8000) as u16;
    if exponent < -14 {
        return sign | (x.abs() * 16_777_216.0).round() as u16;
    }
    let mantissa = (bits & 0x7f_ffff) + 0x1000;
    sign | ((((exponent + 15) as u32) << 10) + (mantissa >> 13)) as u16
}
