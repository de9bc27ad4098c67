//! Shadows of surfaces on each other against geometry, and every reason to leave them out.

mod support;

use compositor::{Compositor, SceneGpu, Settings, ShadowMapSettings, headless, skips, wgpu};
use glam::{Mat4, Vec3};
use gpu_context::{Gpu, HeadlessDesc, Work, readback};
use scene::{Camera, HeightMap, HeightRef, Instance, Light, Material, Mesh, Scene, shapes};
use std::f32::consts::PI;
use support::*;

const SIZE: [u32; 2] = [96, 96];

/// Seen from above and aside.
fn camera() -> Camera {
    Camera { eye: Vec3::new(0.5, 7.0, 4.0), target: Vec3::new(0.5, 0.0, 0.0), up: Vec3::Y, fov_y_rad: 0.7 }
}

fn diffuse() -> Material {
    Material { ks: Some(Vec3::ZERO), ..Material::default() }
}

fn sun(direction: Vec3, angular_diameter_rad: f32) -> Light {
    Light::Directional {
        direction_world: direction.normalize(),
        irradiance: Vec3::splat(PI),
        angular_diameter_rad,
    }
}

/// A sphere of radius 0.5 a metre above a ground of 8 x 8 metres at height 0.
fn ball_over_ground(ball: Material, ground: Material, light: Light) -> Scene {
    let mut scene = scene_of(shapes::plane(1), ground, Mat4::from_scale(Vec3::splat(4.0)));
    scene.meshes.push(shapes::sphere(64));
    scene.materials.push(ball);
    let world_from_local = Mat4::from_translation(Vec3::Y) * Mat4::from_scale(Vec3::splat(0.5));
    scene.instances.push(Instance { name: "ball".into(), mesh: 1, material: 1, world_from_local });
    scene.lights.push(light);
    scene
}

/// A map of one height everywhere.
fn flat(height: f32) -> HeightMap {
    HeightMap { name: "flat".into(), width: 4, height: 4, heights: vec![height; 16] }
}

fn with_height(scale: f32) -> Material {
    Material { height: Some(HeightRef { map: 0, height_scale: scale, uv_scale: [1.0; 2] }), ..diffuse() }
}

/// Position on the ground at a pixel.
fn on_ground(camera: &Camera, x: u32, y: u32) -> Vec3 {
    let direction = pixel_direction(camera, SIZE, x, y);
    camera.eye - direction * (camera.eye.y / direction.y)
}

/// How far beside a sphere around (0, 1, 0) the ray from a position to a light passes: below 0
/// inside of it.
fn clearance(position: Vec3, towards: Vec3, radius: f32) -> f32 {
    let to_center = Vec3::Y - position;
    to_center.reject_from(towards.normalize()).length() - radius
}

/// Compares the ground with the shadow of a ball of this radius, seen by points this high above
/// the ground. Returns how many pixels of it are in shadow.
fn compare_ground(
    gpu: &Gpu,
    scene: &Scene,
    towards: Vec3,
    radius: f32,
    lift: f32,
    settings: &Settings,
) -> usize {
    let camera = camera();
    let pixels = render_with(gpu, scene, &camera, SIZE, settings);
    let lit = towards.normalize().y;
    let mut dark = 0;
    for (x, y) in pixels.all() {
        let position = on_ground(&camera, x, y);
        let is_ground = pixels.is_covered(x, y) && pixels.normal(x, y).distance(Vec3::Y) < 1e-3;
        let clearance = clearance(position + Vec3::Y * lift, towards, radius);
        // Two texels of the map; the ground in front of the ball alone.
        if !is_ground || position.abs().max_element() > 3.9 || clearance.abs() < 0.015 {
            continue;
        }
        let share = pixels.radiance(x, y).x / lit;
        let expected = if clearance > 0.0 { 1.0 } else { 0.0 };
        assert!((share - expected).abs() < 0.02, "{share} of the light at {position}, clearance {clearance}");
        dark += usize::from(clearance < 0.0);
    }
    dark
}

fn without_horizons() -> Settings {
    Settings { horizon_shadow: None, ..Settings::default() }
}

#[test]
fn the_shadow_of_a_ball_lies_where_geometry_says() {
    let gpu = gpu();
    for towards in [Vec3::Y, Vec3::new(-1.0, 1.0, 0.3), Vec3::new(-0.5, 1.0, -1.2)] {
        let scene = ball_over_ground(diffuse(), diffuse(), sun(towards, 0.0));
        let dark = compare_ground(&gpu, &scene, towards, 0.5, 0.0, &Settings::default());
        assert!(dark > 20, "{dark} pixels in shadow from {towards}");
    }
}

#[test]
fn on_open_gl_as_well() {
    let desc = HeadlessDesc { backends: wgpu::Backends::GL, ..HeadlessDesc::default() };
    let Ok(gpu) = Gpu::headless(&desc) else {
        println!("skipped: no OpenGL");
        return;
    };
    let towards = Vec3::new(-1.0, 1.0, 0.3);
    let mut scene = ball_over_ground(with_height(0.25), diffuse(), sun(towards, 0.0));
    scene.height_maps.push(flat(1.0));
    // OpenGL cannot read depth back: where the ball does not hide it, the ground is seen.
    let camera = camera();
    let image = headless::render(&gpu, &scene, &camera, SIZE, &Settings::default()).unwrap();
    let mut dark = 0;
    for (index, pixel) in image.rgba.chunks(4).enumerate() {
        let (x, y) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
        let position = on_ground(&camera, x, y);
        let is_seen = clearance(position, camera.eye - position, 0.5) > 0.02;
        let clearance = clearance(position, towards, 0.75);
        if is_seen && clearance.abs() > 0.02 && position.abs().max_element() < 3.9 {
            let share = pixel[0] / towards.normalize().y;
            let expected = if clearance > 0.0 { 1.0 } else { 0.0 };
            assert!((share - expected).abs() < 0.02, "{share} of the light at {position}");
            dark += usize::from(clearance < 0.0);
        }
    }
    assert!(dark > 100, "{dark}");
}

#[test]
fn a_height_map_widens_the_shadow_and_lifts_the_receiver() {
    let gpu = gpu();
    let towards = Vec3::new(-1.0, 1.0, 0.3);
    let mut scene = ball_over_ground(with_height(0.25), diffuse(), sun(towards, 0.0));
    scene.height_maps.push(flat(1.0));
    for settings in [Settings::default(), without_horizons()] {
        assert!(compare_ground(&gpu, &scene, towards, 0.75, 0.0, &settings) > 100);
    }
    // A negative scale is a relief that is turned over.
    scene.materials[1] = with_height(-0.25);
    compare_ground(&gpu, &scene, towards, 0.25, 0.0, &Settings::default());
    // The shadow falls on the relief, which is drawn where the base surface is.
    let mut scene = ball_over_ground(diffuse(), with_height(0.3), sun(towards, 0.0));
    scene.height_maps.push(flat(1.0));
    for settings in [Settings::default(), without_horizons()] {
        assert!(compare_ground(&gpu, &scene, towards, 0.5, 0.3, &settings) > 20);
    }
}

#[test]
fn a_spot_light_casts_as_a_point_does() {
    let gpu = gpu();
    let position_world = Vec3::new(-1.5, 3.0, 0.5);
    let light = Light::Spot {
        position_world,
        direction_world: (Vec3::Y - position_world).normalize(),
        intensity: Vec3::ONE,
        range: f32::INFINITY,
        inner_angle_rad: 0.5,
        outer_angle_rad: 0.9,
    };
    let scene = ball_over_ground(diffuse(), diffuse(), light);
    let camera = camera();
    let lit = render_with(&gpu, &scene, &camera, SIZE, &Settings { shadow_map: None, ..Settings::default() });
    let pixels = render(&gpu, &scene, &camera, SIZE);
    let mut dark = 0;
    for (x, y) in pixels.all().filter(|&(x, y)| pixels.normal(x, y).distance(Vec3::Y) < 1e-3) {
        let position = on_ground(&camera, x, y);
        let clearance = clearance(position, position_world - position, 0.5);
        let unshadowed = lit.radiance(x, y).x;
        if clearance.abs() > 0.02 && unshadowed > 1e-3 && position.abs().max_element() < 3.9 {
            let share = pixels.radiance(x, y).x / unshadowed;
            let expected = if clearance > 0.0 { 1.0 } else { 0.0 };
            assert!((share - expected).abs() < 0.02, "{share} at {position}, clearance {clearance}");
            dark += usize::from(clearance < 0.0);
        }
    }
    assert!(dark > 100, "{dark}");
}

#[test]
fn lit_sides_have_no_acne_and_touching_surfaces_no_gap() {
    let gpu = gpu();
    for (double_sided, towards) in [
        (false, Vec3::new(-1.0, 0.4, 0.3)),
        (true, Vec3::new(-1.0, 0.4, 0.3)),
        (true, Vec3::new(-0.2, 1.0, 0.1)),
    ] {
        let material = Material { double_sided, ..diffuse() };
        let mut scene = ball_over_ground(material.clone(), material, sun(towards, 0.01));
        scene.instances[1].world_from_local = Mat4::from_translation(Vec3::Y);
        let camera = camera();
        let off = Settings { shadow_map: None, ..Settings::default() };
        let lit = render_with(&gpu, &scene, &camera, SIZE, &off);
        let pixels = render(&gpu, &scene, &camera, SIZE);
        let l = towards.normalize();
        for (x, y) in pixels.all().filter(|&(x, y)| pixels.is_covered(x, y)) {
            let normal = pixels.normal(x, y);
            let is_ground = normal.distance(Vec3::Y) < 1e-3;
            let share = pixels.radiance(x, y).x / lit.radiance(x, y).x.max(1e-6);
            if !is_ground && normal.dot(l) > 0.1 {
                assert!((share - 1.0).abs() < 0.02, "{share} on the ball at ({x}, {y})");
            }
            // The ball of radius 1 touches the ground: dark up to where it stands.
            let position = on_ground(&camera, x, y);
            let clearance = clearance(position, towards, 1.0);
            if is_ground && clearance < -0.03 && position.abs().max_element() < 3.9 {
                assert!(share < 0.02, "{share} on the ground at {position}");
            }
        }
    }
}

/// A wall of 2 x 2 metres at height 1 over the ground, whose front looks up or down.
fn roof(looks_up: bool, double_sided: bool, light: Light) -> Scene {
    let mut scene = ball_over_ground(Material { double_sided, ..diffuse() }, diffuse(), light);
    scene.meshes[1] = shapes::plane(1);
    let turn = if looks_up { 0.0 } else { PI };
    scene.instances[1].world_from_local = Mat4::from_translation(Vec3::Y) * Mat4::from_rotation_x(turn);
    scene
}

#[test]
fn what_casts_is_what_a_ray_from_the_ground_would_meet() {
    let gpu = gpu();
    let under = Camera { eye: Vec3::new(0.0, 0.6, 2.5), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.3 };
    let middle = |scene: &Scene| render(&gpu, scene, &under, [17, 17]).radiance(8, 8).x;
    let light = sun(Vec3::Y, 0.0);
    assert!(middle(&roof(false, false, light)) < 0.01);
    assert!(middle(&roof(true, true, light)) < 0.01);
    assert!(middle(&roof(false, true, light)) < 0.01);
    // A single-sided surface is not there from behind, neither for the eye nor for the light.
    assert!(middle(&roof(true, false, light)) > 0.99);
    // Mirrored, it is the same surface the other way round in space.
    let mut mirrored = roof(true, false, light);
    mirrored.instances[1].world_from_local *= Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0));
    assert!(middle(&mirrored) < 0.01);
    // Holes let light through.
    let mut holed = roof(false, true, light);
    holed.materials[1].alpha_mode = scene::AlphaMode::Mask { cutoff: 0.5 };
    holed.materials[1].base_color.w = 0.2;
    assert!(middle(&holed) > 0.99);
}

#[test]
fn a_disc_of_light_has_a_penumbra_as_wide_as_it_looks() {
    let gpu = gpu();
    // The edge of the roof at x = 1 is a metre above the ground: the penumbra is the angle wide.
    let angle = 0.06_f32;
    let scene = roof(false, false, sun(Vec3::Y, angle));
    let camera = Camera { eye: Vec3::new(2.0, 0.9, 0.0), target: Vec3::X, up: Vec3::Y, fov_y_rad: 0.2 };
    let pixels = render(&gpu, &scene, &camera, SIZE);
    let share = |x: f32| {
        let mut sum = (0.0, 0.0);
        for (column, row) in pixels.all().filter(|&(column, row)| pixels.is_covered(column, row)) {
            if (on_ground(&camera, column, row).x - x).abs() < 0.004 {
                sum = (sum.0 + pixels.radiance(column, row).x, sum.1 + 1.0);
            }
        }
        assert!(sum.1 > 20.0, "{} pixels at {x}", sum.1);
        sum.0 / sum.1
    };
    // The filter is no wider than eight texels of 5.5 mm: 4.4 cm to either side.
    let shares = [-0.06, -0.02, -0.01, 0.0, 0.01, 0.02, 0.06].map(|offset| share(1.0 + offset));
    assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
    assert!(shares[0] < 0.01 && shares[6] > 0.99 && (shares[3] - 0.5).abs() < 0.1, "{shares:?}");
    assert!(shares[1] > 0.02 && shares[5] < 0.98 && shares[2] < 0.45 && shares[4] > 0.55, "{shares:?}");
}

#[test]
fn what_a_scene_lacks_is_skipped_with_a_reason() {
    let gpu = gpu();
    let camera = camera();
    let work = |scene: &Scene, settings: &Settings, name: &str| {
        render_with(&gpu, scene, &camera, [16, 16], settings).work.get(name).unwrap()
    };
    let light = sun(Vec3::Y, 0.0);
    let plain = ball_over_ground(diffuse(), diffuse(), light);
    let full = Settings::default();
    assert_eq!(work(&plain, &full, "shadow-map"), Work::done(2));
    assert_eq!(work(&plain, &full, "horizon-shadow"), Work::skipped(skips::NO_HEIGHT_MAPS));

    let off = Settings { shadow_map: None, horizon_shadow: None, ..full };
    assert_eq!(work(&plain, &off, "shadow-map"), Work::skipped(skips::SHADOW_MAP_OFF));
    assert_eq!(work(&plain, &off, "horizon-shadow"), Work::skipped(skips::HORIZON_SHADOW_OFF));

    let mut relief = ball_over_ground(with_height(0.1), diffuse(), light);
    relief.height_maps.push(flat(0.5));
    let dark = Scene { lights: Vec::new(), ..relief.clone() };
    let unlit = Settings { direct_light: false, ..full };
    for name in ["shadow-map", "horizon-shadow"] {
        assert_eq!(work(&dark, &full, name), Work::skipped(skips::NO_LIGHTS));
        assert_eq!(work(&relief, &unlit, name), Work::skipped(skips::DIRECT_LIGHT_OFF));
    }
    let empty = Scene { instances: Vec::new(), ..plain.clone() };
    assert_eq!(work(&empty, &full, "shadow-map"), Work::skipped(skips::NO_SURFACE));

    let point = Light::Point { position_world: Vec3::Y * 3.0, intensity: Vec3::ONE, range: f32::INFINITY };
    let mut points = plain.clone();
    points.lights = vec![point];
    assert_eq!(work(&points, &full, "shadow-map"), Work::skipped(skips::NO_CASTING_LIGHTS));
    let mut many = relief.clone();
    many.lights = vec![light; 5];
    for name in ["shadow-map", "horizon-shadow"] {
        assert_eq!(work(&many, &full, name).skipped, Some(skips::MORE_LIGHTS), "{name}");
    }
}

#[test]
fn the_fifth_light_shines_through_everything() {
    let gpu = gpu();
    let under = Camera { eye: Vec3::new(0.0, 0.6, 2.5), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.3 };
    let mut scene = roof(false, false, sun(Vec3::Y, 0.0));
    scene.lights = vec![sun(Vec3::Y, 0.0); 6];
    let found = render(&gpu, &scene, &under, [17, 17]).radiance(8, 8).x;
    assert!((found - 2.0).abs() < 0.02, "{found}");
}

#[test]
fn shadows_stand_while_scene_and_lights_do_and_go_when_turned_off() {
    let gpu = gpu();
    let scene = ball_over_ground(diffuse(), diffuse(), sun(Vec3::new(1.0, 1.0, 0.0), 0.0));
    let mut uploaded = SceneGpu::upload(&gpu, &scene).unwrap();
    let mut compositor = compositor(&gpu);
    let shadows = |compositor: &mut Compositor, uploaded: &SceneGpu, settings: &Settings| {
        submit(&gpu, compositor, uploaded, &camera(), SIZE, settings).unwrap().get("shadow-map").unwrap()
    };
    let (full, again) = (Work::done(2), Work { passes: 1, skipped: Some(skips::SHADOW_MAP_STANDS) });
    let fine = Settings::default();
    assert_eq!(shadows(&mut compositor, &uploaded, &fine), full);
    assert_eq!(shadows(&mut compositor, &uploaded, &fine), again);
    let read = |compositor: &Compositor| {
        readback::read_texture(&gpu, &compositor.visibility().unwrap().texture, 0, 0).unwrap().values
    };
    let before = read(&compositor);
    assert!(before.contains(&0.0) && before.contains(&1.0));
    uploaded.set_lights(&gpu, &[sun(Vec3::new(-1.0, 1.0, 0.0), 0.0)]).unwrap();
    assert_eq!(shadows(&mut compositor, &uploaded, &fine), full);
    assert_ne!(before, read(&compositor));
    let coarse = Settings { shadow_map: Some(ShadowMapSettings { size: 0 }), ..fine };
    assert_eq!(shadows(&mut compositor, &uploaded, &coarse), full);
    shadows(&mut compositor, &uploaded, &Settings { shadow_map: None, ..fine });
    assert!(compositor.visibility().is_none());
    assert_eq!(shadows(&mut compositor, &uploaded, &fine), full);
}

#[test]
fn height_maps_that_cannot_be_used_are_refused_or_left_out_by_name() {
    let gpu = gpu();
    let scene = || {
        let mut scene = ball_over_ground(with_height(0.1), diffuse(), sun(Vec3::Y, 0.0));
        scene.height_maps.push(flat(0.5));
        scene
    };
    let refused = |change: &dyn Fn(&mut Scene), words: &[&str]| {
        let mut scene = scene();
        change(&mut scene);
        let Err(compositor::Error::Scene(error)) = SceneGpu::upload(&gpu, &scene) else {
            panic!("{words:?} was accepted")
        };
        for word in words {
            assert!(error.to_string().contains(word), "{error}");
        }
    };
    let without_uvs = |scene: &mut Scene| {
        scene.meshes[1] = Mesh { uvs: Vec::new(), tangents: Vec::new(), ..scene.meshes[1].clone() };
    };
    refused(&without_uvs, &["ball", "without texture coordinates", "flat"]);
    refused(&|scene| scene.height_maps.clear(), &["ball", "height map 0"]);
    refused(&|scene| scene.height_maps[0].heights.truncate(3), &["flat", "3 heights", "16"]);

    let warned = |change: &dyn Fn(&mut Scene), words: &str, passes: bool| {
        let mut scene = scene();
        change(&mut scene);
        let warnings = SceneGpu::upload(&gpu, &scene).unwrap().warnings().to_vec();
        assert!(warnings.len() == 1 && warnings[0].message.contains(words), "{warnings:?}");
        let pixels = render(&gpu, &scene, &camera(), [32, 32]);
        pixels.assert_finite();
        assert_eq!(pixels.work.get("horizon-shadow").unwrap().passes > 0, passes);
    };
    let height =
        |scene: &mut Scene, change: fn(&mut HeightRef)| change(scene.materials[1].height.as_mut().unwrap());
    warned(&|scene| height(scene, |height| height.uv_scale = [0.0, 1.0]), "uv_scale", false);
    warned(&|scene| height(scene, |height| height.height_scale = f32::NAN), "scales", false);
    warned(&|scene| scene.height_maps[0].heights[5] = f32::NAN, "1 heights", true);
    warned(&|scene| scene.height_maps[0].heights.fill(f32::INFINITY), "16 heights", true);
}
