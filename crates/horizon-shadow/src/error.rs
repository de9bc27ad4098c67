//! What a correct caller of horizon-shadow can meet.

/// Why a call failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The device refused or lacks something.
    #[error("horizon-shadow: {0}")]
    Gpu(#[from] gpu_context::Error),
    /// A number is out of its range.
    #[error("horizon-shadow: {what} is {found}; expected {expected}")]
    Value {
        /// Which number.
        what: &'static str,
        /// Its value.
        found: String,
        /// The range.
        expected: String,
    },
    /// The height map's view cannot be read as one map of numbers.
    #[error("horizon-shadow: the height map's {what} is {found}; expected {expected}")]
    HeightMap {
        /// What does not fit.
        what: &'static str,
        /// What was lent.
        found: String,
        /// What can be read.
        expected: &'static str,
    },
    /// The visibility pass cannot write to the target.
    #[error(
        "horizon-shadow: target format {format:?} cannot hold the visibility of four lights; use Rgba8Unorm or \
         Rgba16Float"
    )]
    Target {
        /// The target's format.
        format: wgpu::TextureFormat,
    },
    /// A mesh has no texture coordinates, so nobody can say where its height map lies.
    #[error(
        "horizon-shadow: the mesh has {positions} positions and {uvs} texture coordinates; a height map needs one for each"
    )]
    NoUvs {
        /// Vertices.
        positions: usize,
        /// Texture coordinates.
        uvs: usize,
    },
    /// The bake was asked to stop.
    #[error("horizon-shadow: the bake was cancelled after {done} of {total} azimuths")]
    Cancelled {
        /// Azimuths finished.
        done: u32,
        /// Azimuths asked for.
        total: u32,
    },
}
