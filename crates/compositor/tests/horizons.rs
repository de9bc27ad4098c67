//! horizon-shadow in the frame: shadows of bumps where geometry says, and what turns them off.

mod support;

use compositor::{SceneGpu, Settings, horizon_shadow, skips};
use glam::{Mat4, Vec3};
use gpu_context::{FloatImage, Gpu, readback};
use scene::{Environment, HeightMap, HeightRef, Light, Material, Scene, shapes};
use support::*;

const SIZE: [u32; 2] = [128, 32];

/// Half the width of the wall in metres.
const HALF_M: f32 = 2.0;

fn sun(direction: Vec3) -> Light {
    Light::Directional {
        direction_world: direction.normalize(),
        irradiance: Vec3::splat(std::f32::consts::PI),
        angular_diameter_rad: 0.0,
    }
}

fn relief(map: HeightMap, height_scale: f32, uv_scale: [f32; 2]) -> Scene {
    let height = Some(HeightRef { map: 0, height_scale, uv_scale });
    let material = Material { height, ks: Some(Vec3::ZERO), ..Material::default() };
    let mut scene = scene_of(wall(), material, Mat4::from_scale(Vec3::splat(HALF_M)));
    scene.height_maps.push(map);
    scene
}

/// One ridge along v in the middle of a wall of 4 x 4 metres, two texels wide and 0.25 m high.
fn ridge(lights: &[Light]) -> Scene {
    let heights =
        (0..128 * 8).map(|index| if (63..=64).contains(&(index % 128)) { 1.0 } else { 0.0 }).collect();
    let map = HeightMap { name: "ridge".into(), width: 128, height: 8, heights };
    Scene { lights: lights.to_vec(), ..relief(map, 0.25, [1.0; 2]) }
}

fn horizon_alone() -> Settings {
    Settings { shadow_map: None, ..Settings::default() }
}

/// The visibility buffer, and the picture.
fn shadows(gpu: &Gpu, scene: &Scene, size: [u32; 2], distance: f32, settings: &Settings) -> [FloatImage; 2] {
    let uploaded = SceneGpu::upload(gpu, scene).unwrap();
    let mut compositor = compositor(gpu);
    submit(gpu, &mut compositor, &uploaded, &camera_at(distance), size, settings).unwrap();
    assert_eq!(gpu.take_errors(), []);
    [compositor.visibility().unwrap(), compositor.hdr().unwrap()]
        .map(|target| readback::read_texture(gpu, &target.texture, 0, 0).unwrap())
}

#[test]
fn the_shadow_of_a_ridge_falls_away_from_the_light_as_far_as_it_is_high() {
    let gpu = gpu();
    let lights = [sun(Vec3::new(-1.0, 0.0, 0.4)), sun(Vec3::new(1.0, 0.0, 0.4)), sun(Vec3::Z)];
    let length_m = 0.25 / 0.4;
    // With shadow maps too: what the horizon map knows is not counted twice.
    for settings in [horizon_alone(), Settings::default()] {
        let [visibility, _] = shadows(&gpu, &ridge(&lights), SIZE, 1.5, &settings);
        let camera = camera_at(1.5);
        let mut dark = [0; 2];
        for x in 0..SIZE[0] {
            let direction = pixel_direction(&camera, SIZE, x, 16);
            let at_m = camera.eye.x - direction.x * camera.eye.z / direction.z;
            let texel = visibility.texel(x, 16).unwrap();
            // The ridge itself, whose flanks are half a texel wide, is left out.
            let texel_m = 2.0 * HALF_M / 128.0;
            for (light, away_m) in [(0, at_m), (1, -at_m)] {
                let is_dark = away_m > 0.0 && away_m < length_m;
                let is_edge = away_m.abs() < 3.0 * texel_m || (away_m - length_m).abs() < 1.5 * texel_m;
                let expected = if is_dark { 0.0 } else { 1.0 };
                assert!(
                    is_edge || (texel[light] - expected).abs() < 0.05,
                    "light {light}: {} at {at_m} m",
                    texel[light]
                );
                dark[light] += usize::from(is_dark && !is_edge);
            }
            assert!((texel[2] - 1.0).abs() < 0.01 && (texel[3] - 1.0).abs() < 0.01, "{texel:?} at {at_m} m");
        }
        assert!(dark.iter().all(|&pixels| pixels > 15), "{dark:?}");
    }
}

#[test]
fn a_map_of_one_height_shadows_nothing() {
    let gpu = gpu();
    for height in [0.0, 4.0] {
        let map = HeightMap { name: "flat".into(), width: 16, height: 16, heights: vec![height; 256] };
        let mut scene = relief(map, 0.1, [4.0; 2]);
        scene.meshes[0] = shapes::sphere(64);
        scene.lights = vec![sun(Vec3::new(-1.0, 0.5, 1.0))];
        let [_, lit] = shadows(&gpu, &scene, [64, 64], 12.0, &horizon_alone());
        scene.materials[0].height = None;
        let plain = render_with(&gpu, &scene, &camera_at(12.0), [64, 64], &horizon_alone()).hdr;
        for (one, other) in lit.values.iter().zip(&plain.values) {
            assert!((one - other).abs() < 0.01, "{one} with a map of height {height}, {other} without");
        }
    }
}

/// Bumps on a sphere of radius 2.
fn bumpy_ball() -> Scene {
    let wave = |x: u32| 0.5 - 0.5 * (std::f32::consts::TAU * (x as f32 + 0.5) / 32.0).cos();
    let heights = (0..32 * 32).map(|index| wave(index % 32) * wave(index / 32)).collect();
    let map = HeightMap { name: "bumps".into(), width: 32, height: 32, heights };
    let mut scene = relief(map, 0.08, [24.0, 12.0]);
    scene.meshes[0] = shapes::sphere(64);
    scene
}

#[test]
fn bumps_beyond_the_terminator_catch_the_light() {
    let gpu = gpu();
    let towards = Vec3::NEG_X;
    let mut scene = bumpy_ball();
    scene.lights = vec![sun(towards)];
    let size = [192, 192];
    let camera = camera_at(9.0);
    let lit_behind = |settings: &Settings| {
        let [_, hdr] = shadows(&gpu, &scene, size, 9.0, settings);
        let mut counts = [0, 0];
        for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
            let direction = pixel_direction(&camera, size, x, y);
            let b = camera.eye.dot(direction);
            let square = b * b - (camera.eye.length_squared() - HALF_M * HALF_M);
            let is_lit = hdr.texel(x, y).unwrap()[0] > 0.02;
            if square > 0.0 && is_lit {
                let normal = (camera.eye + direction * (-b - square.sqrt())) / HALF_M;
                // Bumps of 0.08 m see the light down to acos(2 / 2.08) = 16 degrees behind.
                let behind = -normal.dot(towards);
                counts[0] += usize::from((0.01..0.26).contains(&behind));
                counts[1] += usize::from(behind > 0.29);
            }
        }
        counts
    };
    for settings in [horizon_alone(), Settings::default()] {
        let [near, deep] = lit_behind(&settings);
        assert!(near > 50 && deep == 0, "{near} lit pixels behind the terminator, {deep} deep in the night");
    }
    // Without shadows bumps shine deep in the night as well.
    let none = horizon_shadow::Settings { method: horizon_shadow::Method::None, ..Default::default() };
    let off = Settings { horizon_shadow: Some(none), ..horizon_alone() };
    assert!(lit_behind(&off)[1] > 50);
}

#[test]
fn tables_stand_and_cost_nothing_where_they_are_not_needed() {
    let gpu = gpu();
    let scene = ridge(&[sun(Vec3::new(-1.0, 0.0, 0.4))]);
    let mut plain = scene.clone();
    plain.materials[0].height = None;
    let [scene, plain] = [&scene, &plain].map(|scene| SceneGpu::upload(&gpu, scene).unwrap());
    let mut compositor = compositor(&gpu);
    let camera = camera_at(2.0);
    let (on, off) = (horizon_alone(), Settings { horizon_shadow: None, ..horizon_alone() });
    let mut frame = |scene: &SceneGpu, settings: &Settings| {
        let work = submit(&gpu, &mut compositor, scene, &camera, SIZE, settings).unwrap();
        let progress = compositor.horizon_progress();
        assert_eq!(progress.done, progress.total);
        (
            work.get("horizon-shadow").unwrap(),
            compositor.horizon_memory_bytes() > 0,
            compositor.visibility().is_some(),
        )
    };
    let (work, has_tables, has_buffer) = frame(&scene, &on);
    assert!(work.passes > 1 && work.skipped.is_none() && has_tables && has_buffer, "{work:?}");
    let (work, has_tables, has_buffer) = frame(&scene, &on);
    assert!(work.passes == 1 && has_tables && has_buffer, "{work:?}");
    assert_eq!(work.skipped, Some(horizon_shadow::TABLES_STAND));
    for (scene, settings, reason) in
        [(&plain, &on, skips::NO_HEIGHT_MAPS), (&scene, &off, skips::HORIZON_SHADOW_OFF)]
    {
        let (work, has_tables, has_buffer) = frame(scene, settings);
        assert_eq!((work.skipped, work.passes), (Some(reason), 0));
        assert!(!has_tables && !has_buffer);
    }
    assert!(frame(&scene, &on).1);
}

#[test]
fn a_bake_may_be_spread_over_frames() {
    let gpu = gpu();
    let scene = SceneGpu::upload(&gpu, &ridge(&[sun(Vec3::new(-1.0, 0.0, 0.4))])).unwrap();
    let technique = horizon_shadow::Settings { azimuths: 8, azimuths_per_prepare: 3, ..Default::default() };
    let settings = Settings { horizon_shadow: Some(technique), ..horizon_alone() };
    let mut compositor = compositor(&gpu);
    let progress = [(); 4].map(|()| {
        submit(&gpu, &mut compositor, &scene, &camera_at(2.0), SIZE, &settings).unwrap();
        compositor.horizon_progress()
    });
    assert_eq!(progress.map(|progress| progress.done), [3, 6, 8, 8]);
    assert!(progress.iter().all(|progress| progress.total == 8));
}

#[test]
fn grooves_are_dimmed_and_see_the_open_side_of_the_sky() {
    let gpu = gpu();
    let mut scene = bumpy_ball();
    scene.materials[0].height.as_mut().unwrap().height_scale = 0.25;
    scene.environment = Some(Environment::new("white", 8, 4, vec![[1.0; 3]; 32]).unwrap());
    let ambient = horizon_shadow::Settings { ambient: true, ..Default::default() };
    let with = Settings { horizon_shadow: Some(ambient), ..Settings::default() };
    let camera = camera_at(9.0);
    let size = [96, 96];
    let plain = render_with(&gpu, &scene, &camera, size, &Settings::default());
    let open = render_with(&gpu, &scene, &camera, size, &with);
    assert_eq!(plain.work.get("horizon-shadow").unwrap().skipped, Some(skips::NO_LIGHTS));
    let (mut least, mut greatest) = (1.0_f32, 0.0_f32);
    for (x, y) in open.all().filter(|&(x, y)| open.is_covered(x, y)) {
        let occlusion = open.albedo.texel(x, y).unwrap()[3];
        let dimmed = open.radiance(x, y).x / plain.radiance(x, y).x;
        assert!((dimmed - occlusion).abs() < 0.03, "{dimmed} of the light at ({x}, {y}), {occlusion} open");
        (least, greatest) = (least.min(occlusion), greatest.max(occlusion));
    }
    assert!(least < 0.8 && greatest > 0.9, "{least} .. {greatest}");

    // Only with the setting is there another normal for diffuse light.
    let uploaded = SceneGpu::upload(&gpu, &scene).unwrap();
    let mut compositor = compositor(&gpu);
    let mut normals = |settings: &Settings| {
        submit(&gpu, &mut compositor, &uploaded, &camera, size, settings).unwrap();
        let surface = compositor.surface().unwrap();
        let read = |target: &compositor::Target| readback::read_texture(&gpu, &target.texture, 0, 0).unwrap();
        surface.diffuse_normal.as_ref().map(|bent| (read(bent), read(&surface.normal_roughness)))
    };
    let (bent, bumps) = normals(&with).unwrap();
    assert!(normals(&Settings::default()).is_none());
    let mut turned = 0;
    for (bent, bump) in bent.values.chunks(4).zip(bumps.values.chunks(4)) {
        let [bent, bump] = [bent, bump].map(Vec3::from_slice);
        assert!(bump == Vec3::ZERO || (bent.length() - 1.0).abs() < 0.01, "{bent}");
        turned += usize::from(bent.distance(bump) > 0.02);
    }
    assert!(turned > 500, "{turned}");
}
