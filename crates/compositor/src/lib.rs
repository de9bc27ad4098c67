//! The frame on one page: a scene, through a surface buffer and Sheen's techniques, to an HDR
//! image. Neither a window nor a user interface: see [`headless::render`] for a picture from
//! nothing but a scene, and [`Compositor`] for frame after frame.
//!
//! # The frame
//!
//! 1. **geometry**: every instance to the [surface buffer](SurfaceBuffer), and what it emits to
//!    the HDR image.
//! 2. **horizon-shadow**: what the bumps of height maps hide of the first four lights, to the
//!    [visibility buffer](VISIBILITY_FORMAT); where its settings ask for it, what they hide of the
//!    sky, to the surface buffer's occlusion and its normals of diffuse light.
//! 3. **shadow-map**: what surfaces hide of the first four lights from each other, multiplied into
//!    the visibility buffer. Surfaces with a height map cast and receive it where their relief is;
//!    casters that the horizon map knows are left to it.
//! 4. **diffuse-envmap**: the environment's light on every surface, added to the HDR image.
//! 5. **background**: the environment where no surface is.
//! 6. **direct-light**: every light's Lambert and GGX reflection, times its visibility, added to
//!    the HDR image. A light's angular diameter widens the edges of shadows alone.
//! 7. **clear-coat**: a second specular layer where a material has one. It takes what it reflects
//!    off everything below it.
//! 8. [`Compositor::tone_map`], when the picture is to be shown.
//!
//! A pass that a frame does not need is neither compiled nor run, and says so in [`FrameWork`].
//!
//! # From a glTF material to the surface buffer
//!
//! - ks = mix(0.04, base colour, metallic), unless the material gives ks; diffuse albedo = base
//!   colour * (1 - metallic). Every lighting pass takes what the specular lobe reflects off
//!   the diffuse one.
//! - n = 2 / alpha^2 - 2 with alpha = roughness^2, unless the material gives a shininess.
//! - Back faces are culled, or, where the material is double-sided, drawn with the opposite
//!   normal. A mirrored instance has its winding and its bitangents turned over.
//! - A height map tilts the normal by its slope, over a texel or over a pixel, whichever is wider.
//!   The surface is drawn where its base is: bumps show in shading and shadows, not in outlines.
//! - A normal that faces away from the viewer is bent until the surface is just visible.
//! - `Mask` drops what is below the cutoff. `Blend` keeps an ordered dither of the pixels whose
//!   share is the opacity, because the surface buffer holds one surface per pixel.
//! - Values that are not finite or out of range are mended on upload, with a
//!   [warning](SceneGpu::warnings).

mod background;
mod coat;
mod direct_light;
mod environment;
mod error;
mod far_field;
mod frame;
mod geometry;
pub mod headless;
mod horizon;
mod mesh;
mod passes;
mod relief;
mod scene_gpu;
mod settings;
mod shadow_map;
mod shadows;
mod surface;
mod tessellation;
mod textures;
pub mod tone_map;
mod uniforms;
mod vertices;
mod view;
mod visibility;

/// Reasons why a pass was left out, or did less than the scene asks for.
pub mod skips {
    pub use crate::background::{BACKGROUND_OFF, NO_ENVIRONMENT};
    pub use crate::coat::NO_COATS;
    pub use crate::direct_light::{DIRECT_LIGHT_OFF, NO_LIGHTS, NO_SURFACE};
    pub use crate::far_field::DIFFUSE_ENVMAP_OFF;
    pub use crate::geometry::{BLENDED, NOTHING_TO_DRAW};
    pub use crate::horizon::{HORIZON_SHADOW_OFF, NO_HEIGHT_MAPS};
    pub use crate::shadow_map::{NO_CASTING_LIGHTS, SHADOW_MAP_OFF, SHADOW_MAP_STANDS};
    pub use crate::visibility::MORE_LIGHTS;
}

pub use diffuse_envmap;
pub use environment::EnvironmentGpu;
pub use error::Error;
pub use frame::{Compositor, Desc, Frame, FrameWork};
pub use horizon_shadow;
pub use scene_gpu::SceneGpu;
pub use settings::{Settings, ShadowMapSettings, ToneCurve};
pub use surface::{
    ALBEDO_FORMAT, DEPTH_FORMAT, HDR_FORMAT, NORMAL_ROUGHNESS_FORMAT, SPECULAR_FORMAT, SurfaceBuffer, Target,
};
pub use view::{Bounds, View};
pub use visibility::{MAX_SHADOWED_LIGHTS, VISIBILITY_FORMAT};
pub use wgpu;

/// The most pixels of a picture (8192 x 8192): the surface buffer takes 32 bytes for each.
pub const MAX_PIXELS: u64 = 1 << 26;
