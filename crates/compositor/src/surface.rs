//! The surface buffer and the HDR image: what the geometry pass leaves to every later pass.

use crate::{Error, MAX_PIXELS};
use gpu_context::Gpu;
use wgpu::TextureFormat;

/// Depth of the nearest surface: reversed, `near_m` over the distance along the view axis; 0, the
/// clear value, where no surface is.
pub const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// Unit shading normal in world space, always turned to the viewer, and perceptual roughness
/// 0..1 (the `t` of diffuse-envmap) in the last channel.
pub const NORMAL_ROUGHNESS_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Specular reflectance at normal incidence 0..1 as linear RGB, and the Blinn exponent n,
/// 0..65504, in the last channel.
pub const SPECULAR_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Diffuse albedo 0..1, stored with the sRGB curve and read as linear RGB, and ambient occlusion
/// (1 = open), linear, in the last channel.
pub const ALBEDO_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Scene-referred linear radiance. The geometry pass writes what surfaces emit; every later pass
/// adds to it. The last channel is coverage: 1 on a surface, 0 on the background.
pub const HDR_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// A texture and the view of all of it.
#[derive(Debug)]
pub struct Target {
    /// The texture; it can be sampled and read back.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
}

/// The surface buffer and the HDR image of one picture size.
#[derive(Debug)]
pub struct SurfaceBuffer {
    /// Pixels per row, and rows.
    pub size: [u32; 2],
    /// See [`DEPTH_FORMAT`].
    pub depth: Target,
    /// See [`NORMAL_ROUGHNESS_FORMAT`].
    pub normal_roughness: Target,
    /// See [`SPECULAR_FORMAT`].
    pub specular: Target,
    /// See [`ALBEDO_FORMAT`].
    pub albedo: Target,
    /// See [`HDR_FORMAT`].
    pub hdr: Target,
    /// Where diffuse light comes from past the bumps of height maps, else the normal: as
    /// [`NORMAL_ROUGHNESS_FORMAT`], where the frame asked horizon-shadow for it.
    pub diffuse_normal: Option<Target>,
}

impl SurfaceBuffer {
    /// Makes all targets, or none. [`Error::Size`] where a side is 0 or too long or there are more
    /// than [`MAX_PIXELS`] pixels; [`Error::Gpu`] where memory runs out.
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, Error> {
        check_size(gpu, size)?;
        Ok(gpu.checked("the surface buffer", |device| Self {
            size,
            depth: target(device, "depth", size, DEPTH_FORMAT),
            normal_roughness: target(device, "normal and roughness", size, NORMAL_ROUGHNESS_FORMAT),
            specular: target(device, "specular", size, SPECULAR_FORMAT),
            albedo: target(device, "albedo", size, ALBEDO_FORMAT),
            hdr: target(device, "HDR image", size, HDR_FORMAT),
            diffuse_normal: None,
        })?)
    }
}

fn check_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<(), Error> {
    let limit = gpu.device().limits().max_texture_dimension_2d;
    let fits = (1..=limit).contains(&width) && (1..=limit).contains(&height);
    if fits && u64::from(width) * u64::from(height) <= MAX_PIXELS {
        return Ok(());
    }
    Err(Error::Size { width, height, limit, pixels: MAX_PIXELS })
}

pub(crate) fn target(device: &wgpu::Device, label: &str, size: [u32; 2], format: TextureFormat) -> Target {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    Target { texture, view }
}
