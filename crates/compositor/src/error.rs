//! What a correct caller can meet.

/// Why a scene was not uploaded or a frame not recorded.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Error {
    /// The picture has no pixels, or more than can be rendered.
    #[error(
        "picture size: found {width} x {height}, expected sides of 1 to {limit} and at most {pixels} pixels"
    )]
    Size {
        /// Pixels per row asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
        /// The longest side that the device allows.
        limit: u32,
        /// The most pixels, [`MAX_PIXELS`](crate::MAX_PIXELS).
        pixels: u64,
    },
    /// The camera describes no view.
    #[error("camera: {what}: found {found}, expected {expected}")]
    Camera {
        /// The quantity.
        what: &'static str,
        /// Its value.
        found: String,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// The scene is inconsistent: an index out of range, lists of different lengths, a position
    /// that is not finite.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// The device refused an upload, or memory ran out.
    #[error(transparent)]
    Gpu(#[from] gpu_context::Error),
    /// The technique refused what it was lent.
    #[error(transparent)]
    DiffuseEnvmap(#[from] diffuse_envmap::Error),
    /// The technique refused what it was lent.
    #[error(transparent)]
    HorizonShadow(#[from] horizon_shadow::Error),
}
