//! Shadow map: shadows that surfaces cast on each other.
//!
//! The scene's depth from each light is drawn into one atlas, with the number of the instance that is
//! nearest. Surfaces with a height map are displaced by it there, on a finer mesh, so that their
//! shadows on others have bumpy edges. Then every visible surface is drawn again where the depth is
//! its own and compares its distance with the map's; one with a height map does so from where its
//! relief is, and leaves those casters of its own instance out that the horizon map knows.
//!
//! What casts is what a ray from the receiver would meet: of single-sided materials the side that
//! looks away from the light. The lit side of a closed surface is not in the map and cannot shadow
//! itself.

mod light_view;

use crate::{
    Error, SceneGpu, ShadowMapSettings, View,
    geometry::{self, Variant, depth_state, primitive, relief_vertex_buffers, vertex_buffers},
    passes::{self, DEPTH, UNIFORM, bind_group, bind_group_layout, uniform_buffer},
    relief,
    surface::{DEPTH_FORMAT, SurfaceBuffer, Target, target},
    uniforms::ViewUniform,
    vertices::DisplacedVertex,
    visibility::{MAX_SHADOWED_LIGHTS, MORE_LIGHTS, VISIBILITY_FORMAT, Visibility},
};
use bytemuck::{Pod, Zeroable};
use gpu_context::{Gpu, Skip, Work};
use light_view::ShadowLight;
use std::collections::HashMap;

/// The settings leave shadow maps out.
pub const SHADOW_MAP_OFF: Skip = Skip::new("the shadow map is turned off");

/// None of the first four lights casts shadows: they are points, or spots wider than a map can hold.
pub const NO_CASTING_LIGHTS: Skip = Skip::new("neither a point light nor a very wide spot casts shadows");

/// Neither the scene nor its lights have changed: the maps of an earlier frame stand.
pub const SHADOW_MAP_STANDS: Skip = Skip::new("the shadow map stands");

/// The nearest instance to the light.
const ID_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R16Uint;

/// How far a receiver is lifted off its plane, in texels of the map: a single-sided one is no
/// caster where it is lit, and needs only what rounding takes.
const LIFT_TEXELS: [f64; 2] = [0.1, 0.75];

/// `Shadows` of compositor/shadow-map.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct ShadowsUniform {
    lights: [ShadowLight; MAX_SHADOWED_LIGHTS],
    size: f32,
    own_radius_texels: f32,
    unused: [f32; 2],
}

/// The pass; made when a frame first has shadows.
pub(crate) struct ShadowMap {
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    view_layout: wgpu::BindGroupLayout,
    light_views: [(wgpu::Buffer, wgpu::BindGroup); MAX_SHADOWED_LIGHTS],
    shadows: wgpu::Buffer,
    shadows_layout: wgpu::BindGroupLayout,
    casters_module: wgpu::ShaderModule,
    receivers_module: wgpu::ShaderModule,
    casters: HashMap<Variant, wgpu::RenderPipeline>,
    receivers: HashMap<Variant, wgpu::RenderPipeline>,
    atlas: Option<Atlas>,
}

/// The maps of all lights.
struct Atlas {
    size: u32,
    columns: u32,
    rows: u32,
    depth: Target,
    id: Target,
    /// Of what was drawn into it.
    revision: Option<u64>,
}

/// What a frame's shadows depend on besides the scene.
pub(crate) struct Request<'a> {
    pub(crate) settings: ShadowMapSettings,
    pub(crate) view: &'a View,
    /// Texels of a height map within which the horizon map knows the bumps; 0 where there is none.
    pub(crate) own_radius_texels: f32,
}

impl ShadowMap {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        Ok(gpu.checked("shadow map", |device| {
            let view_layout = bind_group_layout(device, "view", stages, &[UNIFORM]);
            let view = || {
                let buffer = uniform_buffer(device, "view", size_of::<ViewUniform>());
                let group = bind_group(device, "view", &view_layout, &[buffer.as_entire_binding()]);
                (buffer, group)
            };
            let (light_views, (view, view_group)) = (std::array::from_fn(|_| view()), view());
            let bindings = [UNIFORM, DEPTH, IDS];
            let fragment = wgpu::ShaderStages::FRAGMENT;
            Self {
                view,
                view_group,
                light_views,
                shadows: uniform_buffer(device, "shadows", size_of::<ShadowsUniform>()),
                shadows_layout: bind_group_layout(device, "shadows", fragment, &bindings),
                view_layout,
                casters_module: passes::shader(device, "shadow casters", &shaders::COMPOSITOR_SHADOW_CASTERS),
                receivers_module: passes::shader(device, "shadow map", &shaders::COMPOSITOR_SHADOW_MAP),
                casters: HashMap::new(),
                receivers: HashMap::new(),
                atlas: None,
            }
        })?)
    }

    /// Draws what has changed of the maps, and what they say about this view into the visibility
    /// buffer.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        request: &Request<'_>,
        surface: &SurfaceBuffer,
        visibility: &mut Visibility,
    ) -> Result<Work, Error> {
        let mut lights = lights(scene);
        let count = lights.iter().flatten().count() as u32;
        if count == 0 {
            self.atlas = None;
            return Ok(Work::skipped(NO_CASTING_LIGHTS));
        }
        let mut atlas = self.atlas(gpu, request.settings, count)?;
        for (index, light) in lights.iter_mut().flatten().enumerate() {
            let index = index as u32;
            light.corner = [index % 2 * atlas.size, index / 2 * atlas.size];
        }
        let mut work = Work::done(1);
        if atlas.revision == Some(scene.revision) {
            work.skipped = Some(SHADOW_MAP_STANDS);
        } else {
            self.draw_casters(gpu, encoder, scene, &lights, &atlas)?;
            atlas.revision = Some(scene.revision);
            work.passes += 1;
        }
        let uniform = ShadowsUniform {
            lights: lights.map(|light| light.unwrap_or(ShadowLight::none())),
            size: atlas.size as f32,
            own_radius_texels: request.own_radius_texels,
            unused: [0.0; 2],
        };
        gpu.queue().write_buffer(&self.shadows, 0, bytemuck::bytes_of(&uniform));
        gpu.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(request.view)));
        self.draw_receivers(gpu, encoder, scene, &atlas, surface, visibility)?;
        self.atlas = Some(atlas);
        if scene.lit_by.len() > MAX_SHADOWED_LIGHTS {
            work.skipped = Some(MORE_LIGHTS);
        }
        Ok(work)
    }

    fn atlas(&mut self, gpu: &Gpu, settings: ShadowMapSettings, count: u32) -> Result<Atlas, Error> {
        let largest = (gpu.device().limits().max_texture_dimension_2d / 2).min(4096);
        let size = settings.size.clamp(16, largest);
        let (columns, rows) = (count.min(2), count.div_ceil(2));
        let fits = |atlas: &Atlas| (atlas.size, atlas.columns, atlas.rows) == (size, columns, rows);
        if let Some(atlas) = self.atlas.take().filter(fits) {
            return Ok(atlas);
        }
        let sides = [columns * size, rows * size];
        Ok(gpu.checked("the shadow map", |device| Atlas {
            size,
            columns,
            rows,
            depth: target(device, "shadow map", sides, DEPTH_FORMAT),
            id: target(device, "nearest instances", sides, ID_FORMAT),
            revision: None,
        })?)
    }

    fn draw_casters(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        lights: &[Option<ShadowLight>; MAX_SHADOWED_LIGHTS],
        atlas: &Atlas,
    ) -> Result<(), Error> {
        let Some(instances) = &scene.instances else { return Ok(()) };
        for draw in &scene.draws {
            if !self.casters.contains_key(&draw.variant) {
                self.casters.insert(draw.variant, self.caster_pipeline(gpu, draw.variant)?);
            }
        }
        let ops =
            |clear| Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow casters"),
            color_attachments: &[Some(passes::cleared(&atlas.id.view))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &atlas.depth.view,
                depth_ops: ops(0.0),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_vertex_buffer(1, instances.slice(..));
        for (light, (buffer, group)) in lights.iter().flatten().zip(&self.light_views) {
            gpu.queue().write_buffer(buffer, 0, bytemuck::bytes_of(&ViewUniform::new(&light.view())));
            let ([x, y], size) = (light.corner, atlas.size);
            pass.set_viewport(x as f32, y as f32, size as f32, size as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, size, size);
            pass.set_bind_group(0, group, &[]);
            for draw in &scene.draws {
                let relief = scene.reliefs.get(&(draw.material, draw.mesh));
                let mesh = match relief {
                    Some(relief) => Some(&relief.casters),
                    None => scene.meshes.get(&draw.mesh),
                };
                let resources = (self.casters.get(&draw.variant), scene.materials.get(&draw.material), mesh);
                let (Some(pipeline), Some(material), Some(mesh)) = resources else { continue };
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, material, &[]);
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.index_count, 0, draw.instances.clone());
            }
        }
        Ok(())
    }

    fn draw_receivers(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        atlas: &Atlas,
        surface: &SurfaceBuffer,
        visibility: &mut Visibility,
    ) -> Result<(), Error> {
        let Some(instances) = &scene.instances else { return Ok(()) };
        for draw in &scene.draws {
            if !self.receivers.contains_key(&draw.variant) {
                self.receivers.insert(draw.variant, self.receiver_pipeline(gpu, draw.variant)?);
            }
        }
        let resources = [
            self.shadows.as_entire_binding(),
            wgpu::BindingResource::TextureView(&atlas.depth.view),
            wgpu::BindingResource::TextureView(&atlas.id.view),
        ];
        let shadows = bind_group(gpu.device(), "shadows", &self.shadows_layout, &resources);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            color_attachments: &[Some(visibility.attachment(gpu, surface)?)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &surface.depth.view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.view_group, &[]);
        pass.set_bind_group(1, &shadows, &[]);
        pass.set_vertex_buffer(1, instances.slice(..));
        for draw in &scene.draws {
            let resources = (self.receivers.get(&draw.variant), scene.meshes.get(&draw.mesh));
            let (Some(pipeline), Some(mesh)) = resources else { continue };
            pass.set_pipeline(pipeline);
            if let Some(relief) = scene.reliefs.get(&(draw.material, draw.mesh)) {
                pass.set_bind_group(2, &relief.group, &[]);
                pass.set_vertex_buffer(2, relief.frames.slice(..));
            }
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, draw.instances.clone());
        }
        Ok(())
    }

    fn caster_pipeline(&self, gpu: &Gpu, variant: Variant) -> Result<wgpu::RenderPipeline, Error> {
        let (double_sided, mirrored) = variant.faces();
        let [vertices, instances] = vertex_buffers();
        let (vertex, vertices) = if variant.has_relief() {
            let displaced = wgpu::VertexBufferLayout {
                array_stride: size_of::<DisplacedVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &DisplacedVertex::ATTRIBUTES,
            };
            ("displaced_caster_vertex", Some(displaced))
        } else {
            ("caster_vertex", vertices)
        };
        let primitive = wgpu::PrimitiveState {
            cull_mode: (!double_sided).then_some(wgpu::Face::Front),
            ..primitive(double_sided, mirrored)
        };
        let constants = [("alpha_mode", variant.alpha_mode())];
        let options = wgpu::PipelineCompilationOptions {
            constants: &constants,
            ..wgpu::PipelineCompilationOptions::default()
        };
        Ok(gpu.checked("shadow casters", |device| {
            let groups = [&self.view_layout, &geometry::material_layout(device)];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shadow casters"),
                layout: Some(&passes::layout(device, "shadow casters", &groups)),
                vertex: wgpu::VertexState {
                    module: &self.casters_module,
                    entry_point: Some(vertex),
                    compilation_options: options.clone(),
                    buffers: &[vertices, instances],
                },
                primitive,
                depth_stencil: Some(depth_state(true, wgpu::CompareFunction::Greater)),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.casters_module,
                    entry_point: Some("caster_fragment"),
                    compilation_options: options,
                    targets: &[Some(ID_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        })?)
    }

    fn receiver_pipeline(&self, gpu: &Gpu, variant: Variant) -> Result<wgpu::RenderPipeline, Error> {
        let (double_sided, mirrored) = variant.faces();
        let constants = [("lift_texels", LIFT_TEXELS[usize::from(double_sided)])];
        let (vertex, fragment, used) = if variant.has_relief() {
            ("relief_vertex", "shadow_relief_fragment", 3)
        } else {
            ("geometry_vertex", "shadow_fragment", 2)
        };
        Ok(gpu.checked("shadow map", |device| {
            let relief = relief::layout(device);
            let groups = [&self.view_layout, &self.shadows_layout, &relief];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shadow map"),
                layout: Some(&passes::layout(device, "shadow map", &groups[..used])),
                vertex: wgpu::VertexState {
                    module: &self.receivers_module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &relief_vertex_buffers()[..used],
                },
                primitive: primitive(double_sided, mirrored),
                depth_stencil: Some(depth_state(false, wgpu::CompareFunction::Equal)),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.receivers_module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &constants,
                        ..wgpu::PipelineCompilationOptions::default()
                    },
                    targets: &[Some(multiplied())],
                }),
                multiview_mask: None,
                cache: None,
            })
        })?)
    }
}

/// How the first lights see the scene.
fn lights(scene: &SceneGpu) -> [Option<ShadowLight>; MAX_SHADOWED_LIGHTS] {
    std::array::from_fn(|index| ShadowLight::new(scene.lit_by.get(index)?, scene.bounds()?))
}

const IDS: wgpu::BindingType = wgpu::BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Uint,
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: false,
};

/// A light is visible past all that may stand before it.
fn multiplied() -> wgpu::ColorTargetState {
    let multiply = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::ColorTargetState {
        format: VISIBILITY_FORMAT,
        blend: Some(wgpu::BlendState { color: multiply, alpha: multiply }),
        write_mask: wgpu::ColorWrites::ALL,
    }
}
