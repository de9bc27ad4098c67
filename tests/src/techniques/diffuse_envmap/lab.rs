//! One map on the GPU and every method on it: the same surfaces, the same shader, one adapter.

use super::{baselines::Baselines, maps::TestMap};
use crate::{
    bindings,
    technique::{Failure, Role},
};
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
    /// So many rays, each drawn by itself.
    Independent(u32),
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
            Self::Independent(rays) => format!("independent rays, {rays}"),
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
            Self::Independent(_) => Some("independent rays".into()),
            Self::Prefiltered(_) => Some("prefiltered".into()),
            _ => None,
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
            Self::Brute(count) | Self::Independent(count) => rays(count, true),
            Self::Paper => Settings::PAPER,
            Self::Mirror | Self::Prefiltered(_) | Self::Harmonics => rays(1, false),
        }
    }

    /// Which of the laboratory's two techniques it uses.
    fn technique(self) -> usize {
        usize::from(!matches!(self, Self::Sheen | Self::SheenFull))
    }

    fn entry_point(self) -> &'static str {
        match self {
            Self::Mirror => "mirror_only",
            Self::Sheen | Self::SheenFull => "ours",
            Self::Brute(_) | Self::Paper => "published",
            Self::Independent(_) => "independent_rays",
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
    /// One that keeps its chain, and one that needs none.
    techniques: [DiffuseEnvmap; 2],
    baselines: Baselines,
    mipmaps: HashMap<wgpu::TextureFormat, Mipmaps>,
    pipelines: HashMap<(&'static str, bool), wgpu::ComputePipeline>,
    /// The shader, and the same with the lookups counted.
    modules: [wgpu::ShaderModule; 2],
    surfaces_layout: wgpu::BindGroupLayout,
    map: Option<wgpu::Texture>,
    revision: u64,
    greatest_roughness: f32,
}

/// The shader of all methods.
fn source() -> String {
    format!("{}{}", DiffuseEnvmap::library(), include_str!("lookup.wgsl"))
}

/// The same shader with the lookups of the map and the chain counted into the answers' alpha.
fn counted(source: &str) -> Result<String, Failure> {
    let replacements = [
        ("    return textureSampleLevel(chain,", "    lookups += 1.0;\n    return textureSampleLevel(chain,"),
        (
            "    let raw = textureSampleLevel(map,",
            "    lookups += 1.0;\n    let raw = textureSampleLevel(map,",
        ),
        (
            "q.normal_t.w, vec2u(0u)), 1.0);",
            "q.normal_t.w, vec2u(0u)), 1.0);\n    answers[id.x].w = lookups;",
        ),
        ("q.normal_t.w, pixel), 1.0);", "q.normal_t.w, pixel), 1.0);\n    answers[id.x].w = lookups;"),
    ];
    let mut counted = format!("var<private> lookups: f32;\n{source}");
    for (from, to) in replacements {
        if counted.matches(from).count() != 1 {
            return Err(format!("the library has no single `{from}` whose lookups could be counted").into());
        }
        counted = counted.replace(from, to);
    }
    Ok(counted)
}

impl Lab {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, Failure> {
        let desc = Desc { target_format: wgpu::TextureFormat::Rgba16Float };
        let technique = || DiffuseEnvmap::new(gpu, &desc);
        let device = gpu.device();
        let module = |label, source: String| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        };
        let surfaces_layout =
            bindings::layout(device, "surfaces", &[bindings::storage(true), bindings::storage(false)]);
        Ok(Self {
            gpu: gpu.clone(),
            techniques: [technique()?, technique()?],
            baselines: Baselines::new(gpu)?,
            mipmaps: HashMap::new(),
            pipelines: HashMap::new(),
            modules: [module("lookup", source()), module("counted lookup", counted(&source())?)],
            surfaces_layout,
            map: None,
            revision: 0,
            greatest_roughness: 1.0,
        })
    }

    /// Uploads a map: half floats where they hold it, else full ones.
    pub(super) fn set_map(&mut self, map: &TestMap) -> Result<(), Failure> {
        let (width, height) = (map.environment.width, map.environment.height);
        let rgba: Vec<_> = map.environment.pixels.iter().map(|&[r, g, b]| [r, g, b, 1.0_f32]).collect();
        let format =
            if map.fits_half() { wgpu::TextureFormat::Rgba16Float } else { wgpu::TextureFormat::Rgba32Float };
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

    /// The largest roughness that will be asked for.
    pub(super) fn set_greatest_roughness(&mut self, roughness: f32) {
        self.greatest_roughness = roughness;
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
        let work = self.prepare(&mut encoder, &map, way)?;
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(work)
    }

    fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        map: &wgpu::Texture,
        way: Way,
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
            max_roughness: self.greatest_roughness,
        };
        Ok(self.techniques[way.technique()].prepare(&self.gpu, encoder, &way.settings(), &frame)?)
    }

    /// Bytes that a method holds for the map, besides the map itself.
    pub(super) fn memory_bytes(&self, way: Way) -> u64 {
        let map = self.map.as_ref().map_or(0, |map| {
            let texel = map.format().block_copy_size(None).unwrap_or(0);
            u64::from(map.width()) * u64::from(map.height()) * u64::from(texel)
        });
        match way {
            Way::Sheen | Way::SheenFull => self.techniques[0].memory_bytes(),
            Way::Prefiltered(_) => Baselines::prefiltered_bytes(map),
            Way::Harmonics => 9 * 16,
            Way::Mirror | Way::Brute(_) | Way::Independent(_) | Way::Paper => 0,
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

    /// Brings a method's parameters up to date, lights all surfaces and waits: one frame of a
    /// program that does nothing else. What the method precomputes has to stand. Returns what was
    /// prepared.
    pub(super) fn frame(&mut self, way: Way, surfaces: &Surfaces) -> Result<Work, Failure> {
        self.run(way, surfaces, false)
    }

    fn run(&mut self, way: Way, surfaces: &Surfaces, is_counted: bool) -> Result<Work, Failure> {
        let Some(map) = self.map.clone() else { return Err("there is no map".into()) };
        let key = (way.entry_point(), is_counted);
        if !self.pipelines.contains_key(&key) {
            self.pipelines.insert(key, self.pipeline(key.0, is_counted)?);
        }
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = self.prepare(&mut encoder, &map, way)?;
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipelines[&key]);
            pass.set_bind_group(0, self.techniques[way.technique()].bind_group(), &[]);
            pass.set_bind_group(1, &surfaces.group, &[]);
            pass.set_bind_group(2, self.baselines.group(), &[]);
            pass.dispatch_workgroups(surfaces.count.div_ceil(64), 1, 1);
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(work)
    }

    /// Lookups of the map and the chain that a method takes for each query.
    pub(super) fn lookups(&mut self, way: Way, queries: &[Query]) -> Result<Vec<f32>, Failure> {
        self.build(way)?;
        let surfaces = self.surfaces(queries);
        self.run(way, &surfaces, true)?;
        let bytes = readback::read_buffer(&self.gpu, &surfaces.answers)?;
        Ok(bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().map(|answer| answer[3]).collect())
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

    fn pipeline(&self, entry_point: &str, is_counted: bool) -> Result<wgpu::ComputePipeline, Failure> {
        let module = &self.modules[usize::from(is_counted)];
        let layouts =
            [self.techniques[0].bind_group_layout(), &self.surfaces_layout, self.baselines.layout()]
                .map(Some);
        let pipeline = self.gpu.checked(entry_point, |device| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &layouts,
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
        })?;
        Ok(pipeline)
    }
}
