//! Scenes at the edge of what is possible: an error or a right picture, never a hang, a panic or
//! something that is not a number.

#![allow(clippy::float_cmp, reason = "black is exactly 0")]

mod common;

use std::ops::ControlFlow;

use common::{add, camera, furnace, lamp, matt, mean, render, settings};
use glam::{Mat4, Vec3};
use path_tracer::{Film, PathTracer, PixelFilter, Settings};
use scene::{Camera, Environment, Light, Mesh, Scene, shapes};

/// Inside a closed black box, in the brightest light, there is none: no ray slips through an edge
/// or starts on the wrong side of a wall, at any scale and any place.
#[test]
fn no_light_leaks_into_a_closed_box() {
    for (scale, shift) in [(1e-3, 0.0), (1.0, 0.0), (1.0, 1e6), (1e3, 0.0), (1e6, 0.0), (1e6, 1e6)] {
        let shift = Vec3::new(shift, -shift, shift);
        let mut scene = furnace(1e6);
        let place = Mat4::from_translation(shift) * Mat4::from_scale(Vec3::splat(scale));
        // White walls, so that paths are long; inside, no light is found however often they turn.
        add(&mut scene, shapes::cuboid(), matt(1.0), place);
        add(&mut scene, shapes::sphere(16), matt(1.0), place * Mat4::from_scale(Vec3::splat(0.4)));
        scene.lights.push(Light::Directional {
            direction_world: Vec3::new(0.6, 0.8, 0.0),
            irradiance: Vec3::splat(1e6),
            angular_diameter_rad: 0.1,
        });
        let eye = shift + Vec3::new(-0.75, 0.75, 0.75) * scale;
        let inside = Camera { fov_y_rad: 2.0, ..camera(eye.into(), shift.into()) };
        let long = Settings { max_bounces: 64, ..settings(24, 16) };
        let film = render(&scene, &inside, &long);
        assert!(
            film.mean().as_flattened().iter().all(|&value| value == 0.0),
            "{scale} {shift}: {}",
            mean(&film).0
        );
    }
}

/// A white sphere in a furnace stays white at every scale and place: no ray meets the surface that
/// it leaves.
#[test]
fn no_surface_shadows_itself_at_any_scale() {
    for (scale, shift) in [(1e-3, 0.0), (1.0, 0.0), (1.0, 1e6), (1e3, 1e6), (1e6, 0.0), (1e6, 1e6)] {
        let shift = Vec3::new(shift, -shift, shift);
        let mut scene = furnace(1.0);
        let place = Mat4::from_translation(shift) * Mat4::from_scale(Vec3::splat(scale));
        add(&mut scene, shapes::sphere(32), matt(1.0), place);
        let eye = shift + Vec3::new(0.0, 0.5, 4.0) * scale;
        // A single reflection: whatever met the surface again would be missing.
        let film = render(
            &scene,
            &camera(eye.into(), shift.into()),
            &Settings { max_bounces: 1, ..settings(24, 256) },
        );
        let (mean, error) = mean(&film);
        assert!((mean - 1.0).abs() < 1e-3 + 3.0 * error && error < 5e-4, "{scale} {shift}: {mean} {error}");
    }
}

#[test]
fn scenes_without_anything_are_black() {
    let view = camera([0.0, 0.0, 5.0], [0.0; 3]);
    let black = |film: Film| film.mean().as_flattened().iter().all(|&value| value == 0.0);
    assert!(black(render(&Scene::default(), &view, &settings(8, 2))));
    let mut dark = Scene::default();
    add(&mut dark, shapes::sphere(8), matt(1.0), Mat4::IDENTITY);
    assert!(black(render(&dark, &view, &settings(8, 2))));
    let mut black_sky = furnace(0.0);
    add(&mut black_sky, shapes::sphere(8), matt(1.0), Mat4::IDENTITY);
    assert!(black(render(&black_sky, &view, &settings(8, 2))));
    // A mesh without triangles, and an environment alone.
    let mut empty = furnace(2.0);
    add(&mut empty, Mesh::default(), matt(1.0), Mat4::IDENTITY);
    assert_eq!(mean(&render(&empty, &view, &settings(8, 2))), (2.0, 0.0));
}

/// Triangles without area and triangles twice change nothing.
#[test]
fn degenerate_and_duplicate_triangles_change_nothing() {
    let view = camera([0.0, 0.5, 4.0], [0.0; 3]);
    let mut plain = furnace(1.0);
    add(&mut plain, shapes::sphere(16), matt(0.5), Mat4::IDENTITY);
    let mut messy = plain.clone();
    let triangles = messy.meshes[0].triangles.clone();
    messy.meshes[0].triangles.extend(triangles.iter().map(|&[a, b, _]| [a, b, a]));
    messy.meshes[0].triangles.extend(triangles.iter().map(|&[a, ..]| [a, a, a]));
    let tracer = PathTracer::new(&messy).unwrap();
    assert!(
        tracer.warnings().iter().any(|warning| warning.contains("without area")),
        "{:?}",
        tracer.warnings()
    );
    let go = |_| ControlFlow::Continue(());
    let expected = render(&plain, &view, &settings(16, 16)).mean();
    assert_eq!(tracer.render(&view, &settings(16, 16), &go).unwrap().mean(), expected);
    messy.meshes[0].triangles = [triangles.clone(), triangles].concat();
    assert_eq!(render(&messy, &view, &settings(16, 16)).mean(), expected);
}

/// Rows, fans, stacks and nests of triangles, which trees do not divide well, and one triangle many
/// times.
#[test]
fn many_triangles_in_awkward_places_are_traced() {
    const COUNT: u32 = 50_000;
    type Corners = fn(f32) -> [Vec3; 3];
    let places: [(&str, Corners); 6] = [
        ("row", |at| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::X * at)),
        ("stack", |at| [Vec3::NEG_X, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::Z * at / COUNT as f32)),
        ("nest", |at| [Vec3::NEG_X, Vec3::X, Vec3::Y].map(|corner| corner * 0.999_f32.powf(at))),
        ("fan", |at| {
            let rim = |turn: f32| Vec3::new(turn.cos(), turn.sin(), 0.1 * turn);
            [Vec3::ZERO, rim(at * 1e-4), rim(at * 1e-4 + 0.5)]
        }),
        ("needles", |at| [Vec3::ZERO, Vec3::new(1.0, 0.0, at), Vec3::new(1.0, 1.0, -at)]),
        ("one", |_| [Vec3::ZERO, Vec3::X, Vec3::Y]),
    ];
    for (name, corners) in places {
        let mut mesh = Mesh { name: name.into(), ..Mesh::default() };
        for index in 0..COUNT {
            mesh.positions.extend(corners(index as f32));
            mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
        }
        mesh.fill_normals();
        let mut scene = furnace(1.0);
        // The middle of the first triangle, from as near as the extent of the row allows.
        let [a, b, c] = corners(0.0);
        let target = a * 0.4 + b * 0.3 + c * 0.3;
        let normal = (b - a).cross(c - a).normalize();
        add(&mut scene, mesh, matt(0.0), Mat4::IDENTITY);
        let tracer = PathTracer::new(&scene).unwrap();
        let origin = (target + normal * 0.01).as_dvec3();
        let distance = tracer.trace_distance(origin, -normal.as_dvec3()).unwrap_or(f64::INFINITY);
        assert!(distance < 0.02, "{name}: {distance}");
    }
}

#[test]
fn a_million_triangles_are_traced() {
    let mut scene = furnace(1.0);
    let mut mesh = shapes::sphere(500);
    assert_eq!(mesh.triangles.len(), 998_000);
    let other = shapes::cuboid();
    mesh.append(&other);
    add(&mut scene, mesh, matt(1.0), Mat4::IDENTITY);
    let (mean, error) = mean(&render(&scene, &camera([0.0, 0.5, 5.0], [0.0; 3]), &settings(16, 16)));
    assert!((mean - 1.0).abs() < 5.0 * error + 1e-3, "{mean} {error}");
}

type Change = fn(&mut Scene);

#[test]
fn broken_scenes_are_refused_by_name() {
    let broken = |change: fn(&mut Scene)| {
        let mut scene = furnace(1.0);
        scene.name = "broken".into();
        add(&mut scene, shapes::sphere(8), matt(1.0), Mat4::IDENTITY);
        change(&mut scene);
        PathTracer::new(&scene).err().map(|error| error.to_string()).unwrap_or_default()
    };
    let cases: [(Change, &str); 6] = [
        (|scene| scene.meshes[0].positions[3].y = f32::NAN, "meshes[0]"),
        (|scene| scene.meshes[0].positions[3].y = f32::INFINITY, "meshes[0]"),
        (|scene| scene.meshes[0].normals[3] = Vec3::ZERO, "meshes[0]"),
        (|scene| scene.meshes[0].triangles[0][1] = 1 << 30, "meshes[0]"),
        (|scene| scene.instances[0].material = 7, "instances[0]"),
        (|scene| scene.instances[0].world_from_local = Mat4::ZERO, "instances[0]"),
    ];
    for (change, place) in cases {
        let message = broken(change);
        assert!(message.contains("broken") && message.contains(place), "{message}");
    }
}

/// Many instances of a large mesh are counted before memory is taken for them.
#[test]
fn too_many_triangles_are_refused_before_they_are_placed() {
    let mut scene = Scene { name: "crowd".into(), ..Scene::default() };
    add(&mut scene, shapes::sphere(500), matt(1.0), Mat4::IDENTITY);
    scene.instances = vec![scene.instances[0].clone(); 100];
    let message = PathTracer::new(&scene).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(message.contains("crowd") && message.contains("99800000"), "{message}");
}

#[test]
fn settings_and_cameras_out_of_range_are_refused() {
    let tracer = PathTracer::new(&furnace(1.0)).unwrap();
    let view = camera([0.0, 0.0, 5.0], [0.0; 3]);
    let refused = |camera: &Camera, settings: &Settings| {
        tracer.render(camera, settings, &|_| ControlFlow::Continue(())).err().map(|error| error.to_string())
    };
    let with = |change: fn(&mut Settings)| {
        let mut settings = settings(4, 1);
        change(&mut settings);
        refused(&view, &settings).unwrap_or_default()
    };
    assert!(with(|settings| settings.size = [0, 4]).contains("size"));
    assert!(with(|settings| settings.size = [4, 16385]).contains("16384"));
    assert!(with(|settings| settings.size = [16384; 2]).contains("16384"));
    assert!(with(|settings| settings.samples = 3..3).contains("samples"));
    assert!(with(|settings| settings.samples = 0..u32::MAX).contains("samples"));
    let wide = with(|settings| settings.pixel_filter = PixelFilter::Gaussian { sigma_pixels: f32::NAN });
    assert!(wide.contains("sigma_pixels"), "{wide}");
    // The last samples that there are.
    assert_eq!(with(|settings| settings.samples = u32::MAX - 1..u32::MAX), "");
    for broken in [
        Camera { fov_y_rad: 0.0, ..view },
        Camera { fov_y_rad: f32::NAN, ..view },
        Camera { eye: Vec3::splat(f32::INFINITY), ..view },
        Camera { target: Vec3::NAN, ..view },
    ] {
        let message = refused(&broken, &settings(4, 1)).unwrap_or_default();
        assert!(message.contains("camera"), "{message}");
    }
    // A camera without direction looks somewhere.
    assert_eq!(refused(&Camera { target: view.eye, up: Vec3::ZERO, ..view }, &settings(4, 1)), None);
}

/// Lights without area, strength or distance.
#[test]
fn lights_of_no_size_and_no_distance_give_finite_pictures() {
    let mut scene = Scene { name: "test".into(), ..Scene::default() };
    add(&mut scene, shapes::plane(1), matt(0.5), Mat4::IDENTITY);
    // An emitter without area, and one that lies in the plane.
    let mut needle = shapes::plane(1);
    needle.positions.iter_mut().for_each(|position| position.x = 0.0);
    add(&mut scene, needle, lamp(1e3), Mat4::from_translation(Vec3::Y));
    add(&mut scene, shapes::plane(1), lamp(1.0), Mat4::from_scale(Vec3::splat(0.5)));
    let intensity = Vec3::splat(10.0);
    scene.lights = vec![
        // On the surface, and far away from it.
        Light::Point { position_world: Vec3::ZERO, intensity, range: f32::INFINITY },
        Light::Point { position_world: Vec3::splat(1e19), intensity, range: f32::MIN_POSITIVE },
        Light::Point { position_world: Vec3::Y, intensity: Vec3::ZERO, range: 1.0 },
        Light::Directional { direction_world: Vec3::Y, irradiance: Vec3::ONE, angular_diameter_rad: 1e-30 },
        Light::Directional { direction_world: Vec3::X, irradiance: Vec3::ONE, angular_diameter_rad: 3.0 },
    ];
    scene.environment = Some(Environment::new("peak", 2, 1, vec![[1e30, 0.0, 0.0], [0.0; 3]]).unwrap());
    let view = camera([0.0, 2.0, 0.5], [0.0; 3]);
    let tracer = PathTracer::new(&scene).unwrap();
    let film = tracer.render(&view, &settings(32, 16), &|_| ControlFlow::Continue(())).unwrap();
    assert_eq!(film.invalid(), 0);
    assert!(film.mean().as_flattened().iter().all(|value| value.is_finite()));
    assert!(film.clamped() > 0, "the environment is beyond what a film holds");
}
