//! The frame as a whole: skips, sizes, bad input, tone mapping and the headless entry.

mod support;

use compositor::{Error, SceneGpu, Settings, ToneCurve, headless, skips, tone_map, wgpu};
use glam::{Mat4, Vec3, Vec4};
use gpu_context::{Gpu, HeadlessDesc, Timer, Work, readback};
use scene::{Environment, Light, Material, Scene, shapes};
use support::*;

fn sun() -> Light {
    Light::Directional { direction_world: Vec3::Y, irradiance: Vec3::ONE, angular_diameter_rad: 0.01 }
}

fn grey() -> Environment {
    Environment::new("grey", 4, 2, vec![[0.25; 3]; 8]).unwrap()
}

fn full_scene() -> Scene {
    let mut scene = scene_of(shapes::sphere(16), Material::default(), Mat4::IDENTITY);
    scene.environment = Some(grey());
    scene.lights.push(sun());
    scene
}

#[test]
fn what_a_scene_lacks_is_skipped_with_a_reason() {
    let gpu = gpu();
    let camera = camera_at(4.0);
    let work = |scene: &Scene, settings: &Settings| {
        let pixels = render_with(&gpu, scene, &camera, [16, 16], settings);
        pixels.assert_finite();
        let names = ["geometry", "diffuse-envmap", "background", "direct-light"];
        names.map(|name| pixels.work.get(name).unwrap())
    };
    let [geometry, envmap, background, direct] = work(&full_scene(), &Settings::default());
    assert_eq!((geometry, background, direct), (Work::done(1), Work::done(1), Work::done(1)));
    assert!(envmap.passes > 1 && envmap.skipped.is_none(), "{envmap:?}");

    let [geometry, envmap, background, direct] = work(&Scene::default(), &Settings::default());
    assert_eq!(geometry, Work { passes: 1, skipped: Some(skips::NOTHING_TO_DRAW) });
    assert_eq!(envmap, Work::skipped(skips::NO_ENVIRONMENT));
    assert_eq!(background, Work::skipped(skips::NO_ENVIRONMENT));
    assert_eq!(direct, Work::skipped(skips::NO_SURFACE));

    let only_environment = Scene { environment: Some(grey()), ..Scene::default() };
    let [_, envmap, background, _] = work(&only_environment, &Settings::default());
    assert_eq!((envmap, background), (Work::skipped(skips::NO_SURFACE), Work::done(1)));

    let dark = scene_of(shapes::sphere(16), Material::default(), Mat4::IDENTITY);
    assert_eq!(work(&dark, &Settings::default())[3], Work::skipped(skips::NO_LIGHTS));

    let off = Settings { diffuse_envmap: None, background: false, direct_light: false, ..Settings::FULL };
    let [_, envmap, background, direct] = work(&full_scene(), &off);
    assert_eq!(envmap, Work::skipped(skips::DIFFUSE_ENVMAP_OFF));
    assert_eq!(background, Work::skipped(skips::BACKGROUND_OFF));
    assert_eq!(direct, Work::skipped(skips::DIRECT_LIGHT_OFF));
}

#[test]
fn sizes_that_cannot_be_rendered_are_refused() {
    let gpu = gpu();
    let scene = SceneGpu::upload(&gpu, &full_scene()).unwrap();
    let mut compositor = compositor(&gpu);
    let mut render =
        |size| submit(&gpu, &mut compositor, &scene, &camera_at(4.0), size, &Settings::default());
    for size in [[0, 16], [16, 0], [u32::MAX, 16], [16, u32::MAX], [16384, 16384]] {
        let error = render(size).unwrap_err();
        assert!(matches!(error, Error::Size { .. }), "{size:?}: {error}");
    }
    for size in [[1, 1], [16, 16], [1, 64], [16, 16]] {
        render(size).unwrap();
    }
    assert_eq!(gpu.take_errors(), []);
}

#[test]
fn images_stand_while_the_size_does() {
    let gpu = gpu();
    let scene = SceneGpu::upload(&gpu, &full_scene()).unwrap();
    let mut compositor = compositor(&gpu);
    let mut texture = |size| {
        submit(&gpu, &mut compositor, &scene, &camera_at(4.0), size, &Settings::default()).unwrap();
        compositor.hdr().unwrap().texture.clone()
    };
    let first = texture([20, 10]);
    assert_eq!(first, texture([20, 10]));
    assert_ne!(first, texture([10, 20]));
}

#[test]
fn values_that_are_no_numbers_leave_the_picture_finite() {
    let gpu = gpu();
    let nan = f32::NAN;
    let mut scene = full_scene();
    scene.materials[0] = Material {
        base_color: Vec4::splat(nan),
        metallic: nan,
        roughness: nan,
        emissive: Vec3::splat(f32::INFINITY),
        normal_scale: nan,
        ks: Some(Vec3::splat(nan)),
        shininess: Some(nan),
        ..Material::default()
    };
    scene.meshes[0].normals[..40].fill(Vec3::splat(nan));
    scene.meshes[0].uvs[..40].fill(glam::Vec2::splat(nan));
    scene.lights = vec![
        sun(),
        Light::Directional {
            direction_world: Vec3::Z,
            irradiance: Vec3::splat(1e30),
            angular_diameter_rad: nan,
        },
        Light::Point { position_world: Vec3::Z, intensity: Vec3::splat(1e30), range: f32::INFINITY },
        Light::Point { position_world: Vec3::splat(nan), intensity: Vec3::ONE, range: nan },
    ];
    let pixels = render(&gpu, &scene, &camera_at(4.0), [48, 48]);
    assert!(pixels.covered() > 100);
    pixels.assert_finite();
    let warnings = SceneGpu::upload(&gpu, &scene).unwrap().warnings().to_vec();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

#[test]
fn inconsistent_scenes_are_refused_by_name() {
    let gpu = gpu();
    let refused = |change: &dyn Fn(&mut Scene), place: &str| {
        let mut scene = full_scene();
        change(&mut scene);
        let Err(Error::Scene(error)) = SceneGpu::upload(&gpu, &scene) else { panic!("{place} was accepted") };
        assert!(error.to_string().contains(place), "{error}");
    };
    refused(&|scene| scene.instances[0].mesh = 7, "mesh 7");
    refused(&|scene| scene.instances[0].material = 7, "material 7");
    refused(&|scene| scene.instances[0].world_from_local.x_axis.x = f32::NAN, "instance 0");
    refused(&|scene| scene.meshes[0].triangles[3] = [0, 1, 100_000], "triangle 3");
    refused(&|scene| scene.meshes[0].positions[5].y = f32::INFINITY, "position 5");
    refused(&|scene| scene.meshes[0].normals.truncate(3), "normals");
    let missing = scene::TextureRef {
        texture: 3,
        texture_from_vertex_uv: glam::Affine2::IDENTITY,
        wrap: [scene::Wrap::Repeat; 2],
        nearest: false,
    };
    refused(&|scene| scene.materials[0].emissive_texture = Some(missing.clone()), "texture 3");
}

#[test]
fn an_environment_keeps_its_radiance_and_has_its_own_revision() {
    let gpu = gpu();
    let mut pixels = vec![[1.0; 3]; 8];
    pixels[3] = [1e6, 2.0, 70_000.0];
    let bright = Environment::new("bright", 4, 2, pixels).unwrap();
    let mut scene = SceneGpu::upload(&gpu, &full_scene()).unwrap();
    let first = scene.environment().unwrap().revision;
    let format = |scene: &SceneGpu| scene.environment().unwrap().view.texture().format();
    assert_eq!(format(&scene), wgpu::TextureFormat::Rgba16Float);
    scene.set_environment(&gpu, Some(&bright)).unwrap();
    assert_ne!(scene.environment().unwrap().revision, first);
    if gpu.device().features().contains(wgpu::Features::FLOAT32_FILTERABLE) {
        assert_eq!(format(&scene), wgpu::TextureFormat::Rgba32Float);
        assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    }
    scene.place_environment(f32::NAN, f32::NAN);
    let environment = scene.environment().unwrap();
    assert_eq!((environment.intensity.to_bits(), environment.rotation_rad.to_bits()), (0, 0));
    scene.set_environment(&gpu, None).unwrap();
    assert!(scene.environment().is_none());

    // Without the feature half floats must do, and the loss is said.
    let desc = HeadlessDesc { optional_features: wgpu::Features::empty(), ..HeadlessDesc::default() };
    let plain = Gpu::headless(&desc).unwrap();
    let mut scene = SceneGpu::upload(&plain, &full_scene()).unwrap();
    scene.set_environment(&plain, Some(&bright)).unwrap();
    assert_eq!(format(&scene), wgpu::TextureFormat::Rgba16Float);
    assert!(scene.warnings()[0].message.starts_with("2 values"), "{:?}", scene.warnings());
}

#[test]
fn tone_mapping_equals_its_twin_on_the_host() {
    let gpu = gpu();
    // Radiance from 2^-12 to 65504 in many ratios of the channels.
    let texel = |index: u32| {
        let level = |step: u32| ((index * step % 29) as f32 - 12.0).exp2().min(65504.0);
        [level(1), level(5), level(11)]
    };
    let environment = Environment::new("ramp", 64, 32, (0..2048).map(texel).collect()).unwrap();
    let scene = Scene { environment: Some(environment), ..Scene::default() };
    let uploaded = SceneGpu::upload(&gpu, &scene).unwrap();
    let size = [64, 64];
    for format in [wgpu::TextureFormat::Rgba8UnormSrgb, wgpu::TextureFormat::Bgra8Unorm] {
        let mut compositor =
            compositor::Compositor::new(&gpu, &compositor::Desc { display_format: format }).unwrap();
        submit(&gpu, &mut compositor, &uploaded, &camera_at(1.0), size, &Settings::default()).unwrap();
        let hdr = readback::read_texture(&gpu, &compositor.hdr().unwrap().texture, 0, 0).unwrap();
        for tone_curve in ToneCurve::ALL {
            for exposure_ev in [-3.0, 0.0, 2.5] {
                let settings = Settings { exposure_ev, tone_curve, ..Settings::default() };
                let shown = shown(&gpu, &mut compositor, &settings, size, format);
                for (index, (hdr, shown)) in hdr.values.chunks(4).zip(shown.values.chunks(4)).enumerate() {
                    let radiance = [hdr[0], hdr[1], hdr[2]];
                    let expected = tone_map::display_srgb8(radiance, exposure_ev, tone_curve);
                    let encode = |x: f32| if format.is_srgb() { tone_map::srgb_encoded(x) } else { x };
                    for (&found, expected) in shown.iter().zip(expected) {
                        let found = (encode(found) * 255.0).round();
                        let difference = (found - f32::from(expected)).abs();
                        assert!(
                            difference <= 1.0,
                            "{tone_curve:?} {exposure_ev} {index}: {radiance:?}, {found}"
                        );
                    }
                }
            }
        }
    }
}

fn shown(
    gpu: &gpu_context::Gpu,
    compositor: &mut compositor::Compositor,
    settings: &Settings,
    size: [u32; 2],
    format: wgpu::TextureFormat,
) -> gpu_context::FloatImage {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    compositor.tone_map(gpu, &mut encoder, settings, &view).unwrap();
    gpu.queue().submit([encoder.finish()]);
    readback::read_texture(gpu, &texture, 0, 0).unwrap()
}

#[test]
fn curves_keep_what_they_promise() {
    for curve in ToneCurve::ALL {
        let mut last = -1.0;
        for step in 0..200 {
            let radiance = 1e-3 * 1.1_f32.powi(step);
            let [shown, ..] = tone_map::display_linear([radiance; 3], 0.0, curve);
            assert!(shown >= last && shown <= 1.0, "{curve:?} at {radiance}");
            last = shown;
        }
        assert_eq!(tone_map::display_srgb8([f32::NAN, -1.0, 0.0], 0.0, curve), [0, 0, 0], "{curve:?}");
    }
    // PBR Neutral: 0.04 of Fresnel reflection is taken off, nothing else, below 0.8.
    let [r, g, b] = tone_map::display_linear([0.54, 0.34, 0.14], 0.0, ToneCurve::PbrNeutral);
    assert!((r - 0.5).abs() < 1e-6 && (g - 0.3).abs() < 1e-6 && (b - 0.1).abs() < 1e-6);
    // One stop doubles.
    let [one, ..] = tone_map::display_linear([0.2; 3], 1.0, ToneCurve::Linear);
    assert!((one - 0.4).abs() < 1e-6);
}

#[test]
fn the_headless_entry_renders_and_reports() {
    let gpu = gpu();
    let image =
        headless::render(&gpu, &full_scene(), &camera_at(4.0), [40, 30], &Settings::default()).unwrap();
    assert_eq!((image.width, image.height, image.rgba.len()), (40, 30, 40 * 30 * 4));
    assert!(image.rgba.iter().all(|value| value.is_finite()) && image.overflowed == 0);
    let labels: Vec<_> = image.timings.iter().map(|timing| timing.label.as_str()).collect();
    let expected = [
        "geometry",
        "horizon-shadow",
        "shadow-map",
        "diffuse-envmap",
        "background",
        "direct-light",
        "clear-coat",
    ];
    assert_eq!(labels, expected);
    assert_eq!(image.work.entries.iter().map(|(name, _)| *name).collect::<Vec<_>>(), expected);
    let error = headless::render(&gpu, &full_scene(), &camera_at(4.0), [0, 30], &Settings::default());
    assert!(error.unwrap_err().to_string().contains("found 0 x 30"));
}

#[test]
fn a_timer_is_the_hosts_to_resolve() {
    // Two compositors may share one encoder and one timer.
    let gpu = gpu();
    let scene = SceneGpu::upload(&gpu, &full_scene()).unwrap();
    let mut timer = Timer::new(&gpu).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for size in [[8, 8], [12, 4]] {
        let frame = compositor::Frame { scene: &scene, camera: &camera_at(4.0), size, timer: &timer };
        compositor(&gpu).render(&gpu, &mut encoder, &Settings::default(), &frame).unwrap();
    }
    timer.resolve(&mut encoder);
    gpu.queue().submit([encoder.finish()]);
    timer.end_frame().unwrap();
    gpu.wait().unwrap();
    assert_eq!(timer.finished_frame().unwrap().len(), 14);
}

/// The folder of test data, if it is there.
fn test_data() -> Option<std::path::PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("SHEEN_TEST_DATA").unwrap_or_else(|| beside.into());
    Some(std::path::PathBuf::from(folder)).filter(|folder| folder.is_dir())
}

#[test]
fn real_models_fill_the_surface_buffer_with_valid_values() {
    let Some(folder) = test_data() else {
        println!("skipped: test data absent");
        return;
    };
    let gpu = gpu();
    let size = [96, 96];
    for (name, share) in [
        ("gltf/FlightHelmet/FlightHelmet.gltf", 0.08),
        ("gltf/boom_box.glb", 0.15),
        ("gltf/sports_car_2.glb", 0.1),
        ("gltf/clearcoat_test.glb", 0.1),
        ("gltf/shaderball.glb", 0.15),
        ("obj/teapot.obj", 0.15),
        ("obj/sports_car.obj", 0.1),
    ] {
        let mut scene = scene::load::load_scene(&folder.join(name), &scene::Limits::default()).unwrap();
        scene.environment = scene::builtin::environment("studio");
        let camera = scene.framing_camera(1.0);
        let pixels = render(&gpu, &scene, &camera, size);
        pixels.assert_finite();
        let covered = pixels.covered() as f32 / (96.0 * 96.0);
        assert!(covered > share && covered < 0.95, "{name} covers {covered}");
        for (x, y) in pixels.all().filter(|&(x, y)| pixels.is_covered(x, y)) {
            let normal = pixels.normal(x, y);
            assert!((normal.length() - 1.0).abs() < 2e-3, "{name}: {normal} at ({x}, {y})");
            let cosine = -normal.dot(pixel_direction(&camera, size, x, y));
            assert!(cosine > 0.0, "{name}: a normal faces away at ({x}, {y}): {cosine}");
        }
        let center = pixels.radiance(48, 48);
        assert!(center.min_element() >= 0.0 && center.max_element() > 1e-3, "{name}: {center}");
    }
}
