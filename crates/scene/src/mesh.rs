//! Triangle meshes and their placement.

use glam::{Mat4, Vec2, Vec3, Vec4};

/// An indexed triangle mesh in local space. All vertex arrays have the same length, except
/// that `uvs` and `tangents` are empty where the surface has no texture coordinates.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The mesh's name in its file, or the shape's name.
    pub name: String,
    /// Vertex positions in metres.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals.
    pub normals: Vec<Vec3>,
    /// Unit tangents along +u in `xyz`, and the sign of the bitangent in `w`
    /// (bitangent = w * cross(normal, tangent)), as in glTF.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates; (0, 0) is the first texel of the first row.
    pub uvs: Vec<Vec2>,
    /// Counter-clockwise corners, as indices into the vertex arrays.
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh with a material, placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The node's name.
    pub name: String,
    /// Index into `Scene::meshes`.
    pub mesh: usize,
    /// Index into `Scene::materials`.
    pub material: usize,
    /// World from local space; affine, and possibly mirroring.
    pub world_from_local: Mat4,
}
