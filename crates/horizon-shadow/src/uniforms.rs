//! The uniform buffers, bit for bit as the shaders declare them.

use bytemuck::{Pod, Zeroable};

/// `HorizonShadowParameters` of `tables-library.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Parameters {
    pub(crate) size: [f32; 2],
    pub(crate) uv_scale: [f32; 2],
    pub(crate) least_height: f32,
    pub(crate) greatest_height: f32,
    pub(crate) height_scale_m: f32,
    pub(crate) texels_per_height: f32,
    pub(crate) least_curvature: f32,
    pub(crate) greatest_curvature: f32,
    pub(crate) radius_texels: f32,
    pub(crate) slope_scale: f32,
    pub(crate) azimuths: u32,
    pub(crate) candidates: u32,
    pub(crate) contents: u32,
    pub(crate) wrap: u32,
    pub(crate) baked_azimuths: [u32; 2],
    pub(crate) method: u32,
    pub(crate) march_steps: u32,
    pub(crate) flags: u32,
    pub(crate) reserved: [u32; 3],
}

/// `HORIZON_SHADOW_METHOD_*` of `tables-library.wgsl`.
pub(crate) fn method_code(method: crate::Method) -> u32 {
    use crate::Method;
    match method {
        Method::None => 0,
        Method::Flat => 1,
        Method::Paper => 2,
        Method::Exact => 3,
        Method::Sheen => 4,
        Method::Certified => 5,
        Method::Marched => 6,
    }
}
