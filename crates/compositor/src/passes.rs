//! What every pass of the compositor needs to build its pipeline.

use crate::Error;
use gpu_context::Gpu;

/// A pass that covers the whole target with one triangle.
pub(crate) struct Fullscreen<'a> {
    pub(crate) label: &'a str,
    pub(crate) module: &'a shaders::Module,
    pub(crate) fragment: &'a str,
    pub(crate) constants: &'a [(&'a str, f64)],
    pub(crate) layouts: &'a [&'a wgpu::BindGroupLayout],
    pub(crate) target: wgpu::ColorTargetState,
    pub(crate) depth_stencil: Option<wgpu::DepthStencilState>,
}

impl Fullscreen<'_> {
    pub(crate) fn pipeline(self, gpu: &Gpu) -> Result<wgpu::RenderPipeline, Error> {
        Ok(gpu.checked(self.label, |device| {
            let module = shader(device, self.label, self.module);
            let options = wgpu::PipelineCompilationOptions {
                constants: self.constants,
                ..wgpu::PipelineCompilationOptions::default()
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(self.label),
                layout: Some(&layout(device, self.label, self.layouts)),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("fullscreen"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: self.depth_stencil,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(self.fragment),
                    compilation_options: options,
                    targets: &[Some(self.target)],
                }),
                multiview_mask: None,
                cache: None,
            })
        })?)
    }
}

pub(crate) fn shader(device: &wgpu::Device, label: &str, module: &shaders::Module) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(module.source().into()),
    })
}

pub(crate) fn layout(
    device: &wgpu::Device,
    label: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().copied().map(Some).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

pub(crate) fn bind_group_layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    bindings: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entry = |(binding, &ty): (usize, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
        binding: binding as u32,
        visibility,
        ty,
        count: None,
    };
    let entries: Vec<_> = bindings.iter().enumerate().map(entry).collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

pub(crate) fn bind_group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let mut entries = Vec::with_capacity(resources.len());
    for (binding, resource) in resources.iter().enumerate() {
        entries.push(wgpu::BindGroupEntry { binding: binding as u32, resource: resource.clone() });
    }
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

pub(crate) const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

pub(crate) const STORAGE: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Storage { read_only: true },
    has_dynamic_offset: false,
    min_binding_size: None,
};

pub(crate) const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

/// Depth is read texel by texel as a number: OpenGL's shading language cannot load a texel of a
/// depth texture.
pub(crate) const DEPTH: wgpu::BindingType = LOADED;
pub(crate) const FILTERED: wgpu::BindingType = texture(wgpu::TextureSampleType::Float { filterable: true });
pub(crate) const LOADED: wgpu::BindingType = texture(wgpu::TextureSampleType::Float { filterable: false });

const fn texture(sample_type: wgpu::TextureSampleType) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    }
}

/// A uniform buffer of this size, to be written before each use.
pub(crate) fn uniform_buffer(device: &wgpu::Device, label: &str, bytes: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A colour attachment that keeps what is there.
pub(crate) fn loaded(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    attachment(view, wgpu::LoadOp::Load)
}

/// A colour attachment that starts at 0.
pub(crate) fn cleared(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    attachment(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))
}

fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// What adds to the HDR image and leaves its coverage alone.
pub(crate) fn additive(format: wgpu::TextureFormat) -> wgpu::ColorTargetState {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState { color: add, alpha: add }),
        write_mask: wgpu::ColorWrites::COLOR,
    }
}
