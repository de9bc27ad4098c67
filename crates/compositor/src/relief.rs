//! Height maps on meshes: what the passes that draw them need.

use crate::{
    Error,
    environment::next_revision,
    mesh::{MeshGpu, buffer},
    passes::{LOADED, UNIFORM, bind_group, bind_group_layout},
    tessellation,
    textures::all_of,
    uniforms::ReliefUniform,
};
use glam::{Mat3, Mat4, Vec3};
use gpu_context::{Gpu, upload};
use horizon_shadow::{VertexFrame, frames};
use scene::{HeightMap, HeightRef, Mesh, Scene, Warning};

/// A height map on the GPU, one level of `R32Float`.
#[derive(Debug)]
pub(crate) struct HeightMapGpu {
    pub(crate) view: wgpu::TextureView,
    pub(crate) size: [u32; 2],
    /// Least and greatest height.
    pub(crate) range: [f32; 2],
    pub(crate) revision: u64,
}

impl HeightMapGpu {
    /// Uploads a height map, turned over where `is_negated`. Heights that are not finite become the
    /// least of the others, with a warning.
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &Scene,
        place: &str,
        map: &HeightMap,
        is_negated: bool,
    ) -> Result<(Self, Option<Warning>), Error> {
        let expected = u64::from(map.width) * u64::from(map.height);
        if map.heights.len() as u64 != expected {
            let found = format!("{} heights", map.heights.len());
            let expected = format!("{expected}, {} x {}", map.width, map.height);
            return Err(scene::Error::new(&scene.name, place, found, expected).into());
        }
        upload::check_size(gpu, place, map.width, map.height)?;
        let sign = if is_negated { -1.0 } else { 1.0 };
        let finite = || map.heights.iter().map(|height| height * sign).filter(|height| height.is_finite());
        let least = finite().reduce(f32::min).unwrap_or(0.0);
        let greatest = finite().reduce(f32::max).unwrap_or(0.0);
        let mut mended = 0_usize;
        let heights: Vec<f32> = map
            .heights
            .iter()
            .map(|&height| {
                mended += usize::from(!height.is_finite());
                if height.is_finite() { height * sign } else { least }
            })
            .collect();
        let bytes = bytemuck::cast_slice(&heights);
        let format = wgpu::TextureFormat::R32Float;
        let texture = upload::texture_2d(gpu, place, map.width, map.height, format, bytes, None)?;
        let warning = (mended > 0).then(|| Warning {
            file: map.name.clone(),
            place: "heights".into(),
            message: format!("{mended} heights that are not finite were brought to the least of the others"),
        });
        let size = [map.width, map.height];
        let map = Self { view: all_of(&texture), size, range: [least, greatest], revision: next_revision() };
        Ok((map, warning))
    }
}

/// A mesh with the height map of a material on it.
#[derive(Debug)]
pub(crate) struct Relief {
    /// Which height map, and whether it is turned over.
    pub(crate) map: (usize, bool),
    pub(crate) height_scale_m: f32,
    pub(crate) uv_scale: [f32; 2],
    /// One [`VertexFrame`] for each vertex of the mesh.
    pub(crate) frames: wgpu::Buffer,
    /// The height map for shaders, in [`layout`].
    pub(crate) group: wgpu::BindGroup,
    /// What the horizon tables must suit, for all instances.
    pub(crate) surface: horizon_shadow::Surface,
    /// The mesh fine enough to be displaced: what casts its shadow.
    pub(crate) casters: MeshGpu,
}

/// What a relief is made of.
pub(crate) struct Parts<'a> {
    /// Names it in errors.
    pub(crate) place: &'a str,
    pub(crate) mesh: &'a Mesh,
    pub(crate) height: &'a HeightRef,
    pub(crate) map: &'a HeightMap,
    pub(crate) map_gpu: &'a HeightMapGpu,
    /// Where its instances stand.
    pub(crate) placements: &'a [Mat4],
}

impl Relief {
    pub(crate) fn new(gpu: &Gpu, parts: &Parts<'_>) -> Result<Self, Error> {
        let Parts { place, mesh, height, map, map_gpu, placements } = *parts;
        let frames = frames::vertex_frames(
            bytemuck::cast_slice(&mesh.positions),
            bytemuck::cast_slice(&mesh.normals),
            bytemuck::cast_slice(&mesh.uvs),
            &mesh.triangles,
        )?;
        let uniform = ReliefUniform::new(height, map_gpu.size);
        let uniform = buffer(gpu, place, wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(&uniform))?;
        let resources = [uniform.as_entire_binding(), wgpu::BindingResource::TextureView(&map_gpu.view)];
        let group = gpu.checked(place, |device| bind_group(device, place, &layout(device), &resources))?;
        let fine = tessellation::fine(mesh, height, map, map_gpu.range[0] * height.height_scale.signum());
        Ok(Self {
            map: key(height),
            height_scale_m: height.height_scale.abs(),
            uv_scale: height.uv_scale,
            frames: buffer(gpu, place, wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&frames))?,
            group,
            surface: surface(mesh, &frames, height, map_gpu.size, placements),
            casters: MeshGpu::of(gpu, place, bytemuck::cast_slice(&fine.vertices), &fine.triangles)?,
        })
    }
}

/// Which height map a material uses, and whether it is turned over: shaders take heights that rise
/// with their values.
pub(crate) fn key(height: &HeightRef) -> (usize, bool) {
    (height.map, height.height_scale < 0.0)
}

/// Whether a material's height map can be laid on a surface.
pub(crate) fn is_usable(height: &HeightRef) -> bool {
    height.height_scale.is_finite() && height.uv_scale.iter().all(|scale| scale.is_normal())
}

/// A relief's uniform and its heights.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    bind_group_layout(device, "relief", wgpu::ShaderStages::FRAGMENT, &[UNIFORM, LOADED])
}

/// What tables must suit that serve all instances of a mesh: the geometric mean of their texels, and
/// the range of curvature against the texel.
fn surface(
    mesh: &Mesh,
    frames: &[VertexFrame],
    height: &HeightRef,
    size: [u32; 2],
    placements: &[Mat4],
) -> horizon_shadow::Surface {
    let (mut logarithms, mut least, mut greatest) = (0.0, f32::INFINITY, f32::NEG_INFINITY);
    for placement in placements {
        let positions: Vec<[f32; 3]> =
            mesh.positions.iter().map(|&position| placement.transform_point3(position).to_array()).collect();
        let frames: Vec<VertexFrame> = frames
            .iter()
            .zip(&mesh.normals)
            .map(|(frame, &normal)| placed(frame, normal, *placement))
            .collect();
        let one = frames::surface(&positions, &frames, &mesh.triangles, size, height.uv_scale);
        logarithms += one.texel_m.ln();
        least = least.min(one.curvature_per_m[0] * one.texel_m);
        greatest = greatest.max(one.curvature_per_m[1] * one.texel_m);
    }
    let texel_m = (logarithms / placements.len().max(1) as f32).exp();
    horizon_shadow::Surface { texel_m, curvature_per_m: [least, greatest].map(|value| value / texel_m) }
}

/// A frame in the world.
fn placed(frame: &VertexFrame, normal: Vec3, world_from_local: Mat4) -> VertexFrame {
    let vector = |along: [f32; 3]| world_from_local.transform_vector3(Vec3::from(along)).to_array();
    let matrix = Mat3::from_mat4(world_from_local);
    let determinant = matrix.determinant();
    let stretch = (matrix.inverse().transpose() * normal.normalize_or(Vec3::Y)).length();
    let stretch = if determinant != 0.0 && stretch.is_finite() { stretch } else { f32::INFINITY };
    VertexFrame {
        along_u: vector(frame.along_u),
        along_v: vector(frame.along_v),
        second_form: frame.second_form.map(|value| value / stretch),
    }
}
