//! One map on the GPU and every method on it: the same surfaces, the same shader, one adapter.

use super::{baselines::Baselines, maps::TestMap};
use crate::technique::{Failure, Role};
use compositor::wgpu::{self, util::DeviceExt as _};
use diffuse_envmap::{Camera, Desc, DiffuseEnvmap, Distribution, Environment, Frame, Method, Settings, Work};
use gpu_context::{Gpu, Mipmaps, readback, upload};
use std::collections::HashMap;

/// A method of lighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// The mirror direction alone, whatever the roughness.
    Mirror,
    /// The published formula with so many rays, turned in each pixel.
    Brute(u32),
    /// The published method: 64 rays, the same pattern for each pixel.
    Paper,
    /// Ours, as it is used.
    Sheen,
    /// Ours with every tap everywhere.
    SheenFull,
    /// A cube map prefiltered with so many samples a texel.
    Prefiltered(u32),
    /// Nine harmonics.
    Harmonics,
}

impl Way {
    pub(super) fn name(self) -> String {
        match self {
            Self::Mirror => "mirror only".into(),
            Self::Brute(1) => "brute force, 1 ray".into(),
            Self::Brute(rays) => format!("brute force, {rays} rays"),
            Self::Paper => "paper, 64 rays".into(),
            Self::Sheen => "sheen".into(),
            Self::SheenFull => "sheen, every tap".into(),
            Self::Prefiltered(samples) => format!("prefiltered, {samples} samples"),
            Self::Harmonics => "harmonics alone".into(),
        }
    }

    pub(super) fn role(self) -> Role {
        match self {
            Self::Sheen => Role::Ours,
            Self::Paper => Role::Paper,
            _ => Role::Baseline,
        }
    }

    /// Methods that differ in their number of samples only.
    pub(super) fn series(self) -> Option<String> {
        match self {
            Self::Brute(_) => Some("brute force".into()),
            Self::Prefiltered(_) => Some("prefiltered".into()),
            _ => None,
        }
    }

    /// Texture lookups of one surface, where that is a fixed number.
    pub(super) fn taps(self) -> Option<u32> {
        match self {
            Self::Mirror | Self::Prefiltered(_) => Some(1),
            Self::Brute(rays) => Some(rays),
            Self::Paper => Some(64),
            Self::Harmonics => Some(0),
            Self::Sheen | Self::SheenFull => None,
        }
    }

    /// The technique's settings: of the method itself, or those that give a baseline its horizon
    /// and axis.
    pub(super) fn settings(self) -> Settings {
        let rays = |rays, rotate| Settings {
            method: Method::Paper { rays, distribution: Distribution::Cosine, rotate },
            ..Settings::PAPER
        };
        match self {
            Self::Sheen => Settings::SHEEN,
            Self::SheenFull => Settings::SHEEN_FULL,
            Self::Brute(count) => rays(count, true),
            Self::Paper => Settings::PAPER,
            Self::Mirror | Self::Prefiltered(_) | Self::Harmonics => rays(1, false),
        }
    }

    fn entry_point(self) -> &'static str {
        match self {
            Self::Mirror => "mirror_only",
            Self::Brute(_) | Self::Paper | Self::Sheen | Self::SheenFull => "technique",
            Self::Prefiltered(_) => "prefiltered_lookup",
            Self::Harmonics => "harmonics_alone",
        }
    }
}

/// A surface: unit normal, unit direction from the eye, roughness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Query {
    pub(super) normal: [f32; 3],
    pub(super) view: [f32; 3],
    pub(super) roughness: f32,
}

/// Surfaces on the GPU, and room for their answers.
#[derive(Debug)]
pub(super) struct Surfaces {
    count: u32,
    answers: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// The methods, and the map that they were last given.
pub(super) struct Lab {
    gpu: Gpu,
    technique: DiffuseEnvmap,
    baselines: Baselines,
    mipmaps: HashMap<wgpu::TextureFormat, Mipmaps>,
    pipelines: HashMap<&'static str, wgpu::ComputePipeline>,
    module: wgpu::ShaderModule,
    surfaces_layout: wgpu::BindGroupLayout,
    map: Option<wgpu::Texture>,
    revision: u64,
}

impl Lab {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, Failure> {
        let technique = DiffuseEnvmap::new(gpu, &Desc { target_format: wgpu::TextureFormat::Rgba16Float })?;
        let device = gpu.device();
        let source = format!("{}{}", DiffuseEnvmap::library(), include_str!("lookup.wgsl"));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("lookup"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let surfaces_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("surfaces"),
            entries: &[entry(0, true), entry(1, false)],
        });
        Ok(Self {
            gpu: gpu.clone(),
            technique,
            baselines: Baselines::new(gpu)?,
            mipmaps: HashMap::new(),
            pipelines: HashMap::new(),
            module,
            surfaces_layout,
            map: None,
            revision: 0,
        })
    }

    /// Uploads a map: half floats where they hold it, else full ones.
    pub(super) fn set_map(&mut self, map: &TestMap) -> Result<(), Failure> {
        let (width, height) = (map.environment.width, map.environment.height);
        let rgba: Vec<_> = map.environment.pixels.iter().map(|&[r, g, b]| [r, g, b, 1.0_f32]).collect();
        let format = if map.fits_half() {
            wgpu::TextureFormat::Rgba16Float
        } else {
            wgpu::TextureFormat::Rgba32Float
        };
        if !self.mipmaps.contains_key(&format) {
            self.mipmaps.insert(format, Mipmaps::new(&self.gpu, format)?);
        }
        let mips = self.mipmaps.get(&format);
        let texture = if map.fits_half() {
            upload::rgba16_float(&self.gpu, map.name, width, height, &rgba, mips)?
        } else {
            upload::texture_2d(&self.gpu, map.name, width, height, format, bytemuck::cast_slice(&rgba), mips)?
        };
        self.set_texture(texture);
        Ok(())
    }

    /// Takes a texture as it is.
    pub(super) fn set_texture(&mut self, texture: wgpu::Texture) {
        self.map = Some(texture);
        self.revision += 1;
    }

    /// The map's content counts as changed from now on.
    pub(super) fn touch(&mut self) {
        self.revision += 1;
    }

    /// Builds whatever a method precomputes, if it does not stand, and waits for it.
    pub(super) fn build(&mut self, way: Way) -> Result<Work, Failure> {
        let Some(map) = self.map.clone() else { return Err("there is no map".into()) };
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        match way {
            Way::Prefiltered(samples) => {
                let mipmaps = self.mipmaps.get(&map.format()).ok_or("the map has no mip chain")?;
                self.baselines.prefilter(&self.gpu, &mut encoder, &map, mipmaps, samples)?;
            }
            Way::Harmonics => self.baselines.project(&self.gpu, &mut encoder, &map),
            _ => {}
        }
        let work = self.prepare(&mut encoder, &map, &way.settings())?;
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(work)
    }

    fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        map: &wgpu::Texture,
        settings: &Settings,
    ) -> Result<Work, Failure> {
        let view = map.create_view(&wgpu::TextureViewDescriptor::default());
        let frame = Frame {
            environment: Some(Environment {
                view: &view,
                revision: self.revision,
                intensity: 1.0,
                rotation_rad: 0.0,
            }),
            surface: None,
            camera: Camera { world_from_clip: [[0.0; 4]; 4], eye_world: [0.0; 3] },
            max_roughness: 1.0,
        };
        Ok(self.technique.prepare(&self.gpu, encoder, settings, &frame)?)
    }

    /// Bytes that a method holds for the map, besides the map itself.
    pub(super) fn memory_bytes(&self, way: Way) -> u64 {
        let map = self.map.as_ref().map_or(0, |map| {
            let texel = map.format().block_copy_size(None).unwrap_or(0);
            u64::from(map.width()) * u64::from(map.height()) * u64::from(texel)
        });
        match way {
            Way::Sheen | Way::SheenFull => self.technique.memory_bytes(),
            Way::Prefiltered(_) => self.baselines.prefiltered_bytes(map),
            Way::Harmonics => 9 * 16,
            Way::Mirror | Way::Brute(_) | Way::Paper => 0,
        }
    }

    /// Puts surfaces on the GPU.
    pub(super) fn surfaces(&self, queries: &[Query]) -> Surfaces {
        let device = self.gpu.device();
        let data: Vec<[f32; 8]> = queries
            .iter()
            .map(|q| {
                let ([a, b, c], [x, y, z]) = (q.normal, q.view);
                [a, b, c, q.roughness, x, y, z, 0.0]
            })
            .collect();
        let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("queries"),
            contents: bytemuck::cast_slice(&data),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let answers = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("answers"),
            size: 16 * queries.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.surfaces_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: answers.as_entire_binding() },
            ],
        });
        Surfaces { count: queries.len() as u32, answers, group }
    }

    /// Records the lighting of all surfaces with what `build` left.
    pub(super) fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        way: Way,
        surfaces: &Surfaces,
    ) -> Result<(), Failure> {
        let entry_point = way.entry_point();
        if !self.pipelines.contains_key(entry_point) {
            self.pipelines.insert(entry_point, self.pipeline(entry_point)?);
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipelines[entry_point]);
        pass.set_bind_group(0, self.technique.bind_group(), &[]);
        pass.set_bind_group(1, &surfaces.group, &[]);
        pass.set_bind_group(2, self.baselines.group(), &[]);
        pass.dispatch_workgroups(surfaces.count.div_ceil(64), 1, 1);
        Ok(())
    }

    /// Lights all surfaces and waits: one frame of a program that does nothing else.
    pub(super) fn frame(&mut self, way: Way, surfaces: &Surfaces) -> Result<(), Failure> {
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.record(&mut encoder, way, surfaces)?;
        self.gpu.queue().submit([encoder.finish()]);
        Ok(self.gpu.wait()?)
    }

    /// The answers of the last frame.
    pub(super) fn answers(&self, surfaces: &Surfaces) -> Result<Vec<[f32; 3]>, Failure> {
        let bytes = readback::read_buffer(&self.gpu, &surfaces.answers)?;
        Ok(bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().map(|&[r, g, b, _]| [r, g, b]).collect())
    }

    /// Builds what is missing and lights all queries.
    pub(super) fn radiance(&mut self, way: Way, queries: &[Query]) -> Result<Vec<[f32; 3]>, Failure> {
        self.build(way)?;
        let surfaces = self.surfaces(queries);
        self.frame(way, &surfaces)?;
        self.answers(&surfaces)
    }

    fn pipeline(&self, entry_point: &str) -> Result<wgpu::ComputePipeline, Failure> {
        let layouts =
            [self.technique.bind_group_layout(), &self.surfaces_layout, self.baselines.layout()].map(Some);
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
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        })?;
        Ok(pipeline)
    }
}
