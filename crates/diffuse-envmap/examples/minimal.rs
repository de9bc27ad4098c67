//! A host's own program: one compute shader that calls the technique's library.
//!
//! Builds an environment of one bright lamp, asks what a surface that faces it reflects for
//! eleven roughnesses, and prints the answers: `cargo run --release -p diffuse-envmap --example minimal`.

use diffuse_envmap::wgpu::{self, util::DeviceExt as _};
use diffuse_envmap::{Camera, Desc, DiffuseEnvmap, Environment, Frame, Gpu, Settings};
use gpu_context::{HeadlessDesc, readback, upload};

const SHADER: &str = r"
@group(0) @binding(0) var<uniform> parameters: DiffuseEnvmapParameters;
@group(0) @binding(1) var map: texture_2d<f32>;
@group(0) @binding(2) var residual: texture_2d<f32>;
@group(0) @binding(3) var chain: texture_cube<f32>;
@group(0) @binding(4) var tables: texture_2d<f32>;
@group(0) @binding(5) var linear: sampler;
@group(1) @binding(0) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(16) fn shade(@builtin(global_invocation_id) id: vec3u) {
    let normal = vec3f(1.0, 0.0, 0.0);
    answers[id.x] = vec4f(diffuse_envmap_radiance(map, residual, chain, tables, linear, parameters,
        normal, -normal, vec3f(0.0), f32(id.x) / 10.0, id.xy), 1.0);
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The host's own device would come in through `Gpu::from_host`.
    let gpu = Gpu::headless(&HeadlessDesc::default())?;
    let device = gpu.device();
    let lamp = |i: u32| if (i % 64).abs_diff(32) < 3 && (i / 64).abs_diff(16) < 3 { 20.0 } else { 0.5 };
    let texels: Vec<_> = (0..64 * 32).map(|i| [lamp(i), lamp(i), 0.5, 1.0]).collect();
    let map = upload::rgba16_float(&gpu, "lamp", 64, 32, &texels, None)?;
    let view = map.create_view(&wgpu::TextureViewDescriptor::default());

    let mut lighting = DiffuseEnvmap::new(&gpu, &Desc { target_format: wgpu::TextureFormat::Rgba16Float })?;
    let frame = Frame {
        environment: Some(Environment { view: &view, revision: 1, intensity: 1.0, rotation_rad: 0.0 }),
        surface: None,
        camera: Camera { world_from_clip: [[0.0; 4]; 4], eye_world: [0.0; 3] },
        max_roughness: 1.0,
    };
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let work = lighting.prepare(&gpu, &mut encoder, &Settings::SHEEN, &frame)?;

    let source = wgpu::ShaderSource::Wgsl((DiffuseEnvmap::library() + SHADER).into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let answers = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: &[0; 16 * 16],
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
    });
    let pipeline = pipeline(device, lighting.bind_group_layout(), &module);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(1),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: answers.as_entire_binding() }],
    });
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, lighting.bind_group(), &[]);
    pass.set_bind_group(1, &group, &[]);
    pass.dispatch_workgroups(1, 1, 1);
    drop(pass);
    gpu.queue().submit([encoder.finish()]);

    println!("{}; {} passes to prepare", gpu.adapter_label(), work.passes);
    let bytes = readback::read_buffer(&gpu, &answers)?;
    for (i, [r, g, b, _]) in bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().take(11).enumerate() {
        println!("t = {:.1}: {r:7.3} {g:7.3} {b:7.3}", i as f32 / 10.0);
    }
    Ok(())
}

/// Group 0 is the technique's, group 1 the host's.
fn pipeline(
    device: &wgpu::Device,
    technique: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
) -> wgpu::ComputePipeline {
    let ty = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: false },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let host = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        }],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(technique), Some(&host)],
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&layout),
        module,
        entry_point: Some("shade"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}
