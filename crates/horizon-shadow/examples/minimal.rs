//! A host's own program: a ball with a bumpy height map, lit in the host's own shader.
//!
//! `cargo run --release -p horizon-shadow --example minimal [-- FILE.png]`

use gpu_context::{HeadlessDesc, readback, upload};
use horizon_shadow::wgpu::{self, TextureFormat};
use horizon_shadow::{Frame, Gpu, HeightMap, HorizonShadow, Settings, Surface, Wrap};

const SIDE: u32 = 512;
const MAP: u32 = 128;
/// The map around the ball of radius 1, from pole to pole.
const UV_SCALE: [f32; 2] = [4.0, 2.0];

const SHADER: &str = r"
@group(0) @binding(0) var<uniform> parameters: HorizonShadowParameters;
@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var published: texture_2d_array<f32>;
@group(0) @binding(3) var candidates: texture_2d_array<u32>;
@group(0) @binding(4) var extents: texture_2d_array<f32>;
@group(0) @binding(5) var moments: texture_2d_array<f32>;
@group(0) @binding(6) var ambient: texture_2d_array<f32>;
@group(0) @binding(7) var linear: sampler;

@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i / 2u) * 4.0 - 1.0, f32(i % 2u) * 4.0 - 1.0, 0.0, 1.0);
}

// A ball of radius 1 seen along -z. A host with meshes takes all this from its vertices.
@fragment fn ball(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let p = (pixel.xy / 512.0 * 2.0 - 1.0) * vec2f(1.05, -1.05);
    let n = vec3f(p, sqrt(max(1.0 - dot(p, p), 0.0)));
    let ring = max(length(n.xz), 1e-6);
    let uv = vec2f(atan2(n.x, n.z), atan2(n.y, ring)) / vec2f(6.2831853, -3.1415927) + 0.5;
    var surface: HorizonShadowSurface;
    surface.uv = uv;
    surface.uv_dx = dpdx(uv);
    surface.uv_dy = dpdy(uv);
    surface.normal_world = n;
    surface.along_u_world = 6.2831853 * vec3f(n.z, 0.0, -n.x);
    surface.along_v_world = -3.1415927 * vec3f(-n.x * n.y / ring, ring, -n.z * n.y / ring);
    // On a ball of radius 1 the second fundamental form is the first.
    let u = surface.along_u_world;
    let v = surface.along_v_world;
    surface.second_form = vec3f(dot(u, u), dot(u, v), dot(v, v));

    let light = normalize(vec3f(-1.0, 0.5, 0.35));
    let lit = horizon_shadow_visibility(heights, published, candidates, extents, moments, linear,
        parameters, surface, light, 0.01);
    let bump = horizon_shadow_normal(heights, parameters, surface);
    let radiance = 0.02 + 0.9 * lit * max(dot(bump, light), 0.0);
    return vec4f(vec3f(select(0.1, pow(radiance, 1.0 / 2.2), dot(p, p) < 1.0)), 1.0);
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The host's own device would come in through `Gpu::from_host`.
    let gpu = Gpu::headless(&HeadlessDesc::default())?;
    let wave = |i: u32| (i as f32 * std::f32::consts::TAU * 4.0 / MAP as f32).sin();
    let bumps: Vec<f32> = (0..MAP * MAP).map(|i| (wave(i % MAP) * wave(i / MAP)).max(0.0)).collect();
    let bytes = bytemuck::cast_slice(&bumps);
    let heights = upload::texture_2d(&gpu, "bumps", MAP, MAP, TextureFormat::R32Float, bytes, None)?;
    let frame = Frame {
        height_map: Some(HeightMap {
            view: &heights.create_view(&wgpu::TextureViewDescriptor::default()),
            revision: 1,
            changed_rows: None,
            range: [0.0, 1.0],
            height_scale_m: 0.06,
            uv_scale: UV_SCALE,
            wrap: [Wrap::Repeat; 2],
        }),
        surface: Surface {
            texel_m: std::f32::consts::PI / (UV_SCALE[1] * MAP as f32),
            curvature_per_m: [1.0, 1.0],
        },
        needed_azimuths: u64::MAX,
    };
    let mut shadows = HorizonShadow::new(&gpu)?;
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let work = shadows.prepare(&gpu, &mut encoder, &Settings::SHEEN, &frame)?;
    println!("{}: {} passes, {} bytes", gpu.adapter_label(), work.passes, shadows.memory_bytes());

    let picture = picture(gpu.device());
    let pipeline = pipeline(gpu.device(), &shadows);
    let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
    let target = wgpu::RenderPassColorAttachment {
        view: &view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations::default(),
    };
    let desc = wgpu::RenderPassDescriptor { color_attachments: &[Some(target)], ..Default::default() };
    let mut pass = encoder.begin_render_pass(&desc);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, shadows.bind_group(), &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    gpu.queue().submit([encoder.finish()]);

    let file = std::env::args().nth(1).unwrap_or_else(|| "horizon-shadow.png".into());
    let image = readback::read_texture(&gpu, &picture, 0, 0)?;
    let bytes: Vec<u8> = image.values.iter().map(|x| (x * 255.0).round() as u8).collect();
    image::save_buffer(&file, &bytes, SIDE, SIDE, image::ColorType::Rgba8)?;
    println!("{file}");
    Ok(())
}

fn picture(device: &wgpu::Device) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// Group 0 is the technique's; the library stands before the host's own shader.
fn pipeline(device: &wgpu::Device, shadows: &HorizonShadow) -> wgpu::RenderPipeline {
    let source = wgpu::ShaderSource::Wgsl((HorizonShadow::library() + SHADER).into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        bind_group_layouts: &[Some(shadows.bind_group_layout())],
        ..Default::default()
    });
    let options = wgpu::PipelineCompilationOptions::default();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("ball"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("ball"),
            compilation_options: options,
            targets: &[Some(TextureFormat::Rgba8Unorm.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
