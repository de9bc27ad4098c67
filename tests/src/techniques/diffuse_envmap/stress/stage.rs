//! A small environment whose every texel is known, on the GPU and in f64, for the functions that
//! read textures.
//!
//! The map and its residual are smooth; a chain level holds 2 + direction, brighter by a quarter a
//! level, so that directions and levels show in what is read; the tables hold arbitrary numbers of
//! the size that real ones have.

use super::twin::{self, Source};
use crate::{
    Context, bindings,
    technique::{Bound, Failure},
};
use compositor::wgpu;
use diffuse_envmap::model::{self, Map, Vec3};
use gpu_context::{Gpu, upload};
use half::f16;
use std::{f64::consts::TAU, sync::LazyLock};

/// Texels of the map.
pub(super) const MAP: [u32; 2] = [32, 16];
/// Edge of the chain's finest face, and its levels: the coarser the texels, the worse they hold a
/// direction.
pub(super) const FACE: u32 = 64;
const LEVELS: u32 = 3;
/// Texels and rows of the tables.
const TABLE: [u32; 2] = [96, 6];
const NODES: usize = 81;

/// The stage in f64.
pub(super) struct Stage {
    pub(super) map: Map,
    pub(super) residual: Map,
    /// Rows of texels.
    pub(super) tables: Vec<Vec<[f64; 4]>>,
    pub(super) sources: Vec<Source>,
}

pub(super) static STAGE: LazyLock<Stage> = LazyLock::new(Stage::new);

/// Nearest half float.
fn half(x: f64) -> f64 {
    f16::from_f64(x).to_f64()
}

impl Stage {
    fn new() -> Self {
        let map = |f: &dyn Fn(Vec3) -> Vec3| {
            let [width, height] = MAP.map(|side| side as usize);
            let empty = Map { width, height, texels: Vec::new() };
            let texel = |i: usize| f(empty.direction(i % width, i / width)).map(half);
            Map { width, height, texels: (0..width * height).map(texel).collect() }
        };
        let sources = vec![
            Source { axis: unit([0.3, 0.8, -0.5]), spread: 0.004, power: [0.5, 0.4, 0.3], extended: false },
            Source { axis: unit([-0.7, 0.1, 0.7]), spread: 0.03, power: [0.02, 0.05, 0.1], extended: true },
            Source { axis: unit([0.0, -1.0, 0.1]), spread: 0.05, power: [0.2, 0.2, 0.2], extended: true },
        ];
        Self {
            map: map(&|d| [1.0 + 0.5 * d[0], 1.0 + 0.3 * d[1] * d[2], 0.8 - 0.4 * d[2]]),
            residual: map(&|d| [0.5 + 0.2 * d[1], 0.6 + 0.2 * d[0], 0.4]),
            tables: tables(&sources),
            sources,
        }
    }

    /// A texel of row 2.
    fn coefficients(&self, first: usize, count: usize) -> Vec<Vec3> {
        self.tables[2][first..first + count].iter().map(|t| [t[0], t[1], t[2]]).collect()
    }

    pub(super) fn bands(&self, d: Vec3, band_1: f64, band_2: f64) -> Vec3 {
        twin::bands(&self.coefficients(0, 9), d, band_1, band_2)
    }

    pub(super) fn band_4(&self, d: Vec3) -> Vec3 {
        let factors = self.coefficients(10, 9);
        let basis = twin::band_4_basis(d);
        basis.iter().zip(factors).fold([0.0; 3], |sum, (&b, c)| model::add_scaled(sum, c, b))
    }

    /// Lobes near t = 1, by closed forms of the lobe's Legendre coefficients.
    pub(super) fn harmonics(&self, axis: Vec3, t: f64) -> Vec3 {
        let first = 2.0 * (1.0 + (std::f64::consts::FRAC_PI_2 * t).cos()) / (4.0 - t * t);
        let s = (1.0 - t).max(1e-6);
        let second = 0.25 * (1.0 + 3.0 * (std::f64::consts::FRAC_PI_2 * s).sin().powi(2) / (s * (2.0 - s)));
        let low = model::add_scaled(self.coefficients(0, 1)[0], self.bands(axis, first, second), 1.0);
        model::add_scaled(low, self.band_4(axis), -1.0 / 24.0).map(|x| x.max(0.0))
    }

    pub(super) fn narrow_tap(&self, d: Vec3, share: f64) -> Vec3 {
        let (whole, rest) = (self.map.sample(d), self.residual.sample(d));
        std::array::from_fn(|c| whole[c] + share * (rest[c] - whole[c]))
    }

    pub(super) fn narrow(&self, axis: Vec3, t: f64, share: f64) -> Vec3 {
        const SPACING: f64 = 0.634958;
        let mut sum = self.narrow_tap(axis, share).map(|x| 0.11042 * x);
        for (radius, offset, weight) in
            [(1.0, 0.0, 0.08305), (3.0_f64.sqrt(), 0.5, 0.04060), (2.0, 0.0, 0.02461)]
        {
            for step in 0..6 {
                let phi = TAU / 6.0 * (f64::from(step) + offset);
                let d = model::around(axis, radius * SPACING * t, phi);
                sum = model::add_scaled(sum, self.narrow_tap(d, share), weight);
            }
        }
        sum
    }

    /// A level of the chain: radiance, and root mean square luminance in w.
    pub(super) fn chain(d: Vec3, level: f64) -> [f64; 4] {
        let scale = 1.0 + 0.25 * (level + 5.0).clamp(0.0, f64::from(LEVELS - 1));
        let [r, g, b] = d.map(|x| scale * (2.0 + x));
        [r, g, b, scale * RMS]
    }

    pub(super) fn ring(axis: Vec3, normal: Vec3, angle: f64, level: f64, discard: bool) -> Vec3 {
        let (mut sum, mut weights) = ([0.0; 3], 1e-6);
        for tap in 0..6 {
            let d = model::around(axis, angle, TAU * (f64::from(tap) + 0.5) / 6.0);
            let above = (model::dot(d, normal) / angle * 2.0 + 0.5).clamp(0.0, 1.0);
            let weight = if discard { above } else { 1.0 };
            let [r, g, b, _] = Self::chain(d, level);
            sum = model::add_scaled(sum, [r, g, b], weight);
            weights += weight;
        }
        sum.map(|x| x / weights)
    }

    pub(super) fn wide(
        &self,
        axis: Vec3,
        normal: Vec3,
        t: f64,
        contrast_limit: f64,
        discard: bool,
    ) -> [f64; 4] {
        let node = ((t.log2() + 10.0) * 8.0).clamp(0.0, 80.0);
        let below = node.min(79.0).floor() as usize;
        let fraction = node - below as f64;
        let mix4 = |row: usize| -> [f64; 4] {
            let row = &self.tables[row];
            std::array::from_fn(|c| row[below][c] + fraction * (row[below + 1][c] - row[below][c]))
        };
        let ([axis_level, ring_angle, ring_level, _], lack) = (mix4(0), mix4(1));
        let [r, g, b, w] = Self::chain(axis, axis_level);
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let contrast = (w * w - luminance * luminance).max(0.0).sqrt() / luminance.max(1e-6);
        let share = (contrast / contrast_limit.max(1e-6) - 1.0).clamp(0.0, 1.0);
        let mix = |from: f64, to: f64| from + share * (to - from);
        let ring = Self::ring(axis, normal, ring_angle, ring_level, discard);
        let own = [r, g, b];
        let mut radiance: Vec3 = std::array::from_fn(|c| mix(own[c], ring[c]));
        if t > 0.15 {
            let bands = self.bands(axis, mix(lack[0], lack[2]), mix(lack[1], lack[3]));
            radiance = model::add_scaled(radiance, bands, 1.0);
        }
        let extended = |level| twin::extended_share(f64::from(FACE), level);
        let [r, g, b] = radiance.map(|x| x.max(0.0));
        [r, g, b, mix(extended(axis_level), extended(ring_level))]
    }

    pub(super) fn sheen(&self, axis: Vec3, normal: Vec3, t: f64, contrast_limit: f64, discard: bool) -> Vec3 {
        let texels = twin::WIDTH * t / std::f64::consts::PI * f64::from(MAP[1]);
        if texels < 0.5 {
            return self.map.sample(axis);
        }
        let wide_share = (2.5 * (t * f64::from(FACE) * 0.6057 / 2.0 - 0.8)).clamp(0.0, 1.0);
        let source_share = (2.0 * texels - 1.0).clamp(0.0, 1.0);
        let harmonics_share = ((t - 0.85) / 0.1).clamp(0.0, 1.0);
        let mut radiance = self.wide(axis, normal, t, contrast_limit, discard);
        let mut blend = |other: [f64; 4], share: f64| {
            radiance = std::array::from_fn(|c| radiance[c] + share * (other[c] - radiance[c]));
        };
        let [r, g, b] = self.narrow(axis, t, source_share);
        blend([r, g, b, 0.0], 1.0 - wide_share);
        let [r, g, b] = self.harmonics(axis, t);
        blend([r, g, b, 1.0], harmonics_share);
        let sources = twin::sources(&self.sources, axis, normal, t, radiance[3], discard);
        let [r, g, b, _] = radiance;
        model::add_scaled([r, g, b], sources, source_share.max(wide_share))
    }
}

/// Root mean square luminance of the chain, over its scale.
const RMS: f64 = 2.25;

fn unit(v: Vec3) -> Vec3 {
    model::normalize_or(v, [0.0, 1.0, 0.0]).map(|x| f64::from(x as f32))
}

fn tables(sources: &[Source]) -> Vec<Vec<[f64; 4]>> {
    let row = || vec![[0.0; 4]; TABLE[0] as usize];
    let (mut taps, mut lacks, mut harmonics) = (row(), row(), row());
    let (mut axes, mut powers, mut kinds) = (row(), row(), row());
    for (node, (taps, lack)) in taps.iter_mut().zip(&mut lacks).enumerate().take(NODES) {
        let x = node as f64 / (NODES - 1) as f64;
        let t = (10.0 * x - 10.0).exp2();
        // As in the real tables: harmonics fade in from t = 0.15.
        let wide = ((t - 0.15) / 0.15).clamp(0.0, 1.0);
        *taps = [-7.0 + 5.0 * x, 0.001 + 0.9 * x * x, -8.0 + 6.0 * x, 0.0];
        *lack = [0.1, -0.05, 0.05, 0.02].map(|lack| wide * lack);
    }
    for (i, factors) in harmonics.iter_mut().enumerate().take(19) {
        let x = i as f64;
        *factors = [0.3 * (x + 1.0).sin(), 0.2 * (2.0 * x).cos(), 0.25 * (x * x).sin(), 0.0];
    }
    harmonics[0] = [1.5, 1.2, 1.0, 0.0];
    harmonics[9] = [sources.len() as f64, 0.0, 1.0, 8.0];
    for (i, source) in sources.iter().enumerate() {
        let with = |[x, y, z]: Vec3, w| [x, y, z, w];
        axes[i] = with(source.axis, source.spread);
        powers[i] = with(source.power, 0.0);
        kinds[i] = [f64::from(u8::from(source.extended)), 0.0, 0.0, 0.0];
    }
    let mut rows = vec![taps, lacks, harmonics, axes, powers, kinds];
    // As the GPU holds them.
    for texel in rows.iter_mut().flatten() {
        *texel = texel.map(|x| f64::from(x as f32));
    }
    rows
}

/// Declarations of group 1, and the parameters that go with the stage.
const DECLARATIONS: &str = "
@group(1) @binding(0) var map: texture_2d<f32>;
@group(1) @binding(1) var residual: texture_2d<f32>;
@group(1) @binding(2) var chain: texture_cube<f32>;
@group(1) @binding(3) var tables: texture_2d<f32>;
@group(1) @binding(4) var linear: sampler;
fn stage(flags: u32) -> DiffuseEnvmapParameters {
    var p: DiffuseEnvmapParameters;
    p.rotation_cosine = 1.0;
    p.intensity = 1.0;
    p.map_size = vec2u(32u, 16u);
    p.face_size = 64u;
    p.method = 1u;
    p.flags = flags;
    p.paper_rays = 37u;
    p.one_tap_contrast = 0.15;
    return p;
}
";

/// Puts the stage on the GPU.
pub(super) fn bind(context: &mut Context) -> Result<Bound, Failure> {
    let gpu = context.gpu();
    let map = |name, map: &Map| -> Result<wgpu::TextureView, Failure> {
        let texels: Vec<_> =
            map.texels.iter().map(|t| [t[0] as f32, t[1] as f32, t[2] as f32, 1.0]).collect();
        let texture = upload::rgba16_float(gpu, name, MAP[0], MAP[1], &texels, None)?;
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    };
    let views = [map("map", &STAGE.map)?, map("residual", &STAGE.residual)?, chain(gpu), table(gpu)?];
    let sampler = gpu.device().create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let layout = layout(gpu.device());
    let mut entries: Vec<_> = (0..)
        .zip(&views)
        .map(|(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        })
        .collect();
    entries.push(wgpu::BindGroupEntry { binding: 4, resource: wgpu::BindingResource::Sampler(&sampler) });
    let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("stage"),
        layout: &layout,
        entries: &entries,
    });
    Ok(Bound { declarations: DECLARATIONS.into(), layout, group })
}

fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    use bindings::texture;
    use wgpu::TextureViewDimension as Dimension;
    let types = [
        texture(true, Dimension::D2),
        texture(true, Dimension::D2),
        texture(true, Dimension::Cube),
        texture(false, Dimension::D2),
        wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
    ];
    bindings::layout(device, "stage", &types)
}

fn table(gpu: &Gpu) -> Result<wgpu::TextureView, Failure> {
    let texels: Vec<[f32; 4]> = STAGE.tables.iter().flatten().map(|texel| texel.map(|x| x as f32)).collect();
    let format = wgpu::TextureFormat::Rgba32Float;
    let bytes = bytemuck::cast_slice(&texels);
    let texture = upload::texture_2d(gpu, "tables", TABLE[0], TABLE[1], format, bytes, None)?;
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

fn chain(gpu: &Gpu) -> wgpu::TextureView {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("chain"),
        size: wgpu::Extent3d { width: FACE, height: FACE, depth_or_array_layers: 6 },
        mip_level_count: LEVELS,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for level in 0..LEVELS {
        let size = FACE >> level;
        let texel = |i: u32| {
            let (x, y, face) = (i % size, i / size % size, i / (size * size));
            let at = [x, y].map(|at| (f64::from(at) + 0.5) / f64::from(size) * 2.0 - 1.0);
            let d = model::normalize_or(cube_direction(face, at), [0.0; 3]);
            Stage::chain(d, f64::from(level) - 5.0).map(f16::from_f64)
        };
        let texels: Vec<[f16; 4]> = (0..6 * size * size).map(texel).collect();
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(8 * size),
                rows_per_image: Some(size),
            },
            wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 6 },
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    })
}

/// The direction of a point of a cube face, as Vulkan and WebGPU define them.
pub(super) fn cube_direction(face: u32, [a, b]: [f64; 2]) -> Vec3 {
    match face {
        0 => [1.0, -b, -a],
        1 => [-1.0, -b, a],
        2 => [a, 1.0, b],
        3 => [a, -1.0, -b],
        4 => [a, -b, 1.0],
        _ => [-a, -b, -1.0],
    }
}
