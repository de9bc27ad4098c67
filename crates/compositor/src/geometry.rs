//! Geometry pass: every instance to the surface buffer.

use crate::{
    Error, SceneGpu, View,
    passes::{self, FILTERED, SAMPLER, UNIFORM, bind_group, bind_group_layout, cleared, uniform_buffer},
    relief,
    surface::{self, SurfaceBuffer},
    uniforms::ViewUniform,
    vertices::{FRAME_ATTRIBUTES, InstanceVertex, Vertex},
};
use gpu_context::{Gpu, Skip, Work};
use horizon_shadow::VertexFrame;
use scene::{AlphaMode, Material};
use std::collections::HashMap;

/// The scene draws nothing: the pass only clears the surface buffer.
pub const NOTHING_TO_DRAW: Skip = Skip::new("the scene has no triangles; the pass only cleared its targets");

/// Blended surfaces were dithered.
pub const BLENDED: Skip =
    Skip::new("blended surfaces keep a dithered share of their pixels equal to their opacity");

/// What needs a pipeline of its own. The order is the order of drawing: opaque surfaces first, so
/// that those with holes are mostly hidden before their textures are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Variant {
    /// `alpha_mode` of the shader: opaque, mask, blend.
    alpha_mode: u8,
    double_sided: bool,
    mirrored: bool,
    /// Whether it has a height map.
    relief: bool,
}

impl Variant {
    pub(crate) fn new(material: &Material, mirrored: bool, relief: bool) -> Self {
        let alpha_mode = match material.alpha_mode {
            AlphaMode::Opaque => 0,
            AlphaMode::Mask { .. } => 1,
            AlphaMode::Blend => 2,
        };
        Self { alpha_mode, double_sided: material.double_sided, mirrored, relief }
    }

    /// `alpha_mode` of the shader.
    pub(crate) fn alpha_mode(self) -> f64 {
        f64::from(self.alpha_mode)
    }

    /// Whether it has a height map.
    pub(crate) fn has_relief(self) -> bool {
        self.relief
    }

    /// Whether it is double-sided, and whether it is mirrored.
    pub(crate) fn faces(self) -> (bool, bool) {
        (self.double_sided, self.mirrored)
    }
}

/// The pass, with the pipelines that the scenes so far needed.
pub(crate) struct Geometry {
    view: wgpu::Buffer,
    view_layout: wgpu::BindGroupLayout,
    view_bind_group: wgpu::BindGroup,
    module: wgpu::ShaderModule,
    /// For height maps; made when a scene first has one.
    relief_module: Option<wgpu::ShaderModule>,
    pipelines: HashMap<Variant, wgpu::RenderPipeline>,
}

impl Geometry {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(gpu.checked("geometry pass", |device| {
            let view = uniform_buffer(device, "view", size_of::<ViewUniform>());
            let view_layout =
                bind_group_layout(device, "view", wgpu::ShaderStages::VERTEX_FRAGMENT, &[UNIFORM]);
            let view_bind_group = bind_group(device, "view", &view_layout, &[view.as_entire_binding()]);
            let module = passes::shader(device, "geometry", &shaders::COMPOSITOR_GEOMETRY);
            Self {
                view,
                view_layout,
                view_bind_group,
                module,
                relief_module: None,
                pipelines: HashMap::new(),
            }
        })?)
    }

    /// Clears the surface buffer and draws the scene into it.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        view: &View,
        surface: &SurfaceBuffer,
    ) -> Result<Work, Error> {
        if self.relief_module.is_none() && !scene.reliefs.is_empty() {
            self.relief_module = Some(gpu.checked("geometry pass for height maps", |device| {
                passes::shader(device, "geometry of height maps", &shaders::COMPOSITOR_GEOMETRY_RELIEF)
            })?);
        }
        for draw in &scene.draws {
            if !self.pipelines.contains_key(&draw.variant) {
                self.pipelines.insert(draw.variant, self.pipeline(gpu, draw.variant)?);
            }
        }
        gpu.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view)));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("geometry"),
            color_attachments: &[
                Some(cleared(&surface.normal_roughness.view)),
                Some(cleared(&surface.specular.view)),
                Some(cleared(&surface.albedo.view)),
                Some(cleared(&surface.hdr.view)),
            ],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &surface.depth.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        self.record(&mut pass, scene);
        Ok(work(scene))
    }

    fn record(&self, pass: &mut wgpu::RenderPass<'_>, scene: &SceneGpu) {
        let Some(instances) = &scene.instances else { return };
        pass.set_bind_group(0, &self.view_bind_group, &[]);
        pass.set_vertex_buffer(1, instances.slice(..));
        for draw in &scene.draws {
            let resources = (
                self.pipelines.get(&draw.variant),
                scene.materials.get(&draw.material),
                scene.meshes.get(&draw.mesh),
            );
            let (Some(pipeline), Some(material), Some(mesh)) = resources else { continue };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, material, &[]);
            if draw.variant.relief {
                let Some(relief) = scene.reliefs.get(&(draw.material, draw.mesh)) else { continue };
                pass.set_bind_group(2, &relief.group, &[]);
                pass.set_vertex_buffer(2, relief.frames.slice(..));
            }
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, draw.instances.clone());
        }
    }

    fn pipeline(&self, gpu: &Gpu, variant: Variant) -> Result<wgpu::RenderPipeline, Error> {
        let constants = [("alpha_mode", f64::from(variant.alpha_mode))];
        let options = wgpu::PipelineCompilationOptions {
            constants: &constants,
            ..wgpu::PipelineCompilationOptions::default()
        };
        let targets = [
            surface::NORMAL_ROUGHNESS_FORMAT,
            surface::SPECULAR_FORMAT,
            surface::ALBEDO_FORMAT,
            surface::HDR_FORMAT,
        ]
        .map(|format| Some(wgpu::ColorTargetState::from(format)));
        Ok(gpu.checked("geometry pass", |device| {
            let (material, relief) = (material_layout(device), relief::layout(device));
            let groups = [&self.view_layout, &material, &relief];
            let (module, vertex, fragment, used) = match (&self.relief_module, variant.relief) {
                (Some(module), true) => (module, "relief_vertex", "geometry_relief_fragment", 3),
                _ => (&self.module, "geometry_vertex", "geometry_fragment", 2),
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("geometry"),
                layout: Some(&passes::layout(device, "geometry", &groups[..used])),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(vertex),
                    compilation_options: options.clone(),
                    buffers: &relief_vertex_buffers()[..used],
                },
                primitive: primitive(variant.double_sided, variant.mirrored),
                depth_stencil: Some(depth_state(true, wgpu::CompareFunction::Greater)),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some(fragment),
                    compilation_options: options,
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        })?)
    }
}

fn work(scene: &SceneGpu) -> Work {
    let skipped = match (scene.draws.is_empty(), scene.blended_draws() > 0) {
        (true, _) => Some(NOTHING_TO_DRAW),
        (false, true) => Some(BLENDED),
        (false, false) => None,
    };
    Work { passes: 1, skipped }
}

/// A material's uniform and its five textures, each with a sampler.
pub(crate) fn material_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let mut bindings = vec![UNIFORM];
    bindings.extend([FILTERED, SAMPLER].repeat(5));
    bind_group_layout(device, "material", wgpu::ShaderStages::FRAGMENT, &bindings)
}

pub(crate) fn vertex_buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    let [vertices, instances, _] = relief_vertex_buffers();
    [vertices, instances]
}

/// The vertices, the instances, and the vertices' frames for height maps.
pub(crate) fn relief_vertex_buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 3] {
    let layout = |array_stride: usize, step_mode, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride: array_stride as u64, step_mode, attributes })
    };
    let [vertex, instance] = [wgpu::VertexStepMode::Vertex, wgpu::VertexStepMode::Instance];
    [
        layout(size_of::<Vertex>(), vertex, &Vertex::ATTRIBUTES),
        layout(size_of::<InstanceVertex>(), instance, &InstanceVertex::ATTRIBUTES),
        layout(size_of::<VertexFrame>(), vertex, &FRAME_ATTRIBUTES),
    ]
}

pub(crate) fn primitive(double_sided: bool, mirrored: bool) -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        front_face: if mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
        cull_mode: (!double_sided).then_some(wgpu::Face::Back),
        ..wgpu::PrimitiveState::default()
    }
}

pub(crate) fn depth_state(write: bool, compare: wgpu::CompareFunction) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: surface::DEPTH_FORMAT,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}
