//! Directions, sampling and means of environments.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};
use proptest::prelude::*;
use scene::Environment;

/// A map whose texel of a column and row is (column, row, 1).
fn numbered(width: u32, height: u32) -> Environment {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x as f32, y as f32, 1.0])).collect();
    Environment::new("numbered", width, height, pixels).unwrap()
}

/// The direction of a texel's centre.
fn texel_direction(environment: &Environment, column: u32, row: u32) -> Vec3 {
    let u = (column as f32 + 0.5) / environment.width as f32;
    Environment::direction_of(u, (row as f32 + 0.5) / environment.height as f32)
}

#[test]
fn axes_lie_where_the_convention_puts_them() {
    for (direction, u, v) in [
        (Vec3::X, 0.5, 0.5),
        (Vec3::Z, 0.75, 0.5),
        (Vec3::NEG_Z, 0.25, 0.5),
        (Vec3::new(-1.0, 0.0, 1e-9), 1.0, 0.5),
        (Vec3::new(-1.0, 0.0, -1e-9), 0.0, 0.5),
    ] {
        let found = Environment::uv_of(direction);
        assert!((found[0] - u).abs() < 1e-6 && (found[1] - v).abs() < 1e-6, "{direction}: {found:?}");
        assert!((Environment::direction_of(u, v) - direction).length() < 1e-6, "{direction}");
    }
    assert_eq!(Environment::uv_of(Vec3::Y)[1], 0.0);
    assert_eq!(Environment::uv_of(Vec3::NEG_Y)[1], 1.0);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn directions_and_uv_are_inverse(u in 0.0_f32..1.0, v in 0.001_f32..0.999) {
        let [u_back, v_back] = Environment::uv_of(Environment::direction_of(u, v));
        let across = (u_back - u).abs();
        prop_assert!(across.min(1.0 - across) < 1e-4 && (v_back - v).abs() < 1e-4, "{u_back} {v_back}");
    }
}

#[test]
fn sampling_is_exact_at_texel_centres_and_bilinear_between() {
    let map = numbered(16, 8);
    for (column, row) in [(0, 0), (15, 7), (3, 4), (8, 1)] {
        let found = map.sample(texel_direction(&map, column, row));
        assert!((found - Vec3::new(column as f32, row as f32, 1.0)).length() < 1e-4, "{found}");
    }
    let found = map.sample(Environment::direction_of(4.75 / 16.0, 3.1 / 8.0));
    assert!((found - Vec3::new(4.25, 2.6, 1.0)).length() < 1e-4, "{found}");
}

#[test]
fn columns_wrap_and_rows_are_clamped() {
    let map = numbered(16, 8);
    // On the seam, half way between the last and the first column.
    let seam = map.sample(Environment::direction_of(0.0, 0.5));
    assert!((seam.x - 7.5).abs() < 1e-3, "{seam}");
    assert!((map.sample(Environment::direction_of(1.0 / 64.0, 0.5)).x - 3.75).abs() < 1e-3);
    assert!((map.sample(Vec3::Y).y, map.sample(Vec3::NEG_Y).y) == (0.0, 7.0));
    let tiny = numbered(1, 1);
    assert_eq!(tiny.sample(Vec3::new(0.6, 0.0, 0.8)), Vec3::new(0.0, 0.0, 1.0));
}

/// Seen from above (+X right, +Z down the page), a turn of +90 degrees takes +X to -Z.
#[test]
fn rotation_turns_the_map_counter_clockwise_seen_from_above() {
    let mut map = numbered(64, 32);
    map.rotation_rad = FRAC_PI_2;
    map.intensity = 2.0;
    let own = map.sample(Vec3::X);
    assert!((map.radiance_world(Vec3::NEG_Z) - own * 2.0).length() < 1e-3);
    let direction = Vec3::new(0.3, 0.5, -0.7).normalize();
    let turned = Quat::from_rotation_y(map.rotation_rad) * direction;
    assert!((map.radiance_world(turned) - map.sample(direction) * 2.0).length() < 1e-3);
}

#[test]
fn means_are_weighted_by_solid_angle() {
    let of_rows = |radiance: &dyn Fn(f32) -> f32| {
        let (width, height) = (64, 256_u32);
        let rows = (0..height).map(|row| radiance(PI * (row as f32 + 0.5) / height as f32));
        let pixels = rows.flat_map(|value| vec![[value; 3]; width as usize]).collect();
        Environment::new("rows", width, height, pixels).unwrap().mean_radiance().x
    };
    assert!((of_rows(&|_| 3.0) - 3.0).abs() < 1e-5);
    assert!((of_rows(&|polar| f32::from(polar < FRAC_PI_2)) - 0.5).abs() < 1e-5);
    assert!((of_rows(&|polar| polar.cos().powi(2)) - 1.0 / 3.0).abs() < 1e-4);
    // Three texels of a map of 1024 x 512 hold far less of the sphere at the pole than elsewhere.
    let map = numbered(16, 8);
    let whole: f32 = (0..8).map(|row| 16.0 * map.texel_solid_angle(row)).sum();
    assert!((whole - 4.0 * PI).abs() < 1e-4);
}

#[test]
fn sizes_that_do_not_fit_are_refused() {
    for (width, height, count) in [(0, 0, 0), (2, 2, 3), (2, 2, 5), (0, 4, 4), (u32::MAX, u32::MAX, 1)] {
        let result = Environment::new("made", width, height, vec![[0.0; 3]; count]);
        assert!(result.is_err(), "{width} x {height}");
    }
}
