//! Real models under real environments: they load, render to finite pictures that are not black,
//! and raise no error on the device. Without the test data each test says that it was skipped.

use compositor::{Settings, headless};
use glam::Vec3;
use gpu_context::Gpu;
use scene::{Environment, Limits, Scene, load};
use validation::{gpu, test_data};

const SIZE: [u32; 2] = [96, 96];

const MODELS: [&str; 5] = [
    "gltf/FlightHelmet/FlightHelmet.gltf",
    "gltf/boom_box.glb",
    "gltf/sports_car_2.glb",
    "obj/teapot.obj",
    "obj/stanford_bunny.obj",
];

const ENVIRONMENTS: [&str; 3] =
    ["hdri/rooitou_park_1k.hdr", "hdri/studio_small_03_1k.hdr", "hdri/hotel_room_1k.exr"];

fn model(file: &str) -> Option<Scene> {
    Some(load::load_scene(&test_data(file)?, &Limits::default()).unwrap_or_else(|error| panic!("{error}")))
}

fn environment(file: &str) -> Option<Environment> {
    let loaded = load::environment(&test_data(file)?, &Limits::default());
    Some(loaded.unwrap_or_else(|error| panic!("{error}")).0)
}

/// Radiance of each pixel, and its coverage.
fn picture(gpu: &Gpu, scene: &Scene, what: &str) -> Vec<[f32; 4]> {
    let camera = scene.camera.unwrap_or_else(|| scene.framing_camera(1.0));
    let picture = headless::render(gpu, scene, &camera, SIZE, &Settings::default())
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(gpu.take_errors(), [], "{what}");
    println!("{what}: {} values overflowed", picture.overflowed);
    // A few pixels of a mirror that shows the sun may.
    assert!(picture.overflowed < picture.rgba.len() / 1000, "{what}: {} overflowed", picture.overflowed);
    let (pixels, rest) = picture.rgba.as_chunks::<4>();
    assert!(rest.is_empty() && pixels.len() == (SIZE[0] * SIZE[1]) as usize);
    pixels.to_vec()
}

fn is_covered(pixel: [f32; 4]) -> bool {
    pixel[3] > 0.5
}

fn check_models(environment_file: &str) {
    let Some(environment) = environment(environment_file) else { return };
    let gpu = gpu();
    for file in MODELS {
        let Some(mut scene) = model(file) else { continue };
        scene.environment = Some(environment.clone());
        let what = format!("{file} under {environment_file}");
        let pixels = picture(&gpu, &scene, &what);
        assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0), "{what}");
        let covered: Vec<[f32; 4]> = pixels.into_iter().filter(|&pixel| is_covered(pixel)).collect();
        let is_black = |pixel: &&[f32; 4]| pixel[..3].iter().all(|&value| value < 1e-4);
        let (black, covered) = (covered.iter().filter(is_black).count(), covered.len());
        // Framed, every model fills a tenth of the picture at least, and none of them all.
        assert!((900..9216).contains(&covered), "{what}: {covered} pixels covered");
        println!("{what}: {covered} covered, {black} black");
        assert!(black * 50 < covered, "{what}: {black} of {covered} pixels are black");
    }
}

#[test]
fn models_in_the_park() {
    check_models(ENVIRONMENTS[0]);
}

#[test]
fn models_in_the_photo_studio() {
    check_models(ENVIRONMENTS[1]);
}

#[test]
fn models_in_the_hotel_room() {
    check_models(ENVIRONMENTS[2]);
}

#[test]
fn turning_everything_changes_nothing() {
    let Some(environment) = environment(ENVIRONMENTS[1]) else { return };
    let Some(scene) = model(MODELS[1]) else { return };
    let gpu = gpu();
    let turned = |quarter_turns: f32| {
        let angle = quarter_turns * std::f32::consts::FRAC_PI_2;
        let turn = glam::Quat::from_rotation_y(angle);
        let mut scene = scene.clone();
        let mut camera = scene.framing_camera(1.0);
        (camera.eye, camera.target) = (turn * camera.eye, turn * camera.target);
        for instance in &mut scene.instances {
            instance.world_from_local = glam::Mat4::from_quat(turn) * instance.world_from_local;
        }
        scene.camera = Some(camera);
        scene.environment = Some(Environment { rotation_rad: angle, ..environment.clone() });
        picture(&gpu, &scene, &format!("{quarter_turns} quarter turns"))
    };
    let (before, after) = (turned(0.0), turned(1.0));
    let color = |pixel: &[f32; 4]| Vec3::from_slice(pixel).min(Vec3::ONE);
    let pairs = || before.iter().zip(&after).map(|(a, b)| (color(a), color(b)));
    let difference = pairs().map(|(a, b)| (a - b).abs().element_sum()).sum::<f32>();
    let share = difference / pairs().map(|(a, _)| a.element_sum()).sum::<f32>();
    println!("a quarter turn of everything changes {share:.2e} of the light");
    // Rounding of normals to half floats, in other components.
    assert!(share < 1e-4, "{share}");
}
