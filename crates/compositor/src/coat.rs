//! Clear coats: a second specular layer over the surface buffer, for the scenes that have one.
//!
//! The coated instances are drawn again where they are visible, into a buffer of the coat's own
//! normal, roughness and strength. One full-screen pass then multiplies the HDR image by what the
//! coat lets through and adds the lights' highlights; a second one adds the environment. The
//! share that a coat keeps from its base is taken for the viewing direction alone.

use crate::{
    Error, SceneGpu, View,
    geometry::{depth_state, primitive, vertex_buffers},
    passes::{
        self, DEPTH, FILTERED, Fullscreen, LOADED, SAMPLER, STORAGE, UNIFORM, additive, bind_group,
        bind_group_layout, cleared, loaded, uniform_buffer,
    },
    surface::{HDR_FORMAT, SurfaceBuffer, Target, target},
    uniforms::{LightUniform, ViewUniform},
};
use diffuse_envmap::DiffuseEnvmap;
use gpu_context::{Gpu, Skip, Work};
use std::collections::HashMap;

/// No visible material has a clear coat.
pub const NO_COATS: Skip = Skip::new("no material has a clear coat");

/// Unit normal of the coat in world space, and its perceptual roughness.
const NORMAL_ROUGHNESS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Strength of the coat, 0 (none) .. 1.
const STRENGTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// The passes; made when a frame first has a coat.
pub(crate) struct Coats {
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    view_layout: wgpu::BindGroupLayout,
    lights_layout: wgpu::BindGroupLayout,
    buffer_layout: wgpu::BindGroupLayout,
    /// Stands in where a scene has no lights, since a binding cannot be empty.
    no_lights: wgpu::Buffer,
    surface_module: wgpu::ShaderModule,
    surface_pipelines: HashMap<(bool, bool), wgpu::RenderPipeline>,
    /// Without and with shadows, each made on first use.
    layers: [Option<wgpu::RenderPipeline>; 2],
    environment: Option<wgpu::RenderPipeline>,
    buffer: Option<CoatBuffer>,
}

/// What lights the coats of a frame.
pub(crate) struct Incident<'a> {
    /// The scene's lights, if any.
    pub(crate) lights: Option<&'a wgpu::Buffer>,
    /// diffuse-envmap as it was prepared for this frame, if there is an environment.
    pub(crate) environment: Option<&'a DiffuseEnvmap>,
    /// What of the first lights arrives, where the frame has shadows.
    pub(crate) visibility: Option<&'a Target>,
}

/// The coats of one picture size.
struct CoatBuffer {
    size: [u32; 2],
    normal_roughness: Target,
    strength: Target,
}

impl Coats {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let device = gpu.device();
        let (fragment, both) = (wgpu::ShaderStages::FRAGMENT, wgpu::ShaderStages::VERTEX_FRAGMENT);
        let view = uniform_buffer(device, "view", size_of::<ViewUniform>());
        let view_layout = bind_group_layout(device, "view", both, &[UNIFORM]);
        let view_group = bind_group(device, "view", &view_layout, &[view.as_entire_binding()]);
        let lights_layout = bind_group_layout(device, "lights", fragment, &[UNIFORM, STORAGE, LOADED]);
        let buffer_layout = bind_group_layout(device, "coats", fragment, &[DEPTH, LOADED, LOADED]);
        let no_lights = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("no lights"),
            size: size_of::<LightUniform>() as u64,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let surface_module = gpu.checked("coat surface pass", |device| {
            passes::shader(device, "coat surface", &shaders::COMPOSITOR_COAT_SURFACE)
        })?;
        Ok(Self {
            view,
            view_group,
            view_layout,
            lights_layout,
            buffer_layout,
            no_lights,
            surface_module,
            surface_pipelines: HashMap::new(),
            layers: [None, None],
            environment: None,
            buffer: None,
        })
    }

    /// Lays the coats over the HDR image.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        view: &View,
        surface: &SurfaceBuffer,
        incident: &Incident<'_>,
    ) -> Result<Work, Error> {
        gpu.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view)));
        let buffer = match self.buffer.take().filter(|buffer| buffer.size == surface.size) {
            Some(buffer) => buffer,
            None => CoatBuffer::new(gpu, surface.size)?,
        };
        self.draw_surfaces(gpu, encoder, scene, surface, &buffer)?;
        let views = [&surface.depth, &buffer.normal_roughness, &buffer.strength]
            .map(|target| wgpu::BindingResource::TextureView(&target.view));
        let coats = bind_group(gpu.device(), "coats", &self.buffer_layout, &views);

        let lights = incident.lights.unwrap_or(&self.no_lights);
        // Any texture will do where there are no shadows: it is not read.
        let visibility = incident.visibility.unwrap_or(&surface.albedo);
        let resources = [
            self.view.as_entire_binding(),
            lights.as_entire_binding(),
            wgpu::BindingResource::TextureView(&visibility.view),
        ];
        let lights = bind_group(gpu.device(), "lights", &self.lights_layout, &resources);
        let variant = usize::from(incident.visibility.is_some());
        let layer = match self.layers[variant].take() {
            Some(layer) => layer,
            None => self.layer_pipeline(gpu, incident.visibility.is_some())?,
        };
        add(encoder, "coat layer", surface, self.layers[variant].insert(layer), &[&lights, &coats]);
        let mut passes = 2;
        let prepared = incident.environment.and_then(|technique| Some((technique, technique.bind_group()?)));
        if let Some((technique, group)) = prepared {
            if self.environment.is_none() {
                self.environment = Some(self.environment_pipeline(gpu, technique)?);
            }
            if let Some(pipeline) = &self.environment {
                add(encoder, "coat environment", surface, pipeline, &[group, &self.view_group, &coats]);
                passes += 1;
            }
        }
        self.buffer = Some(buffer);
        Ok(Work::done(passes))
    }

    fn draw_surfaces(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        surface: &SurfaceBuffer,
        buffer: &CoatBuffer,
    ) -> Result<(), Error> {
        let Some(instances) = &scene.instances else { return Ok(()) };
        let coated = || scene.draws.iter().filter(|draw| scene.coats.contains_key(&draw.material));
        for draw in coated() {
            let key = draw.variant.faces();
            if !self.surface_pipelines.contains_key(&key) {
                self.surface_pipelines.insert(key, self.surface_pipeline(gpu, key)?);
            }
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("coat surface"),
            color_attachments: &[
                Some(cleared(&buffer.normal_roughness.view)),
                Some(cleared(&buffer.strength.view)),
            ],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &surface.depth.view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.view_group, &[]);
        pass.set_vertex_buffer(1, instances.slice(..));
        for draw in coated() {
            let resources = (
                self.surface_pipelines.get(&draw.variant.faces()),
                scene.coats.get(&draw.material),
                scene.meshes.get(&draw.mesh),
            );
            let (Some(pipeline), Some(coat), Some(mesh)) = resources else { continue };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, coat, &[]);
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, draw.instances.clone());
        }
        Ok(())
    }

    fn surface_pipeline(
        &self,
        gpu: &Gpu,
        (double_sided, mirrored): (bool, bool),
    ) -> Result<wgpu::RenderPipeline, Error> {
        Ok(gpu.checked("coat surface pass", |device| {
            let groups = [&self.view_layout, &coat_layout(device)];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("coat surface"),
                layout: Some(&passes::layout(device, "coat surface", &groups)),
                vertex: wgpu::VertexState {
                    module: &self.surface_module,
                    entry_point: Some("geometry_vertex"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &vertex_buffers(),
                },
                primitive: primitive(double_sided, mirrored),
                depth_stencil: Some(depth_state(false, wgpu::CompareFunction::Equal)),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.surface_module,
                    entry_point: Some("coat_surface_fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(NORMAL_ROUGHNESS_FORMAT.into()), Some(STRENGTH_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        })?)
    }

    fn layer_pipeline(&self, gpu: &Gpu, is_shadowed: bool) -> Result<wgpu::RenderPipeline, Error> {
        Fullscreen {
            label: "coat layer",
            module: &shaders::COMPOSITOR_COAT_LAYER,
            fragment: "coat_layer_fragment",
            constants: &[("is_shadowed", f64::from(u8::from(is_shadowed)))],
            layouts: &[&self.lights_layout, &self.buffer_layout],
            target: over_the_base(),
            depth_stencil: None,
        }
        .pipeline(gpu)
    }

    fn environment_pipeline(
        &self,
        gpu: &Gpu,
        technique: &DiffuseEnvmap,
    ) -> Result<wgpu::RenderPipeline, Error> {
        Fullscreen {
            label: "coat environment",
            module: &shaders::COMPOSITOR_COAT_ENVIRONMENT,
            fragment: "coat_environment_fragment",
            constants: &[],
            layouts: &[technique.bind_group_layout(), &self.view_layout, &self.buffer_layout],
            target: additive(HDR_FORMAT),
            depth_stencil: None,
        }
        .pipeline(gpu)
    }
}

impl CoatBuffer {
    fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, Error> {
        Ok(gpu.checked("the coat buffer", |device| Self {
            size,
            normal_roughness: target(device, "coat normal and roughness", size, NORMAL_ROUGHNESS_FORMAT),
            strength: target(device, "coat strength", size, STRENGTH_FORMAT),
        })?)
    }
}

/// A coat's uniform and its three textures, each with a sampler.
pub(crate) fn coat_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let mut bindings = vec![UNIFORM];
    bindings.extend([FILTERED, SAMPLER].repeat(3));
    bind_group_layout(device, "coat", wgpu::ShaderStages::FRAGMENT, &bindings)
}

/// Colour = coat + alpha * base; coverage stays.
fn over_the_base() -> wgpu::ColorTargetState {
    let color = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::SrcAlpha,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::ColorTargetState {
        format: HDR_FORMAT,
        blend: Some(wgpu::BlendState { color, alpha: wgpu::BlendComponent::REPLACE }),
        write_mask: wgpu::ColorWrites::COLOR,
    }
}

/// One full-screen draw onto the HDR image.
fn add(
    encoder: &mut wgpu::CommandEncoder,
    label: &str,
    surface: &SurfaceBuffer,
    pipeline: &wgpu::RenderPipeline,
    groups: &[&wgpu::BindGroup],
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(loaded(&surface.hdr.view))],
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, *group, &[]);
    }
    pass.draw(0..3, 0..1);
}
