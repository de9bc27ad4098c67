//! Height fields, and their tables from the GPU and the CPU.

#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part of the support")]

use std::ops::ControlFlow;

use gpu_context::{HeadlessDesc, upload};
use horizon_shadow::{
    Bake, Baker, Contents, Gpu, Heights, Parts, Precision, Search, TableDesc, Wrap, codes::Codes, cpu, wgpu,
};

pub fn gpu() -> Gpu {
    Gpu::headless(&HeadlessDesc::default()).expect("an adapter")
}

/// A height field.
#[derive(Clone, Debug)]
pub struct Field {
    pub size: [u32; 2],
    pub values: Vec<f32>,
    pub range: [f32; 2],
    pub wrap: [Wrap; 2],
}

impl Field {
    pub fn new(size: [u32; 2], height: impl Fn(u32, u32) -> f32) -> Self {
        let [width, rows] = size;
        let values: Vec<_> = (0..width * rows).map(|i| height(i % width, i / width)).collect();
        let finite = || values.iter().copied().filter(|h| h.is_finite());
        let range = [finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max)];
        Self { size, values, range, wrap: [Wrap::Repeat; 2] }
    }

    /// Rough ground that repeats: octaves of value noise, each half as high as the one before, down
    /// to a texel; heights of 0..1.
    pub fn rough(size: [u32; 2], seed: u32) -> Self {
        let mut octaves = Vec::new();
        let mut cell = (size[0].min(size[1]) / 4).max(1);
        let mut amplitude = 1.0;
        loop {
            octaves.push((cell, amplitude));
            if cell == 1 {
                break;
            }
            cell /= 2;
            amplitude *= 0.5;
        }
        let noise = |x: u32, y: u32| -> f32 {
            octaves.iter().map(|&(cell, amplitude)| amplitude * value_noise(size, [x, y], cell, seed)).sum()
        };
        let mut field = Self::new(size, noise);
        let [least, greatest] = field.range;
        field.values.iter_mut().for_each(|h| *h = (*h - least) / (greatest - least).max(1e-9));
        field.range = [0.0, 1.0];
        field
    }

    pub fn view(&self, gpu: &Gpu) -> wgpu::TextureView {
        let [width, height] = self.size;
        let bytes = bytemuck::cast_slice(&self.values);
        let format = wgpu::TextureFormat::R32Float;
        let texture = upload::texture_2d(gpu, "heights", width, height, format, bytes, None).expect("a map");
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    pub fn on_cpu(&self) -> cpu::HeightField<'_> {
        cpu::HeightField { size: self.size, values: &self.values, range: self.range, wrap: self.wrap }
    }

    /// Candidates of `count` curvatures for this field.
    pub fn desc(&self, count: u32, curvature_per_texel: [f32; 2], texels_per_height: f32) -> TableDesc {
        TableDesc {
            size: self.size,
            azimuths: 16,
            contents: Contents::Candidates { count, precision: Precision::Compact },
            wrap: self.wrap,
            curvature_per_texel,
            texels_per_height,
            radius_texels: 32.0,
        }
    }
}

fn value_noise(size: [u32; 2], at: [u32; 2], cell: u32, seed: u32) -> f32 {
    let cells = size.map(|side| side.div_ceil(cell));
    let corner =
        |dx: u32, dy: u32| hash((at[0] / cell + dx) % cells[0], (at[1] / cell + dy) % cells[1], seed ^ cell);
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let [fx, fy] = at.map(|c| smooth((c % cell) as f32 / cell as f32));
    let above = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * fx;
    let below = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * fx;
    above + (below - above) * fy
}

/// A number of 0..1 for a point.
pub fn hash(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    for _ in 0..2 {
        h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
        h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    }
    (h >> 8) as f32 / (1 << 24) as f32
}

/// Bakes everything and waits.
pub fn bake(
    gpu: &Gpu,
    baker: &Baker,
    field: &Field,
    desc: &TableDesc,
    search: Search,
    azimuths: u64,
) -> Bake {
    let view = field.view(gpu);
    let heights = Heights { view: &view, range: field.range };
    let mut bake = baker.start(gpu, desc, &heights, Parts::default(), azimuths).expect("a bake");
    record(gpu, baker, &mut bake, search);
    bake
}

/// Records what is pending and submits it.
pub fn record(gpu: &Gpu, baker: &Baker, bake: &mut Bake, search: Search) {
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    baker.record(gpu, &mut encoder, bake, search, u32::MAX).expect("recorded");
    gpu.queue().submit([encoder.finish()]);
}

/// The bytes of one azimuth's table, rows tightly packed as on the CPU.
pub fn layer(gpu: &Gpu, bake: &Bake, azimuth: u32) -> Vec<u8> {
    let desc = bake.desc();
    let view = if desc.candidates() > 0 { &bake.tables().candidates } else { &bake.tables().published };
    texture_layer(gpu, view.texture(), 0, azimuth)
}

/// The bytes of one layer of a level, rows tightly packed.
pub fn texture_layer(gpu: &Gpu, texture: &wgpu::Texture, level: u32, layer: u32) -> Vec<u8> {
    let size = texture.size().mip_level_size(level, wgpu::TextureDimension::D2);
    let row = size.width * texture.format().block_copy_size(None).expect("a plain format");
    let pitch = row.next_multiple_of(256);
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(pitch * size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(pitch),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d { width: size.width, height: size.height, depth_or_array_layers: 1 },
    );
    gpu.queue().submit([encoder.finish()]);
    let bytes = gpu_context::readback::read_buffer(gpu, &buffer).expect("readable");
    bytes.chunks_exact(pitch as usize).flat_map(|padded| &padded[..row as usize]).copied().collect()
}

/// One azimuth on the CPU.
pub fn cpu_layer(field: &Field, desc: &TableDesc, azimuth: u32) -> Vec<u8> {
    let go_on = |_| ControlFlow::Continue(());
    let mut tables = cpu::bake(&field.on_cpu(), desc, 1 << azimuth, &go_on).expect("a CPU bake");
    tables.azimuths.swap_remove(azimuth as usize)
}

/// Slope and distance of each texel's candidates for one node.
pub fn decoded(desc: &TableDesc, layer: &[u8], node: usize) -> Vec<[f32; 2]> {
    let Contents::Candidates { precision, .. } = desc.contents else { panic!("no candidates") };
    let codes = Codes::new(precision, desc.radius_texels);
    let bytes = if precision == Precision::Compact { 2 } else { 4 };
    let code = |texel: &[u8]| {
        let mut code = [0; 4];
        code[..bytes].copy_from_slice(&texel[node * bytes..][..bytes]);
        u32::from_le_bytes(code)
    };
    layer.chunks_exact(desc.texel_bytes() as usize).map(|texel| codes.decode(code(texel))).collect()
}

/// Tangent of the horizon of a candidate, exactly, in f64.
pub fn exact_tangent(kappa: f64, height: f64, slope: f64, distance: f64) -> f64 {
    let gamma = kappa * distance;
    let rise = slope * distance;
    let sinc = |x: f64| if x.abs() < 1e-9 { 1.0 } else { x.sin() / x };
    let s = distance * sinc(gamma);
    let c = 0.5 * kappa * distance * distance * sinc(0.5 * gamma).powi(2);
    if gamma.abs() >= std::f64::consts::FRAC_PI_2 || 1.0 + kappa * (height + rise) <= 0.0 {
        return -1e4;
    }
    (rise * gamma.cos() - (1.0 + kappa * height) * c) / ((1.0 + kappa * (height + rise)) * s)
}

/// The horizons in degrees that one node's candidates make at that node's curvature.
pub fn horizons_deg(field: &Field, desc: &TableDesc, layer: &[u8], node: usize) -> Vec<f64> {
    let kappa = f64::from(desc.nodes()[node]);
    let scale = f64::from(desc.texels_per_height);
    let candidates = decoded(desc, layer, node);
    let heights = field.values.iter().map(|&h| f64::from(h - field.range[0]) * scale);
    heights
        .zip(candidates)
        .map(|(h, [slope, distance])| {
            exact_tangent(kappa, h, slope.into(), distance.into()).atan().to_degrees()
        })
        .collect()
}
