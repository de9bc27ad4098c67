//! What the host lends for one frame.

/// Everything that one frame needs. The textures stay the host's.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The surrounding radiance; `None` skips the technique.
    pub environment: Option<Environment<'a>>,
    /// The surface buffer for the full-screen pass; `None` where the host calls the library from
    /// its own material shader instead.
    pub surface: Option<Surface<'a>>,
    /// The camera of the surface buffer.
    pub camera: Camera,
    /// The largest roughness that will be asked for, 0..1; a diffuse surface asks for 1. Where it
    /// is too small for more than mirrors, no chain is built. 1 where it is not known.
    pub max_roughness: f32,
}

/// A latitude-longitude map of linear radiance. For a unit direction d in its own space
/// u = 0.5 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi; v = 0 is the top row.
#[derive(Clone, Copy, Debug)]
pub struct Environment<'a> {
    /// A two-dimensional view of a filterable float format; only its first level is read.
    pub view: &'a wgpu::TextureView,
    /// Changes whenever the texels change. While it and the view's texture stay the same, nothing
    /// is built again.
    pub revision: u64,
    /// Factor on the radiance.
    pub intensity: f32,
    /// Turn about +Y in radians, counter-clockwise seen from above.
    pub rotation_rad: f32,
}

/// The host's surface buffer: four textures of one size, one texel a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Reverse-Z depth (`Depth32Float`); 0 where there is no surface.
    pub depth: &'a wgpu::TextureView,
    /// World-space unit normal in rgb, roughness 0..1 in a (`Rgba16Float`).
    pub normal_roughness: &'a wgpu::TextureView,
    /// Specular reflectance at normal incidence in rgb (any float or unorm format); a is not read.
    pub specular: &'a wgpu::TextureView,
    /// Diffuse albedo in rgb, ambient occlusion in a (any float or unorm format).
    pub albedo: &'a wgpu::TextureView,
    /// World-space unit normal of diffuse light alone in rgb (any float format): a bent normal, where
    /// the host knows from which side the sky is open. `None` takes `normal_roughness`.
    pub diffuse_normal: Option<&'a wgpu::TextureView>,
}

/// A camera, perspective or orthographic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World from clip space, columns first; clip depth is reverse-Z as in the surface buffer.
    pub world_from_clip: [[f32; 4]; 4],
    /// The eye in world space, metres.
    pub eye_world: [f32; 3],
}
