//! What a correct caller of diffuse-envmap can meet.

/// Why a call failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The device refused or lacks something.
    #[error("diffuse-envmap: {0}")]
    Gpu(#[from] gpu_context::Error),
    /// The target cannot be added to.
    #[error("diffuse-envmap: target format {format:?} cannot be blended; use Rgba16Float")]
    Target {
        /// The target's format.
        format: wgpu::TextureFormat,
    },
    /// The environment's format cannot be sampled between texels on this device.
    #[error(
        "diffuse-envmap: environment format {format:?} cannot be filtered on this device; use Rgba16Float, \
         or request the feature FLOAT32_FILTERABLE"
    )]
    Environment {
        /// The environment's format.
        format: wgpu::TextureFormat,
    },
    /// The surface buffer's textures differ in size.
    #[error(
        "diffuse-envmap: the surface buffer's {part} has {found:?} pixels, its depth {expected:?}; make them alike"
    )]
    Surface {
        /// Which texture differs.
        part: &'static str,
        /// Its width and height.
        found: [u32; 2],
        /// The depth's width and height.
        expected: [u32; 2],
    },
}
