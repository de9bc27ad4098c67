//! The pinhole camera.

use glam::Vec3;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position in metres.
    pub eye: Vec3,
    /// The point in the middle of the picture; not the eye.
    pub target: Vec3,
    /// Upward direction, not parallel to the view; need not be unit length.
    pub up: Vec3,
    /// Full vertical field of view in radians, above 0 and below pi.
    pub fov_y_rad: f32,
}
