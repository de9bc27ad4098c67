//! diffuse-envmap over the surface buffer: the environment's light on every surface.

use crate::{
    Error, SceneGpu, View,
    passes::loaded,
    surface::{HDR_FORMAT, SurfaceBuffer},
};
use diffuse_envmap::{Camera, Desc, DiffuseEnvmap, Environment, Frame, Settings, Surface};
use gpu_context::{Gpu, Skip, Work};

/// The settings leave the technique out.
pub const DIFFUSE_ENVMAP_OFF: Skip = Skip::new("diffuse-envmap is turned off");

pub(crate) fn new(gpu: &Gpu) -> Result<DiffuseEnvmap, Error> {
    Ok(DiffuseEnvmap::new(gpu, &Desc { target_format: HDR_FORMAT })?)
}

/// Prepares the technique and adds its light to the HDR image.
pub(crate) fn draw(
    technique: &mut DiffuseEnvmap,
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    settings: &Settings,
    scene: &SceneGpu,
    view: &View,
    surface: &SurfaceBuffer,
) -> Result<Work, Error> {
    let frame = Frame {
        environment: scene.environment().map(|environment| Environment {
            view: &environment.view,
            revision: environment.revision,
            intensity: environment.intensity,
            rotation_rad: environment.rotation_rad,
        }),
        surface: Some(Surface {
            depth: &surface.depth.view,
            normal_roughness: &surface.normal_roughness.view,
            specular: &surface.specular.view,
            albedo: &surface.albedo.view,
            diffuse_normal: surface.diffuse_normal.as_ref().map(|target| &target.view),
        }),
        camera: Camera {
            world_from_clip: view.world_from_clip.to_cols_array_2d(),
            eye_world: view.eye_world.to_array(),
        },
        max_roughness: scene.max_roughness(),
    };
    let mut work = technique.prepare(gpu, encoder, settings, &frame)?;
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("diffuse-envmap"),
        color_attachments: &[Some(loaded(&surface.hdr.view))],
        ..wgpu::RenderPassDescriptor::default()
    });
    technique.render(&mut pass);
    work.passes += 1;
    Ok(work)
}
