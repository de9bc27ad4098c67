//! The uniform buffers, bit for bit as the shaders declare them.

use bytemuck::{Pod, Zeroable};

use crate::{
    frame::{Camera, Frame},
    settings::{Base, Distribution, Horizon, Method, Settings},
};

/// `DiffuseEnvmapParameters` of `library.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Parameters {
    rotation_cosine: f32,
    rotation_sine: f32,
    intensity: f32,
    roughness_offset: f32,
    map_size: [u32; 2],
    face_size: u32,
    method: u32,
    flags: u32,
    paper_rays: u32,
    one_tap_contrast: f32,
    reserved: f32,
    box_min_world: [f32; 4],
    box_max_world: [f32; 4],
    box_centre_world: [f32; 4],
}

/// `Camera` of `lighting.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CameraUniform {
    world_from_clip: [[f32; 4]; 4],
    eye_world: [f32; 4],
}

const FLAG_SLERP: u32 = 1;
const FLAG_DISCARD: u32 = 2;
const FLAG_UNIFORM_ANGLE: u32 = 4;
const FLAG_ROTATE: u32 = 8;
const FLAG_PARALLAX: u32 = 16;
const FLAG_NO_CHAIN: u32 = 32;

/// The most rays of the published method; more would hang a GPU for no visible gain.
const MAX_PAPER_RAYS: u32 = 4096;

/// `value` in a range, and `fallback` where it is not a number.
fn bounded(value: f32, least: f32, greatest: f32, fallback: f32) -> f32 {
    if value.is_nan() { fallback } else { value.clamp(least, greatest) }
}

impl Parameters {
    /// Settings out of range are brought into it. `face_size` is the edge of the chain's finest face,
    /// `None` where there is no chain.
    pub(crate) fn new(
        settings: &Settings,
        frame: &Frame<'_>,
        map_size: [u32; 2],
        face_size: Option<u32>,
    ) -> Self {
        let (environment_intensity, rotation_rad) = frame
            .environment
            .map_or((1.0, 0.0), |environment| (environment.intensity, environment.rotation_rad));
        let rotation_rad = if rotation_rad.is_finite() { rotation_rad } else { 0.0 };
        let mut flags = 0;
        let mut set = |condition: bool, flag| flags |= if condition { flag } else { 0 };
        set(settings.base == Base::Slerp, FLAG_SLERP);
        set(settings.horizon == Horizon::Discard, FLAG_DISCARD);
        set(settings.parallax.is_some(), FLAG_PARALLAX);
        set(face_size.is_none(), FLAG_NO_CHAIN);
        let (method, paper_rays) = match settings.method {
            Method::Paper { rays, distribution, rotate } => {
                set(distribution == Distribution::UniformAngle, FLAG_UNIFORM_ANGLE);
                set(rotate, FLAG_ROTATE);
                (0, rays.clamp(1, MAX_PAPER_RAYS))
            }
            Method::Sheen => (1, 1),
        };
        let point = |p: [f32; 3]| [p[0], p[1], p[2], 0.0];
        let zero = [0.0; 4];
        let (box_min_world, box_max_world, box_centre_world) = settings
            .parallax
            .map_or((zero, zero, zero), |b| (point(b.min_world), point(b.max_world), point(b.centre_world)));
        Self {
            rotation_cosine: rotation_rad.cos(),
            rotation_sine: rotation_rad.sin(),
            intensity: bounded(settings.intensity * environment_intensity, 0.0, 1e9, 0.0),
            roughness_offset: bounded(settings.roughness_offset, -1.0, 1.0, 0.0),
            map_size,
            face_size: face_size.unwrap_or(1),
            method,
            flags,
            paper_rays,
            one_tap_contrast: bounded(settings.one_tap_contrast, 0.0, 1.0, 0.0),
            reserved: 0.0,
            box_min_world,
            box_max_world,
            box_centre_world,
        }
    }
}

impl CameraUniform {
    pub(crate) fn new(camera: &Camera) -> Self {
        let [x, y, z] = camera.eye_world;
        Self { world_from_clip: camera.world_from_clip, eye_world: [x, y, z, 1.0] }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::{offset_of, size_of};

    use super::*;

    /// Name and offset of each member of a struct of a module, and the struct's size.
    fn layout(module: &shaders::Module, name: &str) -> (Vec<(String, usize)>, usize) {
        let parsed = naga::front::wgsl::parse_str(&module.source()).expect("the shader parses");
        let (members, span) = parsed
            .types
            .iter()
            .find_map(|(_, ty)| match (&ty.name, &ty.inner) {
                (Some(found), naga::TypeInner::Struct { members, span }) if found == name => {
                    Some((members, span))
                }
                _ => None,
            })
            .expect("the struct exists");
        let members =
            members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
        (members, *span as usize)
    }

    macro_rules! offsets {
        ($type:ty: $($field:ident)*) => {
            vec![$((stringify!($field).to_owned(), offset_of!($type, $field))),*]
        };
    }

    #[test]
    fn uniform_structs_match_the_shaders() {
        let (members, size) = layout(&shaders::DIFFUSE_ENVMAP_LIGHTING, "DiffuseEnvmapParameters");
        assert_eq!(size, size_of::<Parameters>());
        assert_eq!(
            members,
            offsets!(Parameters: rotation_cosine rotation_sine intensity roughness_offset map_size face_size
                method flags paper_rays one_tap_contrast reserved box_min_world box_max_world box_centre_world)
        );
        let (members, size) = layout(&shaders::DIFFUSE_ENVMAP_LIGHTING, "Camera");
        assert_eq!(size, size_of::<CameraUniform>());
        assert_eq!(members, offsets!(CameraUniform: world_from_clip eye_world));
    }
}
