//! diffuse-envmap: environment lighting from mirror to diffuse by one roughness.
//!
//! After Hirokawa and Ikedo, *A Diffused Environment Mapping*. A surface of roughness t sees the
//! environment through a circular lobe: its axis goes from the mirror direction (t = 0) to the
//! normal (t = 1) (eqs. 1 and 3), and its directions are a cosine-weighted hemisphere narrowed
//! by t (eqs. 2 and 4). At t = 0 that is a mirror, at t = 1 an ideal diffuse surface.
//!
//! - [`Method::Paper`] casts rays into the unfiltered map, as published: no precomputation,
//!   noise or ghost images that fall with the square root of the ray count.
//! - [`Method::Sheen`] reads at most seven filtered taps (nineteen of the map itself for lobes of
//!   about a texel). When the map changes, compute passes take the bright sources out of it, build
//!   one chain of ever wider Gaussians from the rest, and project that on spherical harmonics. A
//!   lobe is six taps fitted to it (or one, where the chain's second moment shows little
//!   contrast), plus what they lack in the first two harmonic bands, plus the sources in closed
//!   form. There is no noise.
//!
//! What is approximated: occlusion (the environment is at infinity or on a box); the lobe's shape
//! between chain levels (1 to 2 % on natural images); within 4.5 degrees of grazing, the part of a
//! tap that dips below the horizon. Sources are at most 64 parts of 3 degrees: what is left of
//! larger lights leaks a little into dark lobes that just miss them, most around t = 0.1.
//! Memory: 64 bytes times the square of half the map's height, at most 64 MiB, and a copy of the
//! map in half floats. It needs compute shaders and storage textures.
//!
//! ```no_run
//! # use diffuse_envmap::*;
//! # fn f(gpu: &gpu_context::Gpu, encoder: &mut wgpu::CommandEncoder, frame: Frame<'_>) -> Result<(), Error> {
//! let mut lighting = DiffuseEnvmap::new(gpu, &Desc { target_format: wgpu::TextureFormat::Rgba16Float })?;
//! let work = lighting.prepare(gpu, encoder, &Settings::SHEEN, &frame)?;
//! // Then inside a render pass whose target is the HDR image: lighting.render(&mut pass);
//! # Ok(()) }
//! ```
//!
//! A host that shades materials itself puts [`DiffuseEnvmap::library`] before its own shader,
//! declares the six bindings of [`DiffuseEnvmap::bind_group_layout`] and calls
//! `diffuse_envmap_radiance`; `examples/minimal.rs` does.

mod bindings;
mod error;
mod frame;
pub mod model;
mod prepared;
mod settings;
mod tap_table;
pub mod taps;
mod uniforms;

pub use error::Error;
pub use frame::{Camera, Environment, Frame, Surface};
pub use gpu_context::{Gpu, Skip, Work, wgpu};
pub use settings::{Base, Distribution, Horizon, Method, ParallaxBox, Settings};

use bindings::{bind_group, bind_group_layout, shader, texture_binding, unfilterable, uniform};
use prepared::{Builder, Prepared};
use uniforms::{CameraUniform, Parameters};

/// The frame has no environment: nothing to light with.
pub const NO_ENVIRONMENT: Skip = Skip::new("there is no environment");
/// The chain of this environment stands from an earlier frame.
pub const CHAIN_STANDS: Skip = Skip::new("the environment's chain stands");
/// The method, or mirrors alone, read the unfiltered map: no chain is built.
pub const NO_CHAIN_NEEDED: Skip = Skip::new("no lobe reads the chain");

/// What decides the pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Desc {
    /// Format of the HDR image that the full-screen pass adds to; it must be blendable.
    pub target_format: wgpu::TextureFormat,
}

/// The technique: pipelines, and what was built from the current environment.
#[derive(Debug)]
pub struct DiffuseEnvmap {
    desc: Desc,
    sampler: wgpu::Sampler,
    parameters: wgpu::Buffer,
    camera: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    surface_layout: wgpu::BindGroupLayout,
    builder: Option<Builder>,
    /// One pipeline for each method, made on first use, and the method of the last `prepare`.
    lighting: [Option<wgpu::RenderPipeline>; 2],
    method: usize,
    built: Option<Built>,
    group: Option<wgpu::BindGroup>,
    surface_group: Option<wgpu::BindGroup>,
}

/// What was built, and from what.
#[derive(Debug)]
struct Built {
    texture: wgpu::Texture,
    revision: u64,
    prepared: Prepared,
}

impl DiffuseEnvmap {
    /// Makes the small fixed resources; pipelines follow on first use.
    ///
    /// [`Error::Target`] where the target cannot be blended.
    pub fn new(gpu: &Gpu, desc: &Desc) -> Result<Self, Error> {
        let features = desc.target_format.guaranteed_format_features(gpu.device().features());
        if !features.flags.contains(wgpu::TextureFormatFeatureFlags::BLENDABLE) {
            return Err(Error::Target { format: desc.target_format });
        }
        gpu.checked("diffuse-envmap", |device| Self::with_device(device, *desc)).map_err(Error::from)
    }

    fn with_device(device: &wgpu::Device, desc: Desc) -> Self {
        use wgpu::TextureViewDimension as Dimension;
        let stages = wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let uniform_buffer = |size: usize| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("diffuse-envmap uniforms"),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self {
            desc,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("diffuse-envmap"),
                address_mode_u: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
            parameters: uniform_buffer(size_of::<Parameters>()),
            camera: uniform_buffer(size_of::<CameraUniform>()),
            layout: bind_group_layout(
                device,
                "diffuse-envmap",
                stages,
                &[
                    uniform(),
                    texture_binding(Dimension::D2),
                    texture_binding(Dimension::D2),
                    texture_binding(Dimension::Cube),
                    unfilterable(),
                    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                ],
            ),
            surface_layout: bind_group_layout(
                device,
                "diffuse-envmap surface",
                wgpu::ShaderStages::FRAGMENT,
                &[uniform(), unfilterable(), unfilterable(), unfilterable(), unfilterable(), unfilterable()],
            ),
            builder: None,
            lighting: [None, None],
            method: 0,
            built: None,
            group: None,
            surface_group: None,
        }
    }

    /// Brings what the environment needs up to date and records it, then makes the frame's bind
    /// groups. The uniforms are written through the queue: prepare once per submission.
    ///
    /// `Work::passes` counts compute passes; `Work::skipped` says why none ran.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        frame: &Frame<'_>,
    ) -> Result<Work, Error> {
        self.group = None;
        self.surface_group = None;
        let Some(environment) = &frame.environment else {
            self.built = None;
            return Ok(Work::skipped(NO_ENVIRONMENT));
        };
        check_environment(gpu, environment)?;
        let work = self.build(gpu, encoder, settings, frame, environment)?;
        self.bind_environment(gpu, settings, frame, environment)?;
        if let Some(surface) = &frame.surface {
            check_surface(surface)?;
            self.method = usize::from(settings.method == Method::Sheen);
            self.bind_surface(gpu, &frame.camera, surface)?;
        }
        Ok(work)
    }

    /// Adds the lit surface buffer to the pass's target with one draw. The pass has one target of
    /// `Desc::target_format` and no depth. Draws nothing where `prepare` had no environment or no
    /// surface.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let (Some(pipeline), Some(group), Some(surface)) =
            (&self.lighting[self.method], &self.group, &self.surface_group)
        {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.set_bind_group(1, surface, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// The WGSL functions for a host's own shader, dependencies included.
    pub fn library() -> String {
        shaders::DIFFUSE_ENVMAP_LIBRARY.source()
    }

    /// The layout of [`Self::bind_group`], visible to fragment and compute shaders:
    /// 0 `var<uniform>: DiffuseEnvmapParameters`, 1 `texture_2d<f32>` the map, 2
    /// `texture_2d<f32>` the map without its compact sources, 3 `texture_cube<f32>` the chain,
    /// 4 `texture_2d<f32>` the tables, 5 `sampler`.
    pub fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bindings of the last `prepare`; `None` where it had no environment.
    pub fn bind_group(&self) -> Option<&wgpu::BindGroup> {
        self.group.as_ref()
    }

    /// Bytes of GPU memory held for the current environment.
    pub fn memory_bytes(&self) -> u64 {
        self.built.as_ref().map_or(0, |built| built.prepared.memory_bytes)
    }

    fn build(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        frame: &Frame<'_>,
        environment: &Environment<'_>,
    ) -> Result<Work, Error> {
        let texture = environment.view.texture();
        if !needs_chain(settings, frame.max_roughness, texture.height()) {
            self.built = None;
            return Ok(Work::skipped(NO_CHAIN_NEEDED));
        }
        if let Some(built) = &self.built
            && built.texture == *texture
            && built.revision == environment.revision
        {
            return Ok(Work::skipped(CHAIN_STANDS));
        }
        // The old chain goes before the new one takes memory.
        self.built = None;
        if self.builder.is_none() {
            self.builder = Some(Builder::new(gpu)?);
        }
        let Some(builder) = &self.builder else { return Ok(Work::default()) };
        let prepared = builder.build(gpu, encoder, environment.view, &self.sampler)?;
        let work = Work::done(prepared.passes);
        self.built = Some(Built { texture: texture.clone(), revision: environment.revision, prepared });
        Ok(work)
    }

    fn bind_environment(
        &mut self,
        gpu: &Gpu,
        settings: &Settings,
        frame: &Frame<'_>,
        environment: &Environment<'_>,
    ) -> Result<(), Error> {
        let texture = environment.view.texture();
        let map_size = [texture.width(), texture.height()];
        let prepared = self.built.as_ref().map(|built| &built.prepared);
        let face_size = prepared.map(|prepared| prepared.face_size);
        let parameters = Parameters::new(settings, frame, map_size, face_size);
        gpu.queue().write_buffer(&self.parameters, 0, bytemuck::bytes_of(&parameters));
        let group = gpu.checked("diffuse-envmap's bind group", |device| {
            let black =
                prepared.is_none().then(|| prepared::black_cube(device).create_view(&prepared::cube_view()));
            let chain = prepared.map(|prepared| &prepared.chain).or(black.as_ref());
            let residual = prepared.map_or(environment.view, |prepared| &prepared.residual);
            let tables = prepared.map_or(environment.view, |prepared| &prepared.tables);
            Some(bind_group(
                device,
                &self.layout,
                [
                    self.parameters.as_entire_binding(),
                    wgpu::BindingResource::TextureView(environment.view),
                    wgpu::BindingResource::TextureView(residual),
                    wgpu::BindingResource::TextureView(chain?),
                    wgpu::BindingResource::TextureView(tables),
                    wgpu::BindingResource::Sampler(&self.sampler),
                ],
            ))
        })?;
        self.group = group;
        Ok(())
    }

    fn bind_surface(&mut self, gpu: &Gpu, camera: &Camera, surface: &Surface<'_>) -> Result<(), Error> {
        if self.lighting[self.method].is_none() {
            let pipeline =
                gpu.checked("diffuse-envmap's lighting pipeline", |device| self.pipeline(device))?;
            self.lighting[self.method] = Some(pipeline);
        }
        gpu.queue().write_buffer(&self.camera, 0, bytemuck::bytes_of(&CameraUniform::new(camera)));
        let group = gpu.checked("diffuse-envmap's surface", |device| {
            bind_group(
                device,
                &self.surface_layout,
                [
                    self.camera.as_entire_binding(),
                    wgpu::BindingResource::TextureView(surface.depth),
                    wgpu::BindingResource::TextureView(surface.normal_roughness),
                    wgpu::BindingResource::TextureView(surface.specular),
                    wgpu::BindingResource::TextureView(surface.albedo),
                    wgpu::BindingResource::TextureView(
                        surface.diffuse_normal.unwrap_or(surface.normal_roughness),
                    ),
                ],
            )
        })?;
        self.surface_group = Some(group);
        Ok(())
    }

    fn pipeline(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let module = shader(device, &shaders::DIFFUSE_ENVMAP_LIGHTING);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("diffuse-envmap lighting"),
            bind_group_layouts: &[Some(&self.layout), Some(&self.surface_layout)],
            immediate_size: 0,
        });
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("diffuse-envmap lighting"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("fullscreen"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("lighting"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[("method", self.method as f64)],
                    ..Default::default()
                },
                targets: &[Some(wgpu::ColorTargetState {
                    format: self.desc.target_format,
                    blend: Some(wgpu::BlendState { color: add, alpha: add }),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Whether any lobe of the frame is wider than the mirror's half texel.
fn needs_chain(settings: &Settings, max_roughness: f32, map_rows: u32) -> bool {
    let greatest = max_roughness + settings.roughness_offset;
    // Written so that a roughness that is not a number needs the chain, as it counts as 1.
    let mirror = 0.8566 * greatest < 0.5 * std::f32::consts::PI / map_rows as f32;
    settings.method == Method::Sheen && !mirror
}

fn check_environment(gpu: &Gpu, environment: &Environment<'_>) -> Result<(), Error> {
    let format = environment.view.texture().format();
    match format.sample_type(None, Some(gpu.device().features())) {
        Some(wgpu::TextureSampleType::Float { filterable: true }) => Ok(()),
        _ => Err(Error::Environment { format }),
    }
}

fn check_surface(surface: &Surface<'_>) -> Result<(), Error> {
    let size = |view: &wgpu::TextureView| [view.texture().width(), view.texture().height()];
    let expected = size(surface.depth);
    let parts = [
        ("normal_roughness", surface.normal_roughness),
        ("specular", surface.specular),
        ("albedo", surface.albedo),
        ("diffuse_normal", surface.diffuse_normal.unwrap_or(surface.normal_roughness)),
    ];
    for (part, view) in parts {
        if size(view) != expected {
            return Err(Error::Surface { part, found: size(view), expected });
        }
    }
    Ok(())
}
