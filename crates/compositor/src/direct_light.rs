//! Direct light pass: Lambert and GGX reflection of every light, over the surface buffer.

use crate::{
    Error, View,
    passes::{
        DEPTH, Fullscreen, LOADED, STORAGE, UNIFORM, additive, bind_group, bind_group_layout, loaded,
        uniform_buffer,
    },
    surface::{HDR_FORMAT, SurfaceBuffer},
    uniforms::ViewUniform,
};
use gpu_context::{Gpu, Skip, Work};

/// No light of the scene sends anything.
pub const NO_LIGHTS: Skip = Skip::new("the scene has no lights besides its environment");

/// There is no surface that could reflect.
pub const NO_SURFACE: Skip = Skip::new("the scene has no triangles to light");

/// The settings leave direct light out.
pub const DIRECT_LIGHT_OFF: Skip = Skip::new("direct light is turned off");

/// The pass; made when a frame first has lights.
pub(crate) struct DirectLight {
    pipeline: wgpu::RenderPipeline,
    frame_layout: wgpu::BindGroupLayout,
    surface_layout: wgpu::BindGroupLayout,
    view: wgpu::Buffer,
}

impl DirectLight {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let device = gpu.device();
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let frame_layout = bind_group_layout(device, "lights", fragment, &[UNIFORM, STORAGE]);
        let surface_layout =
            bind_group_layout(device, "surface buffer", fragment, &[DEPTH, LOADED, LOADED, LOADED]);
        let pipeline = Fullscreen {
            label: "direct light",
            module: &shaders::COMPOSITOR_DIRECT_LIGHT,
            fragment: "direct_light_fragment",
            constants: &[],
            layouts: &[&frame_layout, &surface_layout],
            target: additive(HDR_FORMAT),
            depth_stencil: None,
        }
        .pipeline(gpu)?;
        let view = uniform_buffer(device, "view", size_of::<ViewUniform>());
        Ok(Self { pipeline, frame_layout, surface_layout, view })
    }

    pub(crate) fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lights: &wgpu::Buffer,
        view: &View,
        surface: &SurfaceBuffer,
    ) -> Work {
        gpu.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view)));
        let resources = [self.view.as_entire_binding(), lights.as_entire_binding()];
        let frame = bind_group(gpu.device(), "lights", &self.frame_layout, &resources);
        let views = [&surface.depth, &surface.normal_roughness, &surface.specular, &surface.albedo]
            .map(|target| wgpu::BindingResource::TextureView(&target.view));
        let surface_group = bind_group(gpu.device(), "surface buffer", &self.surface_layout, &views);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("direct light"),
            color_attachments: &[Some(loaded(&surface.hdr.view))],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame, &[]);
        pass.set_bind_group(1, &surface_group, &[]);
        pass.draw(0..3, 0..1);
        Work::done(1)
    }
}
