//! The technique's bind group, and what making one takes.

use gpu_context::{Gpu, wgpu};

use crate::Wrap;

pub(crate) fn shader(device: &wgpu::Device, module: &shaders::Module) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(module.path),
        source: wgpu::ShaderSource::Wgsl(module.source().into()),
    })
}

pub(crate) const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

const FILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: true };
const LOADED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };

const fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

/// The layout of the technique's bind group. wgpu takes layouts of equal entries for one another,
/// so that the ready pass and every surface may make their own.
pub(crate) fn technique_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    use wgpu::TextureViewDimension::{D2, D2Array};
    bind_group_layout(
        device,
        "horizon-shadow",
        wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE,
        &[
            UNIFORM,
            texture(LOADED, D2),
            texture(FILTERED, D2Array),
            texture(wgpu::TextureSampleType::Uint, D2Array),
            texture(LOADED, D2Array),
            texture(FILTERED, D2Array),
            texture(FILTERED, D2Array),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        ],
    )
}

/// A layout whose entries are numbered from 0.
pub(crate) fn bind_group_layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty: *ty, count: None })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A bind group whose entries are numbered from 0.
pub(crate) fn bind_group<const N: usize>(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

pub(crate) fn uniform_buffer(
    gpu: &Gpu,
    label: &str,
    bytes: usize,
) -> Result<wgpu::Buffer, gpu_context::Error> {
    gpu.checked(label, |device| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })
}

/// Stands in for tables that are not there. Two layers, because OpenGL takes an array of one for no
/// array.
#[derive(Debug)]
pub(crate) struct Empty {
    /// For tables of floats, filtered or not.
    pub(crate) floats: wgpu::TextureView,
    /// For candidates.
    pub(crate) candidates: wgpu::TextureView,
}

impl Empty {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, gpu_context::Error> {
        gpu.checked("horizon-shadow's empty tables", |device| Self {
            floats: empty_array(device, wgpu::TextureFormat::Rgba8Unorm),
            candidates: empty_array(device, wgpu::TextureFormat::R32Uint),
        })
    }
}

fn empty_array(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("horizon-shadow empty"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 2 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// The technique's sampler, which wraps as the map does.
pub(crate) fn sampler(device: &wgpu::Device, wrap: [Wrap; 2]) -> wgpu::Sampler {
    let [address_mode_u, address_mode_v] = wrap.map(|wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("horizon-shadow"),
        address_mode_u,
        address_mode_v,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}
