//! Direct light pass: Lambert and GGX reflection of every light, over the surface buffer.

use crate::{
    Error, View,
    passes::{
        DEPTH, Fullscreen, LOADED, STORAGE, UNIFORM, additive, bind_group, bind_group_layout, loaded,
        uniform_buffer,
    },
    surface::{HDR_FORMAT, SurfaceBuffer, Target},
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
    /// Without and with shadows, each made on first use.
    pipelines: [Option<wgpu::RenderPipeline>; 2],
    frame_layout: wgpu::BindGroupLayout,
    surface_layout: wgpu::BindGroupLayout,
    view: wgpu::Buffer,
}

impl DirectLight {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let device = gpu.device();
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let bindings = [DEPTH, LOADED, LOADED, LOADED, LOADED];
        Self {
            pipelines: [None, None],
            frame_layout: bind_group_layout(device, "lights", fragment, &[UNIFORM, STORAGE]),
            surface_layout: bind_group_layout(device, "surface buffer", fragment, &bindings),
            view: uniform_buffer(device, "view", size_of::<ViewUniform>()),
        }
    }

    fn pipeline(&self, gpu: &Gpu, is_shadowed: bool) -> Result<wgpu::RenderPipeline, Error> {
        Fullscreen {
            label: "direct light",
            module: &shaders::COMPOSITOR_DIRECT_LIGHT,
            fragment: "direct_light_fragment",
            constants: &[("is_shadowed", f64::from(u8::from(is_shadowed)))],
            layouts: &[&self.frame_layout, &self.surface_layout],
            target: additive(HDR_FORMAT),
            depth_stencil: None,
        }
        .pipeline(gpu)
    }

    /// Adds the lights' reflection; `visibility` dims the first of them.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lights: &wgpu::Buffer,
        view: &View,
        surface: &SurfaceBuffer,
        visibility: Option<&Target>,
    ) -> Result<Work, Error> {
        let variant = usize::from(visibility.is_some());
        let pipeline = match self.pipelines[variant].take() {
            Some(pipeline) => pipeline,
            None => self.pipeline(gpu, visibility.is_some())?,
        };
        let pipeline = self.pipelines[variant].insert(pipeline);
        gpu.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view)));
        let resources = [self.view.as_entire_binding(), lights.as_entire_binding()];
        let frame = bind_group(gpu.device(), "lights", &self.frame_layout, &resources);
        // Any texture will do where there are no shadows: it is not read.
        let visibility = visibility.unwrap_or(&surface.albedo);
        let views =
            [&surface.depth, &surface.normal_roughness, &surface.specular, &surface.albedo, visibility]
                .map(|target| wgpu::BindingResource::TextureView(&target.view));
        let surface_group = bind_group(gpu.device(), "surface buffer", &self.surface_layout, &views);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("direct light"),
            color_attachments: &[Some(loaded(&surface.hdr.view))],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &frame, &[]);
        pass.set_bind_group(1, &surface_group, &[]);
        pass.draw(0..3, 0..1);
        Ok(Work::done(1))
    }
}
