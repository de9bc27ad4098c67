//! Tone mapping, on the GPU and, as its twin, on the host.

use crate::{
    Error, ToneCurve,
    passes::{Fullscreen, LOADED, UNIFORM, bind_group, bind_group_layout, cleared, uniform_buffer},
    uniforms::ToneMapUniform,
};
use gpu_context::Gpu;
use std::collections::HashMap;

/// The largest finite half float: what the HDR image can hold, and all that a curve is asked for.
const HALF_MAX: f64 = 65504.0;

/// 2^EV; 1 for an exposure that is not a number. Exposures beyond +-32 stops count as +-32.
pub(crate) fn exposure_factor(exposure_ev: f32) -> f32 {
    if exposure_ev.is_nan() { 1.0 } else { exposure_ev.clamp(-32.0, 32.0).exp2() }
}

/// Display-referred linear colour, 0..1, of scene-referred linear radiance. NaN counts as 0.
pub fn display_linear(radiance: [f32; 3], exposure_ev: f32, curve: ToneCurve) -> [f32; 3] {
    let exposure = f64::from(exposure_factor(exposure_ev));
    let exposed = radiance.map(|x| if x > 0.0 { (f64::from(x) * exposure).min(HALF_MAX) } else { 0.0 });
    let color = match curve {
        ToneCurve::Linear => exposed,
        ToneCurve::PbrNeutral => pbr_neutral(exposed),
        ToneCurve::AcesFitted => aces_fitted(exposed),
    };
    color.map(|x| x.clamp(0.0, 1.0) as f32)
}

/// 8-bit sRGB of scene-referred linear radiance.
pub fn display_srgb8(radiance: [f32; 3], exposure_ev: f32, curve: ToneCurve) -> [u8; 3] {
    display_linear(radiance, exposure_ev, curve).map(|x| (srgb_encoded(x) * 255.0).round() as u8)
}

/// IEC 61966-2-1: the encoded value, 0..1, of a linear one, 0..1.
pub fn srgb_encoded(linear: f32) -> f32 {
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Khronos PBR Neutral Tone Mapper (`KhronosGroup/ToneMapping`, `PBR_Neutral`).
fn pbr_neutral(color: [f64; 3]) -> [f64; 3] {
    let (start, desaturation) = (0.8 - 0.04, 0.15);
    let low = color.into_iter().fold(f64::INFINITY, f64::min);
    let offset = if low < 0.08 { low - 6.25 * low * low } else { 0.04 };
    let color = color.map(|x| x - offset);
    let peak = color.into_iter().fold(0.0, f64::max);
    if peak < start {
        return color;
    }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    color.map(|x| x * (new_peak / peak) * (1.0 - g) + new_peak * g)
}

/// Stephen Hill's fit of the ACES reference rendering and sRGB output transforms
/// (`BakingLab`, `ACES.hlsl`).
fn aces_fitted(color: [f64; 3]) -> [f64; 3] {
    let input = [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
    let output =
        [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];
    let times =
        |matrix: [[f64; 3]; 3], v: [f64; 3]| matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    let fitted = times(input, color)
        .map(|v| (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081));
    times(output, fitted)
}

/// The pass; made when a frame is first shown.
pub(crate) struct ToneMap {
    layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    format: wgpu::TextureFormat,
    pipelines: HashMap<ToneCurve, wgpu::RenderPipeline>,
}

impl ToneMap {
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let device = gpu.device();
        let layout = bind_group_layout(device, "tone map", wgpu::ShaderStages::FRAGMENT, &[UNIFORM, LOADED]);
        let uniform = uniform_buffer(device, "tone map", size_of::<ToneMapUniform>());
        Self { layout, uniform, format, pipelines: HashMap::new() }
    }

    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        hdr: &wgpu::TextureView,
        target: &wgpu::TextureView,
        exposure_ev: f32,
        curve: ToneCurve,
    ) -> Result<(), Error> {
        if !self.pipelines.contains_key(&curve) {
            self.pipelines.insert(curve, self.pipeline(gpu, curve)?);
        }
        let Some(pipeline) = self.pipelines.get(&curve) else { return Ok(()) };
        let uniform = ToneMapUniform::new(exposure_ev);
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let resources = [self.uniform.as_entire_binding(), wgpu::BindingResource::TextureView(hdr)];
        let bind_group = bind_group(gpu.device(), "tone map", &self.layout, &resources);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone map"),
            color_attachments: &[Some(cleared(target))],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }

    fn pipeline(&self, gpu: &Gpu, curve: ToneCurve) -> Result<wgpu::RenderPipeline, Error> {
        let index = match curve {
            ToneCurve::Linear => 0.0,
            ToneCurve::PbrNeutral => 1.0,
            ToneCurve::AcesFitted => 2.0,
        };
        let encode = if self.format.is_srgb() { 0.0 } else { 1.0 };
        Fullscreen {
            label: "tone map",
            module: &shaders::COMPOSITOR_TONE_MAP,
            fragment: "tone_map_fragment",
            constants: &[("curve", index), ("encode_srgb", encode)],
            layouts: &[&self.layout],
            target: self.format.into(),
            depth_stencil: None,
        }
        .pipeline(gpu)
    }
}
