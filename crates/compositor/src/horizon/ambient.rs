//! The share of the sky that bumps leave open, and the direction in which it lies.

use crate::{
    Error, SceneGpu, View,
    geometry::{depth_state, primitive, relief_vertex_buffers},
    passes::{self, UNIFORM, bind_group, bind_group_layout, loaded, uniform_buffer},
    surface::{ALBEDO_FORMAT, NORMAL_ROUGHNESS_FORMAT, SurfaceBuffer, Target, target},
    uniforms::ViewUniform,
};
use gpu_context::Gpu;
use horizon_shadow::{HorizonShadow, VertexFrame};
use std::collections::HashMap;

/// The pass; made when a frame first asks for it.
pub(super) struct Ambient {
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    view_layout: wgpu::BindGroupLayout,
    /// For plain and for mirrored instances, single- and double-sided, made on first use.
    pipelines: HashMap<(bool, bool), wgpu::RenderPipeline>,
}

impl Ambient {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        Ok(gpu.checked("ambient occlusion of height maps", |device| {
            let view = uniform_buffer(device, "view", size_of::<ViewUniform>());
            let view_layout = bind_group_layout(device, "view", stages, &[UNIFORM]);
            let view_group = bind_group(device, "view", &view_layout, &[view.as_entire_binding()]);
            Self { view, view_group, view_layout, pipelines: HashMap::new() }
        })?)
    }

    /// Multiplies the surface buffer's occlusion, and gives it bent normals.
    pub(super) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        view: &View,
        surfaces: &HashMap<(usize, usize), HorizonShadow>,
        surface: &mut SurfaceBuffer,
    ) -> Result<(), Error> {
        let Some(instances) = &scene.instances else { return Ok(()) };
        for draw in super::reliefs(scene) {
            let technique = surfaces.get(&(draw.material, draw.mesh));
            let Some(technique) = technique.filter(|_| !self.pipelines.contains_key(&draw.variant.faces()))
            else {
                continue;
            };
            let pipeline = self.pipeline(gpu, technique, draw.variant.faces())?;
            self.pipelines.insert(draw.variant.faces(), pipeline);
        }
        gpu.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view)));
        let bent = bent_normals(gpu, encoder, surface)?;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ambient occlusion of height maps"),
            color_attachments: &[Some(loaded(&surface.albedo.view)), Some(loaded(&bent.view))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &surface.depth.view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.view_group, &[]);
        pass.set_vertex_buffer(1, instances.slice(..));
        for draw in super::reliefs(scene) {
            let key = (draw.material, draw.mesh);
            let group = surfaces.get(&key).and_then(HorizonShadow::bind_group);
            let resources = (self.pipelines.get(&draw.variant.faces()), group, scene.reliefs.get(&key));
            let ((Some(pipeline), Some(group), Some(relief)), Some(mesh)) =
                (resources, scene.meshes.get(&draw.mesh))
            else {
                continue;
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, group, &[]);
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_vertex_buffer(2, relief.frames.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, draw.instances.clone());
        }
        drop(pass);
        surface.diffuse_normal = Some(bent);
        Ok(())
    }

    fn pipeline(
        &self,
        gpu: &Gpu,
        technique: &HorizonShadow,
        (double_sided, mirrored): (bool, bool),
    ) -> Result<wgpu::RenderPipeline, Error> {
        let second_form = wgpu::VertexAttribute {
            format: wgpu::VertexFormat::Float32x3,
            offset: std::mem::offset_of!(VertexFrame, second_form) as u64,
            shader_location: 12,
        };
        let [vertices, instances, frames] = relief_vertex_buffers();
        let mut attributes = frames.as_ref().map_or(Vec::new(), |frames| frames.attributes.to_vec());
        attributes.push(second_form);
        let frames = frames.map(|frames| wgpu::VertexBufferLayout { attributes: &attributes, ..frames });
        // Occlusion alone: the colour stays.
        let multiply = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::SrcAlpha,
            operation: wgpu::BlendOperation::Add,
        };
        let occlusion = wgpu::ColorTargetState {
            format: ALBEDO_FORMAT,
            blend: Some(wgpu::BlendState { color: multiply, alpha: multiply }),
            write_mask: wgpu::ColorWrites::ALPHA,
        };
        Ok(gpu.checked("ambient occlusion of height maps", |device| {
            let label = "ambient occlusion of height maps";
            let module = passes::shader(device, label, &shaders::COMPOSITOR_HORIZON_AMBIENT);
            let groups = [&self.view_layout, technique.bind_group_layout()];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&passes::layout(device, label, &groups)),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("horizon_ambient_vertex"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[vertices, instances, frames],
                },
                primitive: primitive(double_sided, mirrored),
                depth_stencil: Some(depth_state(false, wgpu::CompareFunction::Equal)),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("horizon_ambient_fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(occlusion), Some(NORMAL_ROUGHNESS_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        })?)
    }
}

/// The normals of all surfaces, to be bent where there are height maps.
fn bent_normals(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    surface: &mut SurfaceBuffer,
) -> Result<Target, Error> {
    let bent = match surface.diffuse_normal.take() {
        Some(bent) => bent,
        None => gpu.checked("bent normals", |device| {
            target(device, "bent normals", surface.size, NORMAL_ROUGHNESS_FORMAT)
        })?,
    };
    let size = surface.normal_roughness.texture.size();
    encoder.copy_texture_to_texture(
        surface.normal_roughness.texture.as_image_copy(),
        bent.texture.as_image_copy(),
        size,
    );
    Ok(bent)
}
