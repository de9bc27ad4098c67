//! Light whose amount is known in closed form, and where the environment stands.

#![allow(clippy::float_cmp, reason = "black is exactly 0")]

mod common;

use std::f32::consts::PI;
use std::ops::ControlFlow;

use common::{add, camera, furnace, lamp, matt, mean, render, settings};
use glam::{Mat4, Vec2, Vec3};
use path_tracer::{Film, PathTracer, Settings};
use scene::{Camera, Environment, Light, Material, Mesh, Scene, shapes};

const ALBEDO: f32 = 0.6;

/// A matt patch at the origin that faces +Y, too small to matter beside what lights it.
fn patch() -> Scene {
    let mut scene = Scene { name: "test".into(), ..Scene::default() };
    add(&mut scene, shapes::plane(1), matt(ALBEDO), Mat4::from_scale(Vec3::splat(1e-3)));
    scene
}

/// A picture of the patch from the side, and no further reflections.
fn look(scene: &Scene, samples: u32) -> Film {
    let camera = Camera { fov_y_rad: 1e-4, ..camera([1.0, 0.7, 0.2], [0.0; 3]) };
    render(scene, &camera, &Settings { max_bounces: 1, ..settings(8, samples) })
}

/// The mean is within four standard errors (or a millionth) of what is expected.
fn assert_mean(film: &Film, expected: f64, what: &str) {
    let (mean, error) = mean(film);
    println!("{what}: {mean:.7} +- {error:.1e}, expected {expected:.7}");
    assert!((mean - expected).abs() < (4.0 * error).max(1e-6 * expected), "{what}");
    assert!(error < 3e-3 * expected, "{what}: too noisy to tell");
}

/// A horizontal disc of triangles around the Y axis that faces down.
fn disc(radius: f32, height: f32, sides: u32) -> (Mesh, f32) {
    let rim = |side: u32| {
        let (sine, cosine) = (2.0 * PI * side as f32 / sides as f32).sin_cos();
        Vec3::new(radius * cosine, height, radius * sine)
    };
    let mut mesh = Mesh { positions: vec![Vec3::new(0.0, height, 0.0)], ..Mesh::default() };
    mesh.positions.extend((0..sides).map(rim));
    mesh.triangles = (0..sides).map(|side| [0, 1 + side, 1 + (side + 1) % sides]).collect();
    mesh.fill_normals();
    let down = mesh.normals[0].y;
    (mesh, down)
}

/// The form factor from a patch to a parallel disc above it is r^2 / (r^2 + h^2).
#[test]
fn a_disc_that_emits_lights_a_patch_by_its_form_factor() {
    for (radius, height) in [(1.0, 0.5), (0.3, 1.0), (5.0, 0.1)] {
        let (mesh, down) = disc(radius, height, 256);
        assert!(down < 0.0);
        let mut scene = patch();
        add(&mut scene, mesh, lamp(3.0), Mat4::IDENTITY);
        let form_factor = f64::from(radius * radius / (radius * radius + height * height));
        assert_mean(
            &look(&scene, 1024),
            f64::from(ALBEDO) * 3.0 * form_factor,
            &format!("disc {radius} {height}"),
        );
    }
}

/// The form factor to a parallel rectangle whose corner is above the patch, four times
/// (Siegel and Howell, configuration factor B-3).
#[test]
fn a_rectangle_that_emits_lights_a_patch_by_its_form_factor() {
    for (half_x, half_z, height) in [(1.0_f64, 0.5_f64, 0.4_f64), (0.2, 0.3, 2.0)] {
        let quarter = |a: f64, b: f64| {
            let (p, q) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
            (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * f64::from(PI))
        };
        let form_factor = 4.0 * quarter(half_x / height, half_z / height);
        let mut scene = patch();
        // Turned over, the plane faces down; a textured one must give the same.
        let place = Mat4::from_translation(Vec3::Y * height as f32)
            * Mat4::from_rotation_x(PI)
            * Mat4::from_scale(Vec3::new(half_x as f32, 1.0, half_z as f32));
        add(&mut scene, shapes::plane(3), lamp(2.0), place);
        assert_mean(&look(&scene, 1024), f64::from(ALBEDO) * 2.0 * form_factor, "rectangle");
        // Its back does not emit, which tells only where the camera does not look onto it.
        if height < 1.0 {
            continue;
        }
        scene.instances[1].world_from_local *= Mat4::from_rotation_x(PI);
        assert_eq!(mean(&look(&scene, 16)).0, 0.0);
    }
}

fn sun(elevation_rad: f32, angular_diameter_rad: f32) -> Light {
    let direction_world = Vec3::new(0.0, elevation_rad.sin(), elevation_rad.cos());
    Light::Directional { direction_world, irradiance: Vec3::splat(2.0), angular_diameter_rad }
}

/// A distant disc above the horizon brings its irradiance times the cosine; of one whose middle is
/// on the horizon, the upper half brings radiance times (a - sin a cos a) for the angular radius a.
#[test]
fn a_distant_disc_lights_a_patch_in_closed_form() {
    for (diameter, elevation) in [(0.0, 0.9), (0.01, 0.9), (0.5, 0.4), (2.0, PI / 2.0), (PI, PI / 2.0)] {
        let mut scene = patch();
        scene.lights.push(sun(elevation, diameter));
        let expected = f64::from(ALBEDO / PI) * 2.0 * f64::from(elevation).sin();
        assert_mean(&look(&scene, 512), expected, &format!("disc of {diameter} at {elevation}"));
    }
    for radius in [0.05_f64, 0.5, 1.5] {
        let mut scene = patch();
        scene.lights.push(sun(0.0, 2.0 * radius as f32));
        let radiance = 2.0 / (f64::from(PI) * radius.sin().powi(2));
        let expected = f64::from(ALBEDO / PI) * radiance * (radius - radius.sin() * radius.cos());
        assert_mean(&look(&scene, 4096), expected, &format!("half a disc of {radius}"));
    }
}

/// A mirror shows the disc with its radiance, and the camera does not see it directly.
#[test]
fn a_distant_disc_is_seen_in_mirrors_only() {
    let mut scene = Scene { name: "test".into(), ..Scene::default() };
    let mirror = Material { metallic: 1.0, roughness: 0.0, ks: Some(Vec3::ONE), ..matt(1.0) };
    add(&mut scene, shapes::plane(1), mirror, Mat4::IDENTITY);
    scene.lights.push(sun(0.5, 0.2));
    let direction = Vec3::new(0.0, 0.5_f32.sin(), 0.5_f32.cos());
    let radiance = 2.0 / (f64::from(PI) * 0.1_f64.sin().powi(2));
    let narrow = |eye: Vec3, target: Vec3| Camera { fov_y_rad: 0.01, ..camera(eye.into(), target.into()) };
    let reflected = direction * Vec3::new(1.0, 1.0, -1.0);
    let (shown, _) = mean(&render(&scene, &narrow(reflected, Vec3::ZERO), &settings(4, 16)));
    assert!((shown / radiance - 1.0).abs() < 1e-6, "{shown} {radiance}");
    let (direct, _) = mean(&render(&scene, &narrow(Vec3::Y, Vec3::Y + direction), &settings(4, 4)));
    assert_eq!(direct, 0.0);
}

#[test]
fn point_and_spot_lights_follow_the_inverse_square_the_cone_and_the_range() {
    let position_world = Vec3::new(0.6, 0.8, 0.0) * 2.0;
    let intensity = Vec3::splat(5.0);
    let facing = f64::from(ALBEDO / PI) * 5.0 * 0.8 / 4.0;
    let shown = |light: Light| {
        let mut scene = patch();
        scene.lights.push(light);
        mean(&look(&scene, 1)).0
    };
    let point = |range| shown(Light::Point { position_world, intensity, range });
    assert!((point(f32::INFINITY) / facing - 1.0).abs() < 1e-5);
    assert!((point(2.01) / facing - 1.0).abs() < 1e-5);
    assert_eq!(point(1.99), 0.0);
    let spot = |off_axis: f32| {
        let direction_world =
            -(Mat4::from_rotation_z(off_axis).transform_vector3(position_world)).normalize();
        let (inner_angle_rad, outer_angle_rad) = (0.3, 0.6);
        let range = f32::INFINITY;
        shown(Light::Spot {
            position_world,
            direction_world,
            intensity,
            range,
            inner_angle_rad,
            outer_angle_rad,
        })
    };
    assert!((spot(0.29) / facing - 1.0).abs() < 1e-5);
    assert_eq!(spot(0.61), 0.0);
    let ramp = (0.45_f64.cos() - 0.6_f64.cos()) / (0.3_f64.cos() - 0.6_f64.cos());
    assert!((spot(0.45) / facing - ramp * ramp).abs() < 1e-4);
}

/// Of many lights only some are looked at from each point, without bias.
#[test]
fn forty_lights_are_as_bright_as_one_of_forty_times_the_strength() {
    let mut scene = patch();
    for index in 0..40 {
        let light = sun(0.2 + 0.03 * index as f32, if index % 2 == 0 { 0.0 } else { 0.1 });
        scene.lights.push(light);
    }
    let sines: f64 = (0..40).map(|index| f64::from(0.2 + 0.03 * index as f32).sin()).sum();
    assert_mean(&look(&scene, 2048), f64::from(ALBEDO / PI) * 2.0 * sines, "forty lights");
}

/// Something between the patch and a light takes all of it away.
#[test]
fn what_stands_in_the_way_casts_a_shadow() {
    let point = Light::Point { position_world: Vec3::Y, intensity: Vec3::ONE, range: 9.0 };
    let toward_sun = Vec3::new(0.0, 1.0_f32.sin(), 1.0_f32.cos());
    for (light, toward) in [(sun(1.0, 0.01), toward_sun), (point, Vec3::Y)] {
        let mut scene = patch();
        scene.lights.push(light);
        assert!(mean(&look(&scene, 4)).0 > 0.1);
        // Black, or it would reflect light onto the patch.
        let place = Mat4::from_translation(toward * 0.2) * Mat4::from_scale(Vec3::splat(0.05));
        add(&mut scene, shapes::sphere(16), matt(0.0), place);
        assert_eq!(mean(&look(&scene, 4)).0, 0.0);
        // Without occlusion nothing is in the way.
        let camera = Camera { fov_y_rad: 1e-4, ..camera([1.0, 0.7, 0.2], [0.0; 3]) };
        let open = Settings { max_bounces: 1, occlusion: false, ..settings(4, 4) };
        assert!(mean(&render(&scene, &camera, &open)).0 > 0.1);
    }
}

/// The direction of a pixel's centre, from the camera's matrices.
fn pixel_direction(camera: &Camera, size: [u32; 2], pixel: usize) -> Vec3 {
    let [width, height] = size.map(|side| side as f32);
    let place = Vec2::new((pixel as u32 % size[0]) as f32 + 0.5, (pixel as u32 / size[0]) as f32 + 0.5);
    let clip = Vec3::new(2.0 * place.x / width - 1.0, 1.0 - 2.0 * place.y / height, 0.5);
    let world = camera.clip_from_world(width / height, 0.1).inverse().project_point3(clip);
    (world - camera.eye).normalize()
}

#[test]
fn the_background_shows_the_environment_where_it_is() {
    let mut environment = scene::builtin::environment_sized("studio", 256).unwrap();
    environment.rotation_rad = 0.7;
    environment.intensity = 1.5;
    let scene = Scene { name: "test".into(), environment: Some(environment.clone()), ..Scene::default() };
    for target in [[1.0, 2.2, 3.0], [-4.0, -1.0, 0.5], [0.1, 9.0, 0.0]] {
        let camera = Camera { fov_y_rad: 1.5, ..camera([0.0, 2.0, 0.0], target) };
        let size = [40, 30];
        let film = render(&scene, &camera, &Settings { size, ..settings(1, 1) });
        for (pixel, found) in film.mean().into_iter().enumerate() {
            let expected = environment.radiance_world(pixel_direction(&camera, size, pixel));
            let difference = (Vec3::from(found) - expected).abs().max_element();
            assert!(difference < 2e-3 * (1.0 + expected.max_element()), "{pixel}: {found:?} {expected}");
        }
    }
}

/// A mirror plane shows the environment upside down.
#[test]
fn a_mirror_shows_the_reflected_environment() {
    let environment = scene::builtin::environment_sized("sky", 128).unwrap();
    let mut scene = Scene { name: "test".into(), environment: Some(environment.clone()), ..Scene::default() };
    let mirror = Material { metallic: 1.0, roughness: 0.0, ks: Some(Vec3::ONE), ..matt(1.0) };
    add(&mut scene, shapes::plane(1), mirror, Mat4::from_scale(Vec3::splat(100.0)));
    let camera = camera([0.5, 1.0, 0.25], [1.0, 0.0, 0.5]);
    for occlusion in [true, false] {
        let film = render(&scene, &camera, &Settings { occlusion, ..settings(16, 1) });
        for (pixel, found) in film.mean().into_iter().enumerate() {
            let up = pixel_direction(&camera, [16; 2], pixel) * Vec3::new(1.0, -1.0, 1.0);
            let expected = environment.radiance_world(up);
            assert!(
                (Vec3::from(found) - expected).abs().max_element() < 1e-3 * (1.0 + expected.max_element())
            );
        }
    }
}

/// The test card that names its axes: each name stands in the middle of a picture along its axis,
/// so that the card is darker there than the same place of a picture that is mirrored.
#[test]
fn the_orientation_card_reads_the_right_way_round() {
    let Some(environment) = test_data("hdri/orientation_latlong.exr") else { return };
    let (environment, _) = scene::load::environment(&environment, &scene::Limits::default()).unwrap();
    let size = [48, 48];
    // Where the card's own file has +Z, and +X a quarter to the left of it.
    let texel = |u: f32, v: f32| {
        let x = ((u * environment.width as f32) as usize).min(environment.width as usize - 1);
        let y = ((v * environment.height as f32) as usize).min(environment.height as usize - 1);
        Vec3::from(environment.pixels[y * environment.width as usize + x])
    };
    // The convention of this project puts +X in the middle of the file and +Z a quarter to the
    // right; seen from inside, the picture is the part of the file as it is, not mirrored.
    for (target, middle) in [([1.0, 0.0, 0.0], 0.5), ([0.0, 0.0, 1.0], 0.75), ([0.0, 0.0, -1.0], 0.25)] {
        let scene = Scene { name: "card".into(), environment: Some(environment.clone()), ..Scene::default() };
        let camera = Camera { fov_y_rad: 0.5, ..camera([0.0; 3], target) };
        let picture = render(&scene, &camera, &Settings { size, ..settings(1, 1) }).mean();
        let (mut upright, mut mirrored) = (0.0, 0.0);
        for (pixel, &found) in picture.iter().enumerate() {
            let place = |index: usize, count: u32| (index as f32 + 0.5) / count as f32 * 2.0 - 1.0;
            let (x, y) = (place(pixel % 48, size[0]), place(pixel / 48, size[1]));
            let half = 0.25_f32.tan();
            let azimuth = (x * half).atan();
            let polar = 0.5 + ((y * half) * azimuth.cos()).atan() / PI;
            upright += (Vec3::from(found) - texel(middle + azimuth / (2.0 * PI), polar)).length();
            mirrored += (Vec3::from(found) - texel(middle - azimuth / (2.0 * PI), polar)).length();
        }
        println!("{target:?}: {upright} {mirrored}");
        assert!(upright < 0.3 * mirrored, "{target:?}: {upright} {mirrored}");
    }
}

/// A file of the test data that may be absent.
fn test_data(file: &str) -> Option<std::path::PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").to_owned();
    let folder = std::env::var("SHEEN_TEST_DATA").unwrap_or(beside);
    let path = std::path::Path::new(&folder).join(file);
    if !path.exists() {
        println!("skipped: test data absent");
        return None;
    }
    Some(path)
}

/// An environment of one texel lights from everywhere alike.
#[test]
fn an_environment_of_one_texel_is_an_even_light() {
    let mut scene = patch();
    scene.environment = Some(Environment::new("one", 1, 1, vec![[2.0; 3]]).unwrap());
    assert_mean(&look(&scene, 256), 2.0 * f64::from(ALBEDO), "one texel");
    let mut even = patch();
    even.environment = furnace(2.0).environment;
    assert_mean(&look(&even, 256), 2.0 * f64::from(ALBEDO), "eight texels");
}

/// The scene can be traced while another thread waits for a part of it.
#[test]
fn one_tracer_serves_many_threads() {
    let scene = patch();
    let tracer = PathTracer::new(&scene).unwrap();
    let settings = settings(4, 2);
    let camera = camera([0.0, 1.0, 0.0], [0.0; 3]);
    let picture = || tracer.render(&camera, &settings, &|_| ControlFlow::Continue(())).unwrap();
    std::thread::scope(|scope| {
        let other = scope.spawn(picture);
        assert_eq!(picture(), other.join().unwrap());
    });
}
