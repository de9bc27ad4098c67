//! The camera as matrices, in closed form.

use crate::Error;
use glam::{Mat4, Vec3, Vec4};
use scene::Camera;

/// A camera for one picture size: right-handed, depth reversed (1 at the near plane, 0 infinitely
/// far), y up in clip space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Clip space from the world.
    pub clip_from_world: Mat4,
    /// Its inverse. Applied to (x, y, 0, 1) it gives the direction of a pixel, one unit long along
    /// the view axis.
    pub world_from_clip: Mat4,
    /// The eye in metres.
    pub eye_world: Vec3,
    /// Distance of the near plane in metres; depth is `near_m` over the distance along the axis.
    pub near_m: f32,
}

/// A sphere around everything that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Centre in metres.
    pub center_world: Vec3,
    /// Radius in metres, at least 0.
    pub radius_m: f32,
}

impl View {
    /// The view of a camera onto a picture of `size` pixels.
    ///
    /// The near plane follows from what is drawn: reversed depth in floats has the same relative
    /// precision at every distance, so it only has to lie before everything worth seeing.
    /// [`Error::Camera`] for values that are not finite and a field of view outside 0 .. pi.
    pub fn new(camera: &Camera, size: [u32; 2], bounds: Option<Bounds>) -> Result<Self, Error> {
        check_finite("eye", camera.eye)?;
        check_finite("target", camera.target)?;
        check_finite("up", camera.up)?;
        let fov = camera.fov_y_rad;
        if !(fov > 1e-4 && fov < std::f32::consts::PI - 1e-4) {
            let expected = "radians above 0 and below pi";
            return Err(Error::Camera { what: "vertical field of view", found: fov.to_string(), expected });
        }
        let axes = camera.world_from_view();
        let (right, up, forward) = (axes.x_axis.truncate(), axes.y_axis.truncate(), -axes.z_axis.truncate());
        let near_m = near_plane(camera.eye, bounds);
        let tan_y = (0.5 * fov).tan();
        let tan_x = tan_y * size[0].max(1) as f32 / size[1].max(1) as f32;
        let row = |axis: Vec3, scale: f32| (axis * scale).extend(-scale * dot_precise(axis, camera.eye));
        let (x, y, w) = (row(right, 1.0 / tan_x), row(up, 1.0 / tan_y), row(forward, 1.0));
        Ok(Self {
            clip_from_world: Mat4::from_cols(x, y, Vec4::W * near_m, w).transpose(),
            world_from_clip: Mat4::from_cols(
                (right * tan_x).extend(0.0),
                (up * tan_y).extend(0.0),
                (camera.eye / near_m).extend(1.0 / near_m),
                forward.extend(0.0),
            ),
            eye_world: camera.eye,
            near_m,
        })
    }
}

fn check_finite(what: &'static str, vector: Vec3) -> Result<(), Error> {
    // Far above any scene, and far below where squares overflow.
    if vector.is_finite() && vector.abs().max_element() < 1e15 {
        return Ok(());
    }
    Err(Error::Camera { what, found: vector.to_string(), expected: "finite metres below 1e15" })
}

/// The dot product in f64, because an eye far from the origin cancels most of its digits.
fn dot_precise(a: Vec3, b: Vec3) -> f32 {
    a.to_array().iter().zip(b.to_array()).map(|(&a, b)| f64::from(a) * f64::from(b)).sum::<f64>() as f32
}

fn near_plane(eye: Vec3, bounds: Option<Bounds>) -> f32 {
    let Some(bounds) = bounds else { return 0.01 };
    let gap = eye.distance(bounds.center_world) - bounds.radius_m;
    (1e-3 * gap).max(1e-5 * bounds.radius_m).max(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let (eye, target) = (Vec3::new(3.0, -2.0, 5.0), Vec3::new(0.5, 1.0, -1.0));
        Camera { eye, target, up: Vec3::new(0.1, 2.0, 0.3), fov_y_rad: 0.7 }
    }

    #[test]
    fn matrices_are_inverse_and_depth_is_reversed() {
        let bounds = Bounds { center_world: Vec3::ZERO, radius_m: 2.0 };
        let view = View::new(&camera(), [300, 200], Some(bounds)).unwrap();
        let product = view.clip_from_world * view.world_from_clip;
        // Entries of the third column carry 1 / near_m.
        assert!((product - Mat4::IDENTITY).to_cols_array().iter().all(|x| x.abs() < 1e-3), "{product}");

        let forward = (camera().target - camera().eye).normalize();
        for distance in [view.near_m, 1.0, 1000.0] {
            let clip = view.clip_from_world * (camera().eye + forward * distance).extend(1.0);
            assert!(
                (clip.w / distance - 1.0).abs() < 1e-2 && clip.x.abs() < 1e-3 * clip.w.max(1.0),
                "{clip}"
            );
            assert!((clip.z - view.near_m).abs() < 1e-9);
        }
        let target = view.clip_from_world.project_point3(camera().target);
        assert!(target.x.abs() < 1e-5 && target.y.abs() < 1e-5);
    }

    #[test]
    fn up_is_up_and_right_is_right() {
        let camera = Camera { eye: Vec3::Z * 4.0, target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 1.0 };
        let view = View::new(&camera, [100, 100], None).unwrap();
        let corner = view.clip_from_world.project_point3(Vec3::new(1.0, 1.0, 0.0));
        assert!(corner.x > 0.0 && corner.y > 0.0 && (corner.x - corner.y).abs() < 1e-6);
    }

    #[test]
    fn a_camera_without_a_view_is_refused() {
        let bad = [
            Camera { eye: Vec3::splat(f32::NAN), ..camera() },
            Camera { target: Vec3::X * f32::INFINITY, ..camera() },
            Camera { up: Vec3::splat(f32::NAN), ..camera() },
            Camera { fov_y_rad: 0.0, ..camera() },
            Camera { fov_y_rad: 4.0, ..camera() },
            Camera { fov_y_rad: f32::NAN, ..camera() },
        ];
        for camera in bad {
            assert!(matches!(View::new(&camera, [8, 8], None), Err(Error::Camera { .. })), "{camera:?}");
        }
    }
}
