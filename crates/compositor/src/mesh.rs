//! Meshes as vertex and index buffers.

use crate::{Error, vertices::Vertex};
use glam::{Vec2, Vec3, Vec4};
use gpu_context::Gpu;
use scene::Mesh;

/// A mesh on the GPU.
#[derive(Debug)]
pub(crate) struct MeshGpu {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) index_count: u32,
}

impl MeshGpu {
    /// Uploads a mesh after checking it; `place` names it in errors. `None` where it has no
    /// triangles.
    pub(crate) fn new(gpu: &Gpu, file: &str, place: &str, mesh: &Mesh) -> Result<Option<Self>, Error> {
        check(file, place, mesh)?;
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        let vertices: Vec<Vertex> = (0..mesh.positions.len()).map(|index| vertex(mesh, index)).collect();
        Ok(Some(Self::of(gpu, place, bytemuck::cast_slice(&vertices), &mesh.triangles)?))
    }

    /// Vertices of any kind, and the triangles between them.
    pub(crate) fn of(gpu: &Gpu, place: &str, vertices: &[u8], triangles: &[[u32; 3]]) -> Result<Self, Error> {
        Ok(Self {
            vertices: buffer(gpu, place, wgpu::BufferUsages::VERTEX, vertices)?,
            indices: buffer(gpu, place, wgpu::BufferUsages::INDEX, bytemuck::cast_slice(triangles))?,
            index_count: (triangles.len() * 3) as u32,
        })
    }
}

/// A buffer with these bytes; [`gpu_context::Error::Limit`] where it would be too large.
pub(crate) fn buffer(
    gpu: &Gpu,
    label: &str,
    usage: wgpu::BufferUsages,
    bytes: &[u8],
) -> Result<wgpu::Buffer, gpu_context::Error> {
    let (found, limit) = (bytes.len() as u64, gpu.device().limits().max_buffer_size);
    if found > limit {
        return Err(gpu_context::Error::Limit { what: format!("bytes of {label}"), found, limit });
    }
    gpu.checked(label, |device| {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: found.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue().write_buffer(&buffer, 0, bytes);
        buffer
    })
}

fn vertex(mesh: &Mesh, index: usize) -> Vertex {
    let uv = mesh.uvs.get(index).copied().filter(|uv| uv.is_finite()).unwrap_or(Vec2::ZERO);
    // Vectors that are not finite become 0, for which the shader has a fallback.
    let tangent = mesh.tangents.get(index).copied().filter(|tangent| tangent.is_finite());
    let normal = mesh.normals.get(index).copied().filter(|normal| normal.is_finite());
    Vertex {
        position: mesh.positions.get(index).copied().unwrap_or(Vec3::ZERO).to_array(),
        normal: normal.unwrap_or(Vec3::ZERO).to_array(),
        tangent: tangent.unwrap_or(Vec4::ZERO).to_array(),
        uv: uv.to_array(),
    }
}

/// What a mesh made by hand can get wrong and the GPU would not notice.
fn check(file: &str, place: &str, mesh: &Mesh) -> Result<(), scene::Error> {
    let refuse =
        |place: String, found: String, expected: String| scene::Error::new(file, place, found, expected);
    let count = mesh.positions.len();
    let lists = [
        ("normals", mesh.normals.len(), false),
        ("tangents", mesh.tangents.len(), true),
        ("uvs", mesh.uvs.len(), true),
    ];
    for (list, found, may_be_empty) in lists {
        if found != count && !(may_be_empty && found == 0) {
            let expected = format!("{count}, as there are positions");
            return Err(refuse(format!("{place}: {list}"), found.to_string(), expected));
        }
    }
    if let Some(index) = mesh.positions.iter().position(|position| !position.is_finite()) {
        let found = mesh.positions.get(index).map_or_else(String::new, ToString::to_string);
        return Err(refuse(format!("{place}: position {index}"), found, "finite metres".into()));
    }
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        if triangle.iter().any(|&corner| corner as usize >= count) {
            let expected = format!("indices below {count}");
            return Err(refuse(format!("{place}: triangle {index}"), format!("{triangle:?}"), expected));
        }
    }
    if mesh.triangles.len() > (u32::MAX / 3) as usize {
        let found = mesh.triangles.len().to_string();
        return Err(refuse(format!("{place}: triangles"), found, format!("at most {}", u32::MAX / 3)));
    }
    Ok(())
}
