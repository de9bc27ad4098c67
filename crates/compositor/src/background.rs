//! Background pass: the environment where no surface is.

use crate::{
    Error, View,
    environment::EnvironmentGpu,
    geometry::depth_state,
    passes::{FILTERED, Fullscreen, SAMPLER, UNIFORM, bind_group, bind_group_layout, loaded, uniform_buffer},
    surface::{HDR_FORMAT, SurfaceBuffer},
    uniforms::BackgroundUniform,
};
use gpu_context::{Gpu, Skip, Work};

/// There is no environment: the background stays black.
pub const NO_ENVIRONMENT: Skip = Skip::new("the scene has no environment; the background is black");

/// The settings leave the background out.
pub const BACKGROUND_OFF: Skip = Skip::new("the background is turned off");

/// The pass; made when a frame first has an environment.
pub(crate) struct Background {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
}

impl Background {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let device = gpu.device();
        let bindings = [UNIFORM, FILTERED, SAMPLER];
        let layout = bind_group_layout(device, "background", wgpu::ShaderStages::FRAGMENT, &bindings);
        let pipeline = Fullscreen {
            label: "background",
            module: &shaders::COMPOSITOR_BACKGROUND,
            fragment: "background_fragment",
            constants: &[],
            layouts: &[&layout],
            target: HDR_FORMAT.into(),
            // The triangle lies at depth 0, which is only where nothing was drawn.
            depth_stencil: Some(depth_state(false, wgpu::CompareFunction::Equal)),
        }
        .pipeline(gpu)?;
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("latitude-longitude"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::ClampToEdge,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let uniform = uniform_buffer(device, "background", size_of::<BackgroundUniform>());
        Ok(Self { pipeline, layout, uniform, sampler })
    }

    pub(crate) fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        environment: &EnvironmentGpu,
        view: &View,
        surface: &SurfaceBuffer,
    ) -> Work {
        let uniform = BackgroundUniform::new(view, environment.rotation_rad, environment.intensity);
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let resources = [
            self.uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&environment.view),
            wgpu::BindingResource::Sampler(&self.sampler),
        ];
        let bind_group = bind_group(gpu.device(), "background", &self.layout, &resources);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("background"),
            color_attachments: &[Some(loaded(&surface.hdr.view))],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &surface.depth.view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.draw(0..3, 0..1);
        Work::done(1)
    }
}
