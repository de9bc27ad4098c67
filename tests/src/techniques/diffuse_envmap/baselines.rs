//! What a user would pick instead, built on the same adapter: a cube map prefiltered by the lobe,
//! and nine harmonics.

use gpu_context::{Gpu, Mipmaps};

use crate::{bindings, technique::Failure};
use compositor::wgpu;

/// Edge of the prefiltered cube's finest face.
const FACE: u32 = 256;
/// Its levels, down to faces of 8 texels: level 0 holds the mirror, and lobes double in width with
/// the texels up to t = 1 in the last.
const LEVELS: u32 = 6;

/// The uniform of `prefiltered.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Prefilter {
    roughness: f32,
    samples: u32,
    map_size: [u32; 2],
}

/// Builds the baselines of a map, as often as asked.
pub(super) struct Baselines {
    sampler: wgpu::Sampler,
    level_pipeline: wgpu::ComputePipeline,
    harmonics_pipeline: wgpu::ComputePipeline,
    cube: wgpu::Texture,
    coefficients: wgpu::Buffer,
    uniform: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
}

impl Baselines {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, Failure> {
        gpu.checked("the baselines of diffuse-envmap", Self::with_device).map_err(Failure::from)
    }

    fn with_device(device: &wgpu::Device) -> Self {
        let source =
            format!("{}{}", shaders::DIFFUSE_ENVMAP_LIBRARY.source(), include_str!("prefiltered.wgsl"));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("prefiltered"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = |entry_point| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: None,
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let cube = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("prefiltered"),
            size: wgpu::Extent3d { width: FACE, height: FACE, depth_or_array_layers: 6 },
            mip_level_count: LEVELS,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let buffer = |size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let coefficients = buffer(9 * 16, wgpu::BufferUsages::STORAGE);
        let uniform = buffer(16, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
        let layout = lookup_layout(device);
        let view = cube.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::Cube),
            ..Default::default()
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries([
                wgpu::BindingResource::TextureView(&view),
                coefficients.as_entire_binding(),
                uniform.as_entire_binding(),
            ]),
        });
        Self {
            level_pipeline: pipeline("prefilter_level"),
            harmonics_pipeline: pipeline("project_map"),
            sampler,
            cube,
            coefficients,
            uniform,
            layout,
            group,
        }
    }

    /// Group 2 of `lookup.wgsl`.
    pub(super) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bindings of what was built last.
    pub(super) fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// Bytes of the prefiltered cube, with the mip chain of a map of so many bytes.
    pub(super) fn prefiltered_bytes(map_bytes: u64) -> u64 {
        let cube: u64 = (0..LEVELS).map(|level| 6 * 8 * u64::from(FACE >> level).pow(2)).sum();
        cube + map_bytes / 3
    }

    /// Records the mip chain of a map (which has room for it) and all levels of the cube, with so
    /// many samples a texel.
    pub(super) fn prefilter(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        map: &wgpu::Texture,
        mipmaps: &Mipmaps,
        samples: u32,
    ) -> Result<(), Failure> {
        mipmaps.generate(gpu, encoder, map)?;
        let last = (LEVELS - 1) as f32;
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&[last, 0.0, 0.0, 0.0]));
        let map_view = map.create_view(&wgpu::TextureViewDescriptor::default());
        for level in 0..LEVELS {
            let roughness = if level == 0 { 0.0 } else { (level as f32 - last).exp2() };
            let uniform = Self::prefilter_uniform(gpu, map, roughness, samples);
            let target = self.cube.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            });
            let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.level_pipeline.get_bind_group_layout(0),
                entries: &entries([
                    wgpu::BindingResource::TextureView(&map_view),
                    wgpu::BindingResource::Sampler(&self.sampler),
                    wgpu::BindingResource::TextureView(&target),
                    uniform.as_entire_binding(),
                ]),
            });
            let groups = (FACE >> level).div_ceil(8);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.level_pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(groups, groups, 6);
        }
        Ok(())
    }

    /// Records the projection of a map on nine harmonics.
    pub(super) fn project(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, map: &wgpu::Texture) {
        let uniform = Self::prefilter_uniform(gpu, map, 0.0, 0);
        let view = map.create_view(&wgpu::TextureViewDescriptor::default());
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.harmonics_pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 3, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 4, resource: self.coefficients.as_entire_binding() },
            ],
        });
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.harmonics_pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    fn prefilter_uniform(gpu: &Gpu, map: &wgpu::Texture, roughness: f32, samples: u32) -> wgpu::Buffer {
        use wgpu::util::DeviceExt as _;
        let values = Prefilter { roughness, samples, map_size: [map.width(), map.height()] };
        gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::bytes_of(&values),
            usage: wgpu::BufferUsages::UNIFORM,
        })
    }
}

fn entries<const N: usize>(resources: [wgpu::BindingResource<'_>; N]) -> Vec<wgpu::BindGroupEntry<'_>> {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    (0..).zip(resources).map(entry).collect()
}

fn lookup_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let types = [
        bindings::texture(true, wgpu::TextureViewDimension::Cube),
        bindings::storage(true),
        bindings::uniform(),
    ];
    bindings::layout(device, "baselines", &types)
}
