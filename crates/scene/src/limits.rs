//! How large an input may be, checked before memory is taken for it.

/// Upper bounds on one scene and its files.
///
/// | field | default | what it bounds |
/// |---|---|---|
/// | `file_bytes` | 1 GiB | any one file, before it is read |
/// | `pixels` | 2^27 (16384 x 8192) | any one image, environment or height map |
/// | `texture_bytes` | 2 GiB | all decoded material textures together |
/// | `triangles` | 2^25 | all meshes of a scene together |
/// | `vertices` | 2^25 | all meshes of a scene together |
/// | `nodes` | 2^17 | nodes of a glTF file, objects of a scene file, meshes as placed |
/// | `textures` | 4096 | images of a scene |
/// | `materials` | 65536 | materials of a scene |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of any one file.
    pub file_bytes: u64,
    /// Pixels of any one image.
    pub pixels: u64,
    /// Bytes of all decoded textures.
    pub texture_bytes: u64,
    /// Triangles of a scene.
    pub triangles: u64,
    /// Vertices of a scene.
    pub vertices: u64,
    /// Nodes or objects of a file, and instances of a scene.
    pub nodes: u64,
    /// Images of a scene.
    pub textures: u64,
    /// Materials of a scene.
    pub materials: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 1 << 30,
            pixels: 1 << 27,
            texture_bytes: 2 << 30,
            triangles: 1 << 25,
            vertices: 1 << 25,
            nodes: 1 << 17,
            textures: 4096,
            materials: 1 << 16,
        }
    }
}
