//! One height map on the GPU and every method on it: the same surfaces, the same shader.

use super::ways::Way;
use crate::{bindings, technique::Failure};
use compositor::wgpu::{self, util::DeviceExt as _};
use gpu_context::{Gpu, readback, upload};
use horizon_shadow::{Frame, HeightMap, HorizonShadow, Method, Settings, Surface, Work, Wrap};
use std::{collections::HashMap, sync::Arc};

/// A height map on a surface: all that the tables depend on.
#[derive(Clone, Debug)]
pub(super) struct Relief {
    /// Tells reliefs apart.
    pub(super) name: String,
    /// The map.
    pub(super) map: scene::HeightMap,
    /// Metres between the map's 0 and 1.
    pub(super) height_scale_m: f32,
    /// How often the map repeats over the surface's uv.
    pub(super) uv_scale: [f32; 2],
    /// What lies beyond the map.
    pub(super) wrap: [Wrap; 2],
    /// What the tables must suit.
    pub(super) surface: Surface,
    /// Directions of the tables.
    pub(super) azimuths: u32,
    /// How far the search goes.
    pub(super) radius_texels: f32,
}

impl Relief {
    /// Least and greatest height of the map.
    pub(super) fn range(&self) -> [f32; 2] {
        let finite = || self.map.heights.iter().copied().filter(|height| height.is_finite());
        [finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max)]
    }
}

/// A point of a surface and a light, as `lookup.wgsl` declares it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Query {
    pub(super) uv: [f32; 2],
    pub(super) light_radius_rad: f32,
    pub(super) pad: f32,
    pub(super) uv_dx: [f32; 2],
    pub(super) uv_dy: [f32; 2],
    pub(super) normal_world: [f32; 4],
    pub(super) along_u_world: [f32; 4],
    pub(super) along_v_world: [f32; 4],
    pub(super) second_form: [f32; 4],
    pub(super) light_world: [f32; 4],
}

/// Queries on the GPU, and room for their answers.
#[derive(Debug)]
pub(super) struct Queries {
    count: u32,
    answers: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// What is asked of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Quantity {
    /// 0 dark ... 1 lit.
    Visibility,
    /// The sine of the horizon's elevation towards the light's azimuth.
    Horizon,
}

/// A height map that is on the GPU.
struct Held {
    relief: Arc<Relief>,
    view: wgpu::TextureView,
    revision: u64,
}

/// The methods, and the relief that they were last given.
pub(super) struct Lab {
    gpu: Gpu,
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    pipelines: HashMap<(Quantity, Method), wgpu::ComputePipeline>,
    techniques: HashMap<Way, HorizonShadow>,
    held: Option<Held>,
    revision: u64,
    prefilter: bool,
}

impl Lab {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, Failure> {
        let source = format!("{}{}", HorizonShadow::library(), include_str!("lookup.wgsl"));
        let module = gpu.checked("horizon lookup", |device| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("horizon lookup"),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        })?;
        let types = [bindings::storage(true), bindings::storage(false)];
        Ok(Self {
            gpu: gpu.clone(),
            module,
            layout: bindings::layout(gpu.device(), "queries", &types),
            pipelines: HashMap::new(),
            techniques: HashMap::new(),
            held: None,
            revision: 0,
            prefilter: false,
        })
    }

    /// Brings a relief onto the GPU, unless it is there.
    pub(super) fn hold(&mut self, relief: &Arc<Relief>) -> Result<(), Failure> {
        if self.held.as_ref().is_some_and(|held| Arc::ptr_eq(&held.relief, relief)) {
            return Ok(());
        }
        let map = &relief.map;
        let format = wgpu::TextureFormat::R32Float;
        let bytes = bytemuck::cast_slice(&map.heights);
        let texture = upload::texture_2d(&self.gpu, &map.name, map.width, map.height, format, bytes, None)?;
        self.revision += 1;
        self.held = Some(Held {
            relief: Arc::clone(relief),
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            revision: self.revision,
        });
        Ok(())
    }

    /// The heights count as changed from now on.
    pub(super) fn touch(&mut self) {
        self.revision += 1;
        if let Some(held) = &mut self.held {
            held.revision = self.revision;
        }
    }

    /// Whether what is smaller than a pixel is prefiltered, from now on.
    pub(super) fn set_prefilter(&mut self, prefilter: bool) {
        self.prefilter = prefilter;
    }

    /// Makes a method's tables, if they do not stand, and waits for them.
    pub(super) fn build(&mut self, way: Way) -> Result<Work, Failure> {
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = self.prepare(&mut encoder, way)?;
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(work)
    }

    /// Records what a method prepares.
    pub(super) fn prepare(&mut self, encoder: &mut wgpu::CommandEncoder, way: Way) -> Result<Work, Failure> {
        let held = self.held.as_ref().ok_or("there is no height map")?;
        let technique = match self.techniques.remove(&way) {
            Some(technique) => technique,
            None => HorizonShadow::new(&self.gpu)?,
        };
        let technique = self.techniques.entry(way).or_insert(technique);
        let relief = &held.relief;
        let frame = Frame {
            height_map: Some(HeightMap {
                view: &held.view,
                revision: held.revision,
                changed_rows: None,
                range: relief.range(),
                height_scale_m: relief.height_scale_m,
                uv_scale: relief.uv_scale,
                wrap: relief.wrap,
            }),
            surface: relief.surface,
            needed_azimuths: u64::MAX,
        };
        let prefilter = self.prefilter;
        let settings = Settings { prefilter, ..way.settings(relief.azimuths, relief.radius_texels) };
        Ok(technique.prepare(&self.gpu, encoder, &settings, &frame)?)
    }

    /// A method's technique; it has to be built.
    pub(super) fn technique(&self, way: Way) -> Result<&HorizonShadow, Failure> {
        self.techniques.get(&way).ok_or_else(|| format!("{} is not built", way.name()).into())
    }

    /// Bytes that a method holds for the map, besides the map itself.
    pub(super) fn memory_bytes(&self, way: Way) -> u64 {
        self.techniques.get(&way).map_or(0, HorizonShadow::memory_bytes)
    }

    /// Puts queries on the GPU.
    pub(super) fn queries(&self, queries: &[Query]) -> Queries {
        let device = self.gpu.device();
        let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("queries"),
            contents: bytemuck::cast_slice(queries),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let answers = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("answers"),
            size: 4 * queries.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: answers.as_entire_binding() },
            ],
        });
        Queries { count: queries.len() as u32, answers, group }
    }

    /// What a method answers to the queries, on the relief that is held.
    pub(super) fn answers(
        &mut self,
        quantity: Quantity,
        way: Way,
        queries: &Queries,
    ) -> Result<Vec<f32>, Failure> {
        self.build(way)?;
        let method = way.settings(4, 2.0).method;
        let key = (quantity, method);
        if !self.pipelines.contains_key(&key) {
            let pipeline = self.pipeline(quantity, method, way)?;
            self.pipelines.insert(key, pipeline);
        }
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipelines[&key]);
            let group = self.technique(way)?.bind_group().ok_or("the technique has no bind group")?;
            pass.set_bind_group(0, group, &[]);
            pass.set_bind_group(1, &queries.group, &[]);
            pass.dispatch_workgroups(queries.count.div_ceil(64), 1, 1);
        }
        self.gpu.queue().submit([encoder.finish()]);
        let bytes = readback::read_buffer(&self.gpu, &queries.answers)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    fn pipeline(
        &self,
        quantity: Quantity,
        method: Method,
        way: Way,
    ) -> Result<wgpu::ComputePipeline, Failure> {
        let entry_point = match quantity {
            Quantity::Visibility => "visibility",
            Quantity::Horizon => "horizon",
        };
        let layouts = [self.technique(way)?.bind_group_layout(), &self.layout].map(Some);
        let constants = [("method", f64::from(code(method)))];
        let pipeline = self.gpu.checked(entry_point, |device| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &layouts,
                immediate_size: 0,
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&layout),
                module: &self.module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                cache: None,
            })
        })?;
        Ok(pipeline)
    }
}

/// The number of a method in the shaders: `HORIZON_SHADOW_METHOD_*`.
fn code(method: Method) -> u32 {
    match method {
        Method::None => 0,
        Method::Flat => 1,
        Method::Paper => 2,
        Method::Exact => 3,
        Method::Sheen => 4,
        Method::Certified => 5,
        Method::Marched => 6,
    }
}
