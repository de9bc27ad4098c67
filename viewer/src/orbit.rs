//! A camera that circles a point. It never rolls, and stops short of the poles.

use glam::{Quat, Vec3};
use scene::Camera;
use std::f32::consts::{FRAC_PI_2, TAU};

/// How near to straight up or down the camera may look, radians.
const POLE_GAP_RAD: f32 = 0.002;

/// Where the camera is, as seen from what it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Orbit {
    /// The point in the middle of the picture, metres.
    pub(crate) target: Vec3,
    /// From the target to the eye, metres, above 0.
    distance_m: f32,
    /// Angle of the eye about +Y, 0 towards +Z, growing towards +X.
    azimuth_rad: f32,
    /// Angle of the eye above the horizontal plane.
    elevation_rad: f32,
    /// Full vertical field of view.
    fov_y_rad: f32,
}

impl Orbit {
    /// The orbit on which a camera lies; a roll is lost.
    pub(crate) fn of_camera(camera: &Camera) -> Self {
        let from_target = camera.eye - camera.target;
        let horizontal = from_target.x.hypot(from_target.z);
        let mut orbit = Self {
            target: camera.target,
            distance_m: from_target.length().max(1e-6),
            azimuth_rad: from_target.x.atan2(from_target.z),
            elevation_rad: from_target.y.atan2(horizontal),
            fov_y_rad: camera.fov_y_rad,
        };
        orbit.turn(0.0, 0.0);
        orbit
    }

    pub(crate) fn camera(&self) -> Camera {
        let eye = self.target + self.rotation() * Vec3::Z * self.distance_m;
        Camera { eye, target: self.target, up: Vec3::Y, fov_y_rad: self.fov_y_rad }
    }

    /// Moves the eye around the target: to the right and upwards for positive angles in radians.
    pub(crate) fn turn(&mut self, right_rad: f32, up_rad: f32) {
        let limit = FRAC_PI_2 - POLE_GAP_RAD;
        self.azimuth_rad = (self.azimuth_rad + right_rad).rem_euclid(TAU);
        self.elevation_rad = (self.elevation_rad + up_rad).clamp(-limit, limit);
    }

    /// Moves eye and target across the view, by fractions of the picture's height.
    pub(crate) fn pan(&mut self, right: f32, up: f32) {
        let height_m = 2.0 * self.distance_m * (0.5 * self.fov_y_rad).tan();
        self.target += self.rotation() * Vec3::new(right, up, 0.0) * height_m;
    }

    /// Multiplies the distance, within what makes sense for a scene of this radius.
    pub(crate) fn zoom(&mut self, factor: f32, scene_radius_m: f32) {
        let radius = scene_radius_m.max(1e-6);
        let (least, greatest) = ((1e-3 * radius).min(self.distance_m), (1e3 * radius).max(self.distance_m));
        self.distance_m = (self.distance_m * factor).clamp(least, greatest);
    }

    /// Goes to the target and distance of another camera, and keeps looking in the same direction.
    pub(crate) fn approach(&mut self, framing: &Camera) {
        self.target = framing.target;
        self.distance_m = framing.eye.distance(framing.target).max(1e-6);
    }

    /// World from view space.
    fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.azimuth_rad) * Quat::from_rotation_x(-self.elevation_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: Vec3::new(3.0, 2.0, -4.0),
            target: Vec3::new(0.5, 0.5, 0.5),
            up: Vec3::Y,
            fov_y_rad: 0.6,
        }
    }

    fn close(a: Vec3, b: Vec3) -> bool {
        a.distance(b) < 1e-4
    }

    #[test]
    fn a_camera_comes_back_as_it_was() {
        let back = Orbit::of_camera(&camera()).camera();
        assert!(close(back.eye, camera().eye), "{back:?}");
        assert_eq!((back.target, back.fov_y_rad), (camera().target, camera().fov_y_rad));
    }

    #[test]
    fn turning_right_moves_the_eye_to_its_right() {
        let front = Camera { eye: Vec3::Z * 2.0, target: Vec3::ZERO, ..camera() };
        let mut orbit = Orbit::of_camera(&front);
        orbit.turn(FRAC_PI_2, 0.0);
        assert!(close(orbit.camera().eye, Vec3::X * 2.0), "{:?}", orbit.camera().eye);
        orbit.turn(0.0, 0.3);
        assert!(orbit.camera().eye.y > 0.5);
    }

    #[test]
    fn the_poles_are_never_crossed() {
        for up in [1.0, -1.0] {
            let mut orbit = Orbit::of_camera(&camera());
            let mut last = orbit.camera().eye.y;
            for _ in 0..200 {
                orbit.turn(0.0, 0.05 * up);
                let eye = orbit.camera().eye;
                assert!((eye.y - last) * up >= -1e-5, "the eye turned back");
                last = eye.y;
            }
            let (right, before) =
                (orbit.camera().world_from_view().x_axis, camera().world_from_view().x_axis);
            assert!(right.dot(before) > 0.999, "the picture flipped: {right} {before}");
        }
        let above = Camera { eye: Vec3::Y * 3.0, target: Vec3::ZERO, ..camera() };
        assert!(Orbit::of_camera(&above).camera().eye.is_finite());
    }

    #[test]
    fn panning_by_the_height_moves_the_target_to_the_edge() {
        let mut orbit = Orbit::of_camera(&camera());
        let before = orbit.camera();
        orbit.pan(0.0, 0.5);
        let clip = before.clip_from_world(1.0, 0.1).project_point3(orbit.target);
        assert!((clip.y - 1.0).abs() < 1e-4 && clip.x.abs() < 1e-4, "{clip}");
        assert!(close(orbit.camera().eye - orbit.target, before.eye - before.target));
    }

    #[test]
    fn zoom_stays_within_reach_and_comes_back() {
        let mut orbit = Orbit::of_camera(&camera());
        let distance = |orbit: &Orbit| orbit.camera().eye.distance(orbit.target);
        let start = distance(&orbit);
        orbit.zoom(0.5, 1.0);
        assert!((distance(&orbit) / start - 0.5).abs() < 1e-3);
        for (factor, limit) in [(1e-9, 1e-3), (1e30, 1e3)] {
            orbit.zoom(factor, 1.0);
            assert!((distance(&orbit) / limit - 1.0).abs() < 1e-2, "{}", distance(&orbit));
        }
        orbit.approach(&camera());
        assert!((distance(&orbit) / start - 1.0).abs() < 1e-3);
    }

    #[test]
    fn many_turns_lose_no_precision() {
        let mut orbit = Orbit::of_camera(&camera());
        for _ in 0..100_000 {
            orbit.turn(TAU / 4.0, 0.0);
        }
        assert!(orbit.azimuth_rad < TAU && orbit.camera().eye.is_finite());
    }
}
