//! What is built from an environment, once while it stands: the chain and the tables.
//!
//! Dispatches: the five of `sources.wgsl` and its residual map, the chain's finest
//! level, one per coarser level, and the harmonics.

use gpu_context::{Gpu, upload};

use crate::{Error, tap_table::TAP_TABLE, taps};

/// Cells into which the search for sources divides the map, as in `sources.wgsl`.
const CELLS: [u32; 2] = [128, 64];
/// Bytes of a `Cell` of `sources.wgsl`.
const CELL_BYTES: u64 = 80;
/// Texels per row of the tables, at least [`taps::NODES`].
const TABLE_WIDTH: u32 = 96;
/// Rows of the tables, as in `library.wgsl`.
const TABLE_ROWS: u32 = 6;
/// Edge of the chain's coarsest face: its Gaussian is wider than any lobe needs.
const COARSEST_FACE: u32 = 4;
/// Harmonics are taken from the first level whose face is no larger.
const HARMONICS_FACE: u32 = 32;
/// Edges of the chain's finest face; the largest takes 64 MiB with its chain.
const FACE_SIZES: std::ops::RangeInclusive<u32> = 16..=1024;

/// The chain and tables of one environment.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub(crate) chain: wgpu::TextureView,
    pub(crate) tables: wgpu::TextureView,
    /// The map without its compact sources.
    pub(crate) residual: wgpu::TextureView,
    /// Edge of the chain's finest face in texels.
    pub(crate) face_size: u32,
    /// Compute passes that building took.
    pub(crate) passes: u32,
    pub(crate) memory_bytes: u64,
}

/// Edge of the chain's finest face for a map of so many rows: about a texel and a quarter of the map.
pub(crate) fn face_size(map_rows: u32) -> u32 {
    (map_rows / 2).clamp(*FACE_SIZES.start(), *FACE_SIZES.end()).next_power_of_two()
}

/// The pipelines that build a [`Prepared`]; made on first use.
#[derive(Debug)]
pub(crate) struct Builder {
    sources_layout: wgpu::BindGroupLayout,
    chain_layout: wgpu::BindGroupLayout,
    harmonics_layout: wgpu::BindGroupLayout,
    measure: wgpu::ComputePipeline,
    summarise: wgpu::ComputePipeline,
    excess: wgpu::ComputePipeline,
    classify: wgpu::ComputePipeline,
    select: wgpu::ComputePipeline,
    residual: wgpu::ComputePipeline,
    finest: wgpu::ComputePipeline,
    coarser: wgpu::ComputePipeline,
    harmonics: wgpu::ComputePipeline,
}

impl Builder {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        gpu.checked("diffuse-envmap's compute pipelines", Self::pipelines).map_err(Error::from)
    }

    fn pipelines(device: &wgpu::Device) -> Self {
        use wgpu::TextureViewDimension as Dimension;
        let storage = |format, dimension| wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format,
            view_dimension: dimension,
        };
        let half = wgpu::TextureFormat::Rgba16Float;
        let full = wgpu::TextureFormat::Rgba32Float;
        let sources_layout = layout(
            device,
            "sources",
            &[
                crate::texture_binding(Dimension::D2),
                storage_buffer(),
                storage_buffer(),
                storage(full, Dimension::D2),
                storage(half, Dimension::D2),
            ],
        );
        let chain_layout = layout(
            device,
            "chain",
            &[
                crate::texture_binding(Dimension::D2),
                crate::texture_binding(Dimension::Cube),
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                storage(half, Dimension::D2Array),
                crate::unfilterable(),
                storage(half, Dimension::D2Array),
            ],
        );
        let harmonics_layout = layout(
            device,
            "harmonics",
            &[
                crate::texture_binding(Dimension::Cube),
                storage(full, Dimension::D2),
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            ],
        );
        let sources = crate::shader(device, &shaders::DIFFUSE_ENVMAP_SOURCES);
        let chain = crate::shader(device, &shaders::DIFFUSE_ENVMAP_CHAIN);
        let harmonics = crate::shader(device, &shaders::DIFFUSE_ENVMAP_HARMONICS);
        Self {
            measure: pipeline(device, &sources_layout, &sources, "measure"),
            summarise: pipeline(device, &sources_layout, &sources, "summarise"),
            excess: pipeline(device, &sources_layout, &sources, "excess"),
            classify: pipeline(device, &sources_layout, &sources, "classify"),
            select: pipeline(device, &sources_layout, &sources, "select_sources"),
            residual: pipeline(device, &sources_layout, &sources, "residual"),
            finest: pipeline(device, &chain_layout, &chain, "finest"),
            coarser: pipeline(device, &chain_layout, &chain, "coarser"),
            harmonics: pipeline(device, &harmonics_layout, &harmonics, "project"),
            sources_layout,
            chain_layout,
            harmonics_layout,
        }
    }

    /// Records everything that turns a map into its chain and tables.
    pub(crate) fn build(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        map: &wgpu::TextureView,
        sampler: &wgpu::Sampler,
    ) -> Result<Prepared, Error> {
        let size = map.texture().size();
        let face_size = face_size(size.height);
        let levels = (face_size / COARSEST_FACE).ilog2() + 1;
        let half = wgpu::TextureFormat::Rgba16Float;
        let chain = texture(gpu, "diffuse-envmap chain", half, [face_size, face_size, 6], levels)?;
        let residual = texture(gpu, "diffuse-envmap residual", half, [size.width, size.height, 1], 1)?;
        let tables = tables(gpu)?;
        let tables_view = tables.create_view(&wgpu::TextureViewDescriptor::default());
        let residual_view = residual.create_view(&wgpu::TextureViewDescriptor::default());

        self.find_sources(gpu, encoder, map, &tables_view, &residual_view)?;
        self.fill_chain(gpu, encoder, &residual_view, &chain, &tables_view, sampler)?;

        let chain_bytes: u64 = (0..levels).map(|level| 6 * 8 * u64::from(face_size >> level).pow(2)).sum();
        Ok(Prepared {
            chain: chain.create_view(&cube_view()),
            tables: tables_view,
            residual: residual_view,
            face_size,
            passes: 7 + levels,
            memory_bytes: chain_bytes
                + u64::from(size.width) * u64::from(size.height) * 8
                + u64::from(TABLE_WIDTH * TABLE_ROWS) * 16,
        })
    }

    fn find_sources(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        map: &wgpu::TextureView,
        tables: &wgpu::TextureView,
        residual: &wgpu::TextureView,
    ) -> Result<(), Error> {
        let buffer = |label: &'static str, size| {
            gpu.checked(label, |device| {
                let usage = wgpu::BufferUsages::STORAGE;
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(label),
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            })
        };
        let cells = buffer("diffuse-envmap cells", u64::from(CELLS[0] * CELLS[1]) * CELL_BYTES)?;
        let summary = buffer("diffuse-envmap summary", 16)?;
        let group = bind_group(
            gpu.device(),
            &self.sources_layout,
            [
                wgpu::BindingResource::TextureView(map),
                cells.as_entire_binding(),
                summary.as_entire_binding(),
                wgpu::BindingResource::TextureView(tables),
                wgpu::BindingResource::TextureView(residual),
            ],
        );
        let [columns, rows] = CELLS;
        dispatch(encoder, &self.measure, &group, [columns, rows, 1]);
        dispatch(encoder, &self.summarise, &group, [1, 1, 1]);
        dispatch(encoder, &self.excess, &group, [columns, rows, 1]);
        dispatch(encoder, &self.classify, &group, [columns * rows / 64, 1, 1]);
        dispatch(encoder, &self.select, &group, [1, 1, 1]);
        let size = residual.texture().size();
        dispatch(encoder, &self.residual, &group, [size.width.div_ceil(8), size.height.div_ceil(8), 1]);
        Ok(())
    }

    /// Fills the chain level by level, and takes the harmonics on the way.
    ///
    /// Each level is written to the chain and to a texture of its own, from which the next is made:
    /// OpenGL cannot sample a single level of a texture while another is written.
    fn fill_chain(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        residual: &wgpu::TextureView,
        chain: &wgpu::Texture,
        tables: &wgpu::TextureView,
        sampler: &wgpu::Sampler,
    ) -> Result<(), Error> {
        let harmonics_level = (chain.width() / HARMONICS_FACE).max(1).ilog2();
        // The finest level does not read a finer one, but its binding must hold some cube.
        let mut finer = black_cube(gpu.device()).create_view(&cube_view());
        for level in 0..chain.mip_level_count() {
            let size = chain.width() >> level;
            let own = texture(gpu, "diffuse-envmap level", chain.format(), [size, size, 6], 1)?;
            let group = bind_group(
                gpu.device(),
                &self.chain_layout,
                [
                    wgpu::BindingResource::TextureView(residual),
                    wgpu::BindingResource::TextureView(&finer),
                    wgpu::BindingResource::Sampler(sampler),
                    wgpu::BindingResource::TextureView(&chain.create_view(&layers_view(level))),
                    wgpu::BindingResource::TextureView(tables),
                    wgpu::BindingResource::TextureView(&own.create_view(&layers_view(0))),
                ],
            );
            let pipeline = if level == 0 { &self.finest } else { &self.coarser };
            dispatch(encoder, pipeline, &group, [size.div_ceil(8), size.div_ceil(8), 6]);
            finer = own.create_view(&cube_view());
            if level == harmonics_level {
                self.project(gpu.device(), encoder, &finer, tables, sampler);
            }
        }
        Ok(())
    }

    fn project(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        level: &wgpu::TextureView,
        tables: &wgpu::TextureView,
        sampler: &wgpu::Sampler,
    ) {
        let group = bind_group(
            device,
            &self.harmonics_layout,
            [
                wgpu::BindingResource::TextureView(level),
                wgpu::BindingResource::TextureView(tables),
                wgpu::BindingResource::Sampler(sampler),
            ],
        );
        dispatch(encoder, &self.harmonics, &group, [1, 1, 1]);
    }
}

/// The tables with the fitted taps in their first two rows; the GPU fills the others.
fn tables(gpu: &Gpu) -> Result<wgpu::Texture, Error> {
    let mut texels = vec![[0.0_f32; 4]; (TABLE_WIDTH * TABLE_ROWS) as usize];
    for (row, values) in taps::table_texels(&TAP_TABLE).into_iter().enumerate() {
        texels[row * TABLE_WIDTH as usize..][..values.len()].copy_from_slice(&values);
    }
    let format = wgpu::TextureFormat::Rgba32Float;
    let tables = texture(gpu, "diffuse-envmap tables", format, [TABLE_WIDTH, TABLE_ROWS, 1], 1)?;
    let rows = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(TABLE_WIDTH * 16),
        rows_per_image: None,
    };
    gpu.queue().write_texture(tables.as_image_copy(), bytemuck::cast_slice(&texels), rows, tables.size());
    Ok(tables)
}

fn texture(
    gpu: &Gpu,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height, layers]: [u32; 3],
    levels: u32,
) -> Result<wgpu::Texture, Error> {
    upload::check_size(gpu, label, width, height)?;
    let usage = wgpu::TextureUsages::STORAGE_BINDING
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_DST
        | wgpu::TextureUsages::COPY_SRC;
    let desc = wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    };
    gpu.checked(label, |device| device.create_texture(&desc)).map_err(Error::from)
}

/// One texel of black on each face: stands where no chain is needed.
pub(crate) fn black_cube(device: &wgpu::Device) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("diffuse-envmap black cube"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 6 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

pub(crate) fn cube_view() -> wgpu::TextureViewDescriptor<'static> {
    wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::Cube), ..Default::default() }
}

/// The six faces of a level as an array, for writing.
fn layers_view(level: u32) -> wgpu::TextureViewDescriptor<'static> {
    wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        base_mip_level: level,
        mip_level_count: Some(1),
        ..Default::default()
    }
}

fn storage_buffer() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: false },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn layout(device: &wgpu::Device, name: &str, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    crate::bind_group_layout(device, name, wgpu::ShaderStages::COMPUTE, types)
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    entry_point: &str,
) -> wgpu::ComputePipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(entry_point),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(&layout),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

/// A bind group whose entries are numbered from 0.
pub(crate) fn bind_group<const N: usize>(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("diffuse-envmap"),
        layout,
        entries: &entries,
    })
}

fn dispatch(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::ComputePipeline,
    group: &wgpu::BindGroup,
    [x, y, z]: [u32; 3],
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.dispatch_workgroups(x, y, z);
}
