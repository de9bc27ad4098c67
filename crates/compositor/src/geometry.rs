//! Geometry pass: every instance to the surface buffer.

use crate::{
    Error, SceneGpu, View,
    passes::{self, FILTERED, SAMPLER, UNIFORM, bind_group, bind_group_layout, cleared, uniform_buffer},
    surface::{self, SurfaceBuffer},
    uniforms::{InstanceVertex, Vertex, ViewUniform},
};
use gpu_context::{Gpu, Skip, Work};
use scene::{AlphaMode, Material};
use std::collections::HashMap;

/// The scene draws nothing: the pass only clears the surface buffer.
pub const NOTHING_TO_DRAW: Skip = Skip::new("the scene has no triangles; the pass only cleared its targets");

/// Blended surfaces were dithered, coats left out.
pub const BLENDED_AND_COATED: Skip = Skip::new(
    "blended surfaces keep a dithered share of their pixels equal to their opacity; clear coats are left out",
);

/// Blended surfaces were dithered.
pub const BLENDED: Skip =
    Skip::new("blended surfaces keep a dithered share of their pixels equal to their opacity");

/// Clear coats were left out.
pub const COATED: Skip = Skip::new("clear coats are left out");

/// What needs a pipeline of its own. The order is the order of drawing: opaque surfaces first, so
/// that those with holes are mostly hidden before their textures are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Variant {
    /// `alpha_mode` of the shader: opaque, mask, blend.
    alpha_mode: u8,
    double_sided: bool,
    mirrored: bool,
}

impl Variant {
    pub(crate) fn new(material: &Material, mirrored: bool) -> Self {
        let alpha_mode = match material.alpha_mode {
            AlphaMode::Opaque => 0,
            AlphaMode::Mask { .. } => 1,
            AlphaMode::Blend => 2,
        };
        Self { alpha_mode, double_sided: material.double_sided, mirrored }
    }
}

/// The pass, with the pipelines that the scenes so far needed.
pub(crate) struct Geometry {
    view: wgpu::Buffer,
    view_layout: wgpu::BindGroupLayout,
    view_bind_group: wgpu::BindGroup,
    module: wgpu::ShaderModule,
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
            Self { view, view_layout, view_bind_group, module, pipelines: HashMap::new() }
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
            let groups = [&self.view_layout, &material_layout(device)];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("geometry"),
                layout: Some(&passes::layout(device, "geometry", &groups)),
                vertex: wgpu::VertexState {
                    module: &self.module,
                    entry_point: Some("geometry_vertex"),
                    compilation_options: options.clone(),
                    buffers: &vertex_buffers(),
                },
                primitive: primitive(variant),
                depth_stencil: Some(depth_state(true, wgpu::CompareFunction::Greater)),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.module,
                    entry_point: Some("geometry_fragment"),
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
    let skipped = match (scene.draws.is_empty(), scene.blended_draws() > 0, scene.coated_draws() > 0) {
        (true, ..) => Some(NOTHING_TO_DRAW),
        (_, true, true) => Some(BLENDED_AND_COATED),
        (_, true, false) => Some(BLENDED),
        (_, false, true) => Some(COATED),
        (_, false, false) => None,
    };
    Work { passes: 1, skipped }
}

/// A material's uniform and its five textures, each with a sampler.
pub(crate) fn material_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let mut bindings = vec![UNIFORM];
    bindings.extend([FILTERED, SAMPLER].repeat(5));
    bind_group_layout(device, "material", wgpu::ShaderStages::FRAGMENT, &bindings)
}

fn vertex_buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    let layout = |array_stride: usize, step_mode, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride: array_stride as u64, step_mode, attributes })
    };
    [
        layout(size_of::<Vertex>(), wgpu::VertexStepMode::Vertex, &Vertex::ATTRIBUTES),
        layout(size_of::<InstanceVertex>(), wgpu::VertexStepMode::Instance, &InstanceVertex::ATTRIBUTES),
    ]
}

fn primitive(variant: Variant) -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        front_face: if variant.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
        cull_mode: (!variant.double_sided).then_some(wgpu::Face::Back),
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
