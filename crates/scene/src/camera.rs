//! The pinhole camera.

use glam::{Mat3, Mat4, Vec3, Vec4};

use crate::mesh::unit;

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

impl Camera {
    /// World from view space, where the camera looks along -Z with +X to the right and +Y up.
    ///
    /// Always a rotation and a translation: a target at the eye counts as one along -Z, and an
    /// up direction along the view is replaced by one across it.
    pub fn world_from_view(&self) -> Mat4 {
        let back = unit(self.eye - self.target).unwrap_or(Vec3::Z);
        let across = |up: Vec3| {
            let right = unit(up)?.cross(back);
            // Nearly parallel directions leave only rounding errors behind.
            (right.length_squared() > 1e-10).then(|| right.normalize())
        };
        // Looking straight up or down, north (-Z) is up in the picture.
        let right =
            across(self.up).or_else(|| across(Vec3::Y)).or_else(|| across(Vec3::NEG_Z)).unwrap_or(Vec3::X);
        let up = back.cross(right);
        Mat4::from_cols(right.extend(0.0), up.extend(0.0), back.extend(0.0), self.eye.extend(1.0))
    }

    /// View from world space; the inverse of [`Camera::world_from_view`].
    pub fn view_from_world(&self) -> Mat4 {
        let view_from_world = Mat3::from_mat4(self.world_from_view()).transpose();
        Mat4::from_mat3_translation(view_from_world, view_from_world * -self.eye)
    }

    /// Clip from world space for a picture of `aspect` = width / height.
    ///
    /// Depth is reversed with the far plane at infinity: depth = near / distance along the view
    /// axis, 1 at the near plane and 0 at infinity. `near_m` is in metres, above 0; see
    /// [`Camera::near_m`] for one that suits.
    pub fn clip_from_world(&self, aspect: f32, near_m: f32) -> Mat4 {
        let scale_y = (self.fov_y_rad / 2.0).tan().recip();
        let clip_from_view =
            Mat4::from_cols(Vec4::X * (scale_y / aspect), Vec4::Y * scale_y, Vec4::NEG_W, Vec4::Z * near_m);
        clip_from_view * self.view_from_world()
    }

    /// A near plane that cuts nothing the camera is meant to show: a thousandth of the distance
    /// from eye to target, in metres. With reversed float depth a near plane so close costs no
    /// precision.
    pub fn near_m(&self) -> f32 {
        (self.eye.distance(self.target) * 1e-3).clamp(1e-6, 1e6)
    }
}
