//! The ready pass: visibility of up to four lights, for meshes that the host draws itself.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use gpu_context::Gpu;

use crate::{
    Error, HorizonShadow,
    bindings::{UNIFORM, bind_group, bind_group_layout, shader, technique_layout, uniform_buffer},
    uniforms::Variant,
};

/// Lights that one pass takes: a channel of the target each.
pub const MAX_LIGHTS: usize = 4;

/// What decides the pipelines of a [`VisibilityPass`].
#[derive(Clone, Debug)]
pub struct Desc<'a> {
    /// Format of the target: colour of four channels, such as `Rgba8Unorm`.
    pub target_format: wgpu::TextureFormat,
    /// The depth test, `None` where the pass has no depth. A pass after the host's own takes
    /// `CompareFunction::Equal` without writing: see [`VisibilityPass`] on positions.
    pub depth_stencil: Option<wgpu::DepthStencilState>,
    /// Where the vertex stage finds its locations; any number of buffers, in any order.
    ///
    /// Per vertex: 0 `position_local: vec3f`, 1 `normal_local: vec3f`, 2 `uv: vec2f`, 3 `along_u:
    /// vec3f`, 4 `along_v: vec3f`, 5 `second_form: vec3f` (the last three are a
    /// [`VertexFrame`](crate::VertexFrame)). Per instance: 6..=8 the rows of `world_from_local`
    /// (`vec4f`), 9..=11 the columns of the normals' matrix (`vec4f` whose w is not read), which is
    /// the inverse transpose of its linear part times any positive factor.
    pub vertex_buffers: &'a [wgpu::VertexBufferLayout<'a>],
    /// Topology, winding and culling. Winding decides which side is the back.
    pub primitive: wgpu::PrimitiveState,
}

/// The camera of the pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Clip space from the world, columns first.
    pub clip_from_world: [[f32; 4]; 4],
}

/// A light of the pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A light at infinity.
    Directional {
        /// Towards the light, any length but 0.
        direction_world: [f32; 3],
        /// Angle under which it is seen, radians, 0 for hard shadows; the sun's is 0.0093.
        angular_diameter_rad: f32,
    },
    /// A ball of light.
    Point {
        /// Its centre.
        position_world: [f32; 3],
        /// Its radius in metres, 0 for hard shadows.
        radius_m: f32,
    },
}

/// Draws meshes so that channel i of the target holds the visibility of light i: 0 in shadow, 1
/// lit, in between at the edge of soft shadows. Channels without a light hold 1.
///
/// The clip position is `@invariant` and computed as
/// `clip_from_world * vec4f(dot(row_0, p), dot(row_1, p), dot(row_2, p), 1.0)` with
/// `p = vec4f(position_local, 1.0)`; a host whose own pass does the same finds equal depths.
///
/// The back of a surface (by the winding) knows nothing of the relief, whose tables are those of
/// the front: it is lit where the light is behind the surface. Neither normal nor curvature is
/// turned to the viewer, since which way the surface bends, and so where its horizon lies, does
/// not depend on who looks.
#[derive(Debug)]
pub struct VisibilityPass {
    target_format: wgpu::TextureFormat,
    depth_stencil: Option<wgpu::DepthStencilState>,
    vertex_buffers: Vec<VertexBuffer>,
    primitive: wgpu::PrimitiveState,
    uniform: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    /// Made on first use.
    pipelines: HashMap<Variant, wgpu::RenderPipeline>,
}

/// A [`wgpu::VertexBufferLayout`] that borrows nothing.
#[derive(Debug)]
struct VertexBuffer {
    array_stride: wgpu::BufferAddress,
    step_mode: wgpu::VertexStepMode,
    attributes: Vec<wgpu::VertexAttribute>,
}

impl VisibilityPass {
    /// Makes the small fixed resources; pipelines follow on first use.
    ///
    /// [`Error::Target`] where the format is not a colour format of four channels that shaders
    /// write floats to.
    pub fn new(gpu: &Gpu, desc: &Desc<'_>) -> Result<Self, Error> {
        check_target(gpu, desc.target_format)?;
        let uniform = uniform_buffer(gpu, "horizon-shadow lights", size_of::<PassUniform>())?;
        let (layout, group) = gpu.checked("horizon-shadow's visibility pass", |device| {
            let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
            let layout = bind_group_layout(device, "horizon-shadow lights", stages, &[UNIFORM]);
            let entries = [uniform.as_entire_binding()];
            let group = bind_group(device, "horizon-shadow lights", &layout, entries);
            (layout, group)
        })?;
        let vertex_buffers = desc.vertex_buffers.iter().map(|buffer| VertexBuffer {
            array_stride: buffer.array_stride,
            step_mode: buffer.step_mode,
            attributes: buffer.attributes.to_vec(),
        });
        Ok(Self {
            target_format: desc.target_format,
            depth_stencil: desc.depth_stencil.clone(),
            vertex_buffers: vertex_buffers.collect(),
            primitive: desc.primitive,
            uniform,
            layout,
            group,
            pipelines: HashMap::new(),
        })
    }

    /// Takes the camera, the lights, and the surfaces that are drawn next, as they were prepared for
    /// this submission. The uniform is written through the queue: prepare once per submission.
    ///
    /// [`Error::Value`] for more than [`MAX_LIGHTS`] lights. A light whose numbers are not finite,
    /// or whose direction is 0, lights nothing. [`Error::Gpu`] where the host's vertex buffers or
    /// depth state do not fit the pass.
    pub fn prepare<'a>(
        &mut self,
        gpu: &Gpu,
        view: &View,
        lights: &[Light],
        surfaces: impl IntoIterator<Item = &'a HorizonShadow>,
    ) -> Result<(), Error> {
        let uniform = PassUniform::new(view, lights)?;
        for variant in surfaces.into_iter().filter_map(HorizonShadow::variant) {
            if !self.pipelines.contains_key(&variant) {
                let pipeline = gpu.checked("horizon-shadow's visibility pipeline", |device| {
                    self.pipeline(device, variant)
                })?;
                self.pipelines.insert(variant, pipeline);
            }
        }
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        Ok(())
    }

    /// Sets pipeline and bind groups 0 and 1; the host then sets its vertex buffers and draws the
    /// instances whose surface this is.
    ///
    /// False, and nothing is set, where there is nothing to draw with: the surface has no height
    /// map (its visibility is 1), or this pass was not prepared for it.
    #[must_use = "drawing after false would draw with what was set before"]
    pub fn set(&self, pass: &mut wgpu::RenderPass<'_>, surface: &HorizonShadow) -> bool {
        let pipeline = surface.variant().and_then(|variant| self.pipelines.get(&variant));
        let (Some(pipeline), Some(group)) = (pipeline, surface.bind_group()) else { return false };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_bind_group(1, group, &[]);
        true
    }

    fn pipeline(&self, device: &wgpu::Device, variant: Variant) -> wgpu::RenderPipeline {
        let module = shader(device, &shaders::HORIZON_SHADOW_VISIBILITY);
        let technique = technique_layout(device);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("horizon-shadow visibility"),
            bind_group_layouts: &[Some(&self.layout), Some(&technique)],
            immediate_size: 0,
        });
        let buffers: Vec<_> = self.vertex_buffers.iter().map(|buffer| Some(buffer.borrowed())).collect();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("horizon-shadow visibility"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("visibility_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: self.primitive,
            depth_stencil: self.depth_stencil.clone(),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("visibility"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &variant.constants(),
                    ..wgpu::PipelineCompilationOptions::default()
                },
                targets: &[Some(self.target_format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl VertexBuffer {
    fn borrowed(&self) -> wgpu::VertexBufferLayout<'_> {
        wgpu::VertexBufferLayout {
            array_stride: self.array_stride,
            step_mode: self.step_mode,
            attributes: &self.attributes,
        }
    }
}

fn check_target(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<(), Error> {
    let features = gpu.device().features();
    let writable = features.contains(format.required_features())
        && format
            .guaranteed_format_features(features)
            .allowed_usages
            .contains(wgpu::TextureUsages::RENDER_ATTACHMENT);
    let is_float =
        matches!(format.sample_type(None, Some(features)), Some(wgpu::TextureSampleType::Float { .. }));
    if writable && is_float && format.components() == 4 && format.has_color_aspect() {
        return Ok(());
    }
    Err(Error::Target { format })
}

/// `VisibilityLight` of `visibility.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
struct LightUniform {
    vector_world: [f32; 3],
    radius: f32,
    kind: u32,
    reserved: [u32; 3],
}

/// `VisibilityPass` of `visibility.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct PassUniform {
    clip_from_world: [[f32; 4]; 4],
    lights: [LightUniform; MAX_LIGHTS],
    light_count: u32,
    reserved: [u32; 3],
}

const KIND_DARK: u32 = 1;
const KIND_DIRECTIONAL: u32 = 2;
const KIND_POINT: u32 = 3;

impl PassUniform {
    fn new(view: &View, lights: &[Light]) -> Result<Self, Error> {
        if lights.len() > MAX_LIGHTS {
            return Err(Error::Value {
                what: "the number of lights of a visibility pass",
                found: lights.len().to_string(),
                expected: format!("at most {MAX_LIGHTS}; draw further lights with a pass of their own"),
            });
        }
        let mut uniform = Self {
            clip_from_world: view.clip_from_world,
            lights: [LightUniform::default(); MAX_LIGHTS],
            light_count: lights.len() as u32,
            reserved: [0; 3],
        };
        for (slot, light) in uniform.lights.iter_mut().zip(lights) {
            *slot = LightUniform::new(light);
        }
        Ok(uniform)
    }
}

impl LightUniform {
    fn new(light: &Light) -> Self {
        let (kind, vector_world, radius) = match *light {
            Light::Directional { direction_world, angular_diameter_rad } => {
                let radius_rad = 0.5 * angular_diameter_rad.clamp(0.0, std::f32::consts::PI);
                (KIND_DIRECTIONAL, unit(direction_world), radius_rad)
            }
            Light::Point { position_world, radius_m } => {
                let is_finite = position_world.iter().all(|x| x.is_finite());
                (KIND_POINT, is_finite.then_some(position_world), radius_m.clamp(0.0, f32::MAX))
            }
        };
        let usable = vector_world.filter(|_| !radius.is_nan());
        usable.map_or(Self { kind: KIND_DARK, ..Self::default() }, |vector_world| Self {
            vector_world,
            radius,
            kind,
            reserved: [0; 3],
        })
    }
}

/// The vector at length 1; `None` where it has no direction.
fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let v = v.map(f64::from);
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length.is_finite() && length > 0.0).then(|| v.map(|x| (x / length) as f32))
}
