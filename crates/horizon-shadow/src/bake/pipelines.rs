//! The pipelines of a bake and the shapes of their bindings.

use gpu_context::{Gpu, wgpu};

use crate::{
    Error,
    bindings::{bind_group_layout, shader},
};

/// Bytes from one [`super::uniforms::Step`] to the next, as uniform offsets must be aligned.
pub(crate) const STEP_STRIDE: u64 = 256;

/// The pipelines that bake; one serves any number of tables.
#[derive(Debug)]
pub struct Baker {
    /// Uniform with a dynamic offset, and the six buffers of `bake.wgsl`.
    pub(super) layout: wgpu::BindGroupLayout,
    /// The height map.
    pub(super) heights_layout: wgpu::BindGroupLayout,
    pub(super) relief: wgpu::ComputePipeline,
    pub(super) sweep: wgpu::ComputePipeline,
    pub(super) search: wgpu::ComputePipeline,
    /// Candidates, and the texture whose coarser level is made.
    pub(super) parts_layout: wgpu::BindGroupLayout,
    pub(super) extents: wgpu::ComputePipeline,
    pub(super) moments: wgpu::ComputePipeline,
    pub(super) ambient: wgpu::ComputePipeline,
    pub(super) halve: wgpu::ComputePipeline,
}

impl Baker {
    /// Makes the pipelines.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        gpu.checked("horizon-shadow's compute pipelines", Self::pipelines).map_err(Error::from)
    }

    fn pipelines(device: &wgpu::Device) -> Self {
        let stages = wgpu::ShaderStages::COMPUTE;
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: true,
            min_binding_size: None,
        };
        let mut types = [storage(); 7];
        types[0] = uniform;
        let layout = bind_group_layout(device, "horizon-shadow bake", stages, &types);
        let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let heights = texture(float, wgpu::TextureViewDimension::D2);
        let heights_layout = bind_group_layout(device, "horizon-shadow heights", stages, &[heights]);
        let array = wgpu::TextureViewDimension::D2Array;
        let part_textures = [texture(wgpu::TextureSampleType::Uint, array), texture(float, array)];
        let parts_layout = bind_group_layout(device, "horizon-shadow parts", stages, &part_textures);
        let part = |entry_point| {
            let layouts = [Some(&layout), Some(&parts_layout)];
            pipeline(device, &layouts, &shaders::HORIZON_SHADOW_BAKE_PARTS, entry_point)
        };
        let both = [Some(&layout), Some(&heights_layout)];
        Self {
            relief: pipeline(device, &both, &shaders::HORIZON_SHADOW_BAKE_RELIEF, "take_relief"),
            sweep: pipeline(device, &both[..1], &shaders::HORIZON_SHADOW_BAKE_SWEEP, "sweep"),
            search: pipeline(device, &both[..1], &shaders::HORIZON_SHADOW_BAKE_SEARCH, "search"),
            extents: part("extents"),
            moments: part("moments"),
            ambient: part("ambient"),
            halve: part("halve"),
            layout,
            heights_layout,
            parts_layout,
        }
    }
}

const fn storage() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: false },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn pipeline(
    device: &wgpu::Device,
    layouts: &[Option<&wgpu::BindGroupLayout>],
    module: &shaders::Module,
    entry_point: &str,
) -> wgpu::ComputePipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(entry_point),
        bind_group_layouts: layouts,
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(&layout),
        module: &shader(device, module),
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}
