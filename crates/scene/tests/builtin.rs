//! Built-in environments and the built-in scene.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use scene::{Environment, builtin};

/// Sum of radiance times solid angle over the texels that `choose` takes by direction.
fn light(environment: &Environment, choose: impl Fn(Vec3) -> bool) -> Vec3 {
    let (width, height) = (environment.width, environment.height);
    let mut sum = Vec3::ZERO;
    for (index, pixel) in environment.pixels.iter().enumerate() {
        let (column, row) = (index as u32 % width, index as u32 / width);
        let u = (column as f32 + 0.5) / width as f32;
        if choose(Environment::direction_of(u, (row as f32 + 0.5) / height as f32)) {
            sum += Vec3::from(*pixel) * environment.texel_solid_angle(row);
        }
    }
    sum
}

/// The largest channel value and its direction.
fn peak(environment: &Environment) -> (f32, Vec3) {
    let brightest = |pixel: &[f32; 3]| pixel.iter().copied().fold(0.0, f32::max);
    let values = environment.pixels.iter().map(brightest).enumerate();
    let (index, value) = values.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let (column, row) = (index as u32 % environment.width, index as u32 / environment.width);
    let u = (column as f32 + 0.5) / environment.width as f32;
    (value, Environment::direction_of(u, (row as f32 + 0.5) / environment.height as f32))
}

#[test]
fn environments_are_well_formed_at_every_size() {
    for name in builtin::ENVIRONMENT_NAMES {
        for (width, expected) in [(0, 16), (33, 34), (256, 256), (1000, 1000)] {
            let environment = builtin::environment_sized(name, width).unwrap();
            assert_eq!((environment.width, environment.height), (expected, expected / 2));
            assert_eq!(environment.repairs.total(), 0, "{name}");
            assert!(environment.pixels.as_flattened().iter().all(|value| value.is_finite() && *value > 0.0));
        }
    }
    assert!(builtin::environment("moon").is_none());
    let default = builtin::environment("sky").unwrap();
    assert_eq!((default.width, default.height, default.name.as_str()), (1024, 512, "sky"));
}

/// Small lights are spread over texels, so the mean does not depend on the size.
#[test]
fn light_does_not_depend_on_the_resolution() {
    for name in builtin::ENVIRONMENT_NAMES {
        let [small, large] =
            [128, 1024].map(|width| builtin::environment_sized(name, width).unwrap().mean_radiance());
        println!("{name}: {small} {large}");
        assert!(((small - large) / large).abs().max_element() < 0.01, "{name}: {small} {large}");
        assert!((0.7..1.6).contains(&large.y), "{name}: {large}");
    }
}

/// A disc of 0.53 degrees and 9.8e4 in green, less than a texel wide at 512 texels.
#[test]
fn the_sun_has_its_whole_light_and_its_place() {
    let solid_angle = TAU * (1.0 - (0.265_f32 * PI / 180.0).cos());
    let (elevation, azimuth) = (38.0_f32.to_radians(), 200.0_f32.to_radians());
    let sun = Vec3::new(elevation.cos() * azimuth.cos(), elevation.sin(), elevation.cos() * azimuth.sin());
    for width in [64, 512, 1024] {
        let sky = builtin::environment_sized("sky", width).unwrap();
        let (value, direction) = peak(&sky);
        let texel_deg = 360.0 / width as f32;
        assert!(direction.angle_between(sun).to_degrees() < 1.5 * texel_deg + 0.3, "{width}: {direction}");
        assert!(value < 1.06e5, "{width}: {value}");
        // The sky within this distance is bright, but thousands of times dimmer than the sun.
        let near = (2.0 * texel_deg + 0.3).to_radians();
        let around = light(&sky, |direction| direction.angle_between(sun) < near).y;
        let ring = light(&sky, |direction| (near..1.5 * near).contains(&direction.angle_between(sun))).y;
        let behind = ring / 1.25;
        println!("{width}: peak {value}, sun {}, behind {behind}", around - behind);
        assert!(((around - behind) / (9.8e4 * solid_angle) - 1.0).abs() < 0.02, "{width}: {}", around - behind);
    }
    let default = builtin::environment("sky").unwrap();
    assert!((2e4..1.06e5).contains(&peak(&default).0), "{}", peak(&default).0);
}

#[test]
fn the_sky_is_blue_above_and_brighter_than_its_ground_is_lit() {
    let sky = builtin::environment("sky").unwrap();
    let zenith = sky.sample(Vec3::Y);
    assert!(zenith.z > 1.2 * zenith.x && zenith.z > 0.1, "{zenith}");
    // Diffuse ground under this light: albedo times irradiance over pi.
    let mut irradiance = Vec3::ZERO;
    for (index, pixel) in sky.pixels.iter().enumerate() {
        let row = index as u32 / sky.width;
        let cos = (PI * (row as f32 + 0.5) / sky.height as f32).cos();
        irradiance += Vec3::from(*pixel) * (sky.texel_solid_angle(row) * cos.max(0.0));
    }
    let albedo = sky.sample(Vec3::NEG_Y) * PI / irradiance;
    assert!((albedo - Vec3::new(0.24, 0.21, 0.17)).abs().max_element() < 0.005, "{albedo}");
}

#[test]
fn the_studio_is_dark_with_small_bright_lights() {
    let studio = builtin::environment("studio").unwrap();
    let mut luminance: Vec<f32> = studio.pixels.iter().map(|pixel| pixel[1]).collect();
    luminance.sort_by(f32::total_cmp);
    let median = luminance[luminance.len() / 2];
    let (value, _) = peak(&studio);
    println!("median {median}, peak {value}");
    assert!(median < 0.5 && (60.0..=120.0).contains(&value), "{median} {value}");
}

#[test]
fn the_built_in_scene_is_whole_and_in_the_picture() {
    let scene = builtin::scene();
    let camera = scene.camera.unwrap();
    let clip_from_world = camera.clip_from_world(16.0 / 9.0, camera.near_m());
    let mut roughness: Vec<f32> = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let material = &scene.materials[instance.material];
        if mesh.name == "plane" {
            continue;
        }
        roughness.extend((mesh.name == "sphere" && material.metallic == 1.0).then_some(material.roughness));
        for position in &mesh.positions {
            let world = instance.world_from_local.transform_point3(*position);
            let clip = clip_from_world * world.extend(1.0);
            assert!(clip.x.abs() < clip.w && clip.y.abs() < clip.w, "{}: {world}", instance.name);
            assert!(world.y > -1e-4, "{} is below the floor", instance.name);
        }
    }
    assert_eq!(roughness, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
    assert_eq!(scene.environment.unwrap().name, "studio");
    assert!(scene.warnings.is_empty());
}
