//! Camera matrices.

use glam::{Mat3, Mat4, Vec3, Vec4Swizzles};
use proptest::prelude::*;
use scene::Camera;

const CAMERA: Camera =
    Camera { eye: Vec3::new(3.0, 2.0, 5.0), target: Vec3::new(0.0, 1.0, 0.0), up: Vec3::Y, fov_y_rad: 0.8 };

/// Normalised device x and y, and depth.
fn project(clip_from_world: Mat4, point: Vec3) -> Vec3 {
    let clip = clip_from_world * point.extend(1.0);
    clip.xyz() / clip.w
}

#[test]
fn the_target_is_in_the_middle_and_up_is_up() {
    let clip_from_world = CAMERA.clip_from_world(1.5, 0.1);
    assert!(project(clip_from_world, CAMERA.target).truncate().length() < 1e-6);
    assert!(project(clip_from_world, CAMERA.target + Vec3::Y * 0.1).y > 0.0);
    let right = (CAMERA.target - CAMERA.eye).cross(Vec3::Y);
    assert!(project(clip_from_world, CAMERA.target + right * 0.1).x > 0.0);
}

#[test]
fn the_field_of_view_and_aspect_bound_the_picture() {
    let clip_from_world = CAMERA.clip_from_world(1.5, 0.1);
    let half_height = (CAMERA.fov_y_rad / 2.0).tan();
    for (x, y) in [(1.0, 1.0), (-1.0, 0.5), (0.25, -1.0)] {
        let view = Vec3::new(x * 1.5 * half_height, y * half_height, -1.0) * 7.0;
        let found = project(clip_from_world, CAMERA.world_from_view().transform_point3(view));
        assert!((found.truncate() - glam::Vec2::new(x, y)).length() < 1e-5, "{found}");
    }
}

#[test]
fn depth_is_near_over_distance() {
    let clip_from_world = CAMERA.clip_from_world(1.0, 0.25);
    for distance in [0.25, 1.0, 8.0, 1e6] {
        let point = CAMERA.world_from_view().transform_point3(Vec3::NEG_Z * distance);
        let depth = project(clip_from_world, point).z;
        assert!((depth / (0.25 / distance) - 1.0).abs() < 1e-4, "{distance}: {depth}");
    }
    assert!(CAMERA.near_m() > 0.0 && CAMERA.near_m() < 0.01);
}

#[test]
fn looking_straight_down_north_is_up() {
    let camera = Camera { target: CAMERA.eye - Vec3::Y, ..CAMERA };
    let north = project(camera.clip_from_world(1.0, 0.1), camera.target + Vec3::NEG_Z * 0.1);
    assert!(north.x.abs() < 1e-6 && north.y > 0.0, "{north}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Also where up is parallel to the view or zero, and the target is the eye.
    #[test]
    fn view_matrices_are_rigid_and_inverse(
        eye in prop::array::uniform3(-1e3_f32..1e3),
        toward in prop_oneof![
            prop::array::uniform3(-1.0_f32..1.0),
            Just([0.0, 0.0, 0.0]),
            Just([0.0, 1.0, 0.0]),
            Just([1e-7, -1.0, 0.0]),
            Just([1e-20, 0.0, 1e-20]),
        ],
        up in prop_oneof![
            Just([0.0, 1.0, 0.0]),
            Just([0.0, 0.0, 0.0]),
            Just([0.0, -5.0, 1e-8]),
            Just([f32::NAN, 1.0, 0.0]),
            prop::array::uniform3(-1.0_f32..1.0),
        ],
    ) {
        let eye = Vec3::from(eye);
        let camera = Camera { eye, target: eye + Vec3::from(toward), up: Vec3::from(up), fov_y_rad: 1.0 };
        let world_from_view = camera.world_from_view();
        let rotation = Mat3::from_mat4(world_from_view);
        prop_assert!((rotation.transpose() * rotation).abs_diff_eq(Mat3::IDENTITY, 1e-5), "{rotation}");
        prop_assert!((rotation.determinant() - 1.0).abs() < 1e-5);
        let identity = camera.view_from_world() * world_from_view;
        prop_assert!(identity.abs_diff_eq(Mat4::IDENTITY, 1e-3), "{identity}");
        prop_assert!(camera.clip_from_world(1.0, camera.near_m()).is_finite());
    }
}
