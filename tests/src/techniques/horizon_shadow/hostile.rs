//! Height maps, placements and lights at their worst, through whole frames of the compositor.

use crate::{
    Scope,
    technique::{Expectation, Failure, HostileScene},
};
use compositor::Settings;
use glam::{Mat4, Vec2, Vec3};
use horizon_shadow::Method;
use scene::{Camera, HeightMap, HeightRef, Instance, Light, Material, Mesh, Scene, shapes};

/// All of them; the widest map in whole runs alone.
pub(super) fn scenes(scope: &Scope) -> Vec<HostileScene> {
    let mut all = maps();
    if !scope.quick {
        all.push(on_ball("map 8193 texels wide", "more than many devices' textures hold", || {
            map(8193, 1, |x, _| (x % 7) as f32 / 6.0)
        }));
    }
    all.extend(placements());
    all.extend(lights());
    all.extend(settings_out_of_range());
    if scope.quick {
        for scene in &mut all {
            scene.settings.truncate(2);
        }
    }
    all
}

const SIZE: [u32; 2] = [64, 48];

/// Every method with few azimuths, and ours with all that can be switched on.
fn settings(of: impl Fn(&mut horizon_shadow::Settings)) -> Vec<(String, Settings)> {
    let base =
        horizon_shadow::Settings { azimuths: 8, radius_texels: 16.0, ..horizon_shadow::Settings::SHEEN };
    let ways = [
        ("sheen", horizon_shadow::Settings { ambient: true, ..base }),
        ("certified", horizon_shadow::Settings { method: Method::Certified, prefilter: false, ..base }),
        ("paper", horizon_shadow::Settings { method: Method::Paper, ..base }),
        ("marched", horizon_shadow::Settings { method: Method::Marched, march_steps: 32, ..base }),
    ];
    let compose = |(name, mut technique): (&str, horizon_shadow::Settings)| {
        of(&mut technique);
        (name.to_owned(), Settings { horizon_shadow: Some(technique), ..Settings::default() })
    };
    ways.into_iter().map(compose).collect()
}

fn map(width: u32, height: u32, f: impl Fn(u32, u32) -> f32) -> HeightMap {
    let heights = (0..width * height).map(|i| f(i % width, i / width)).collect();
    HeightMap { name: "hostile".into(), width, height, heights }
}

/// A light from a direction.
fn sun(direction: Vec3, angular_diameter_rad: f32) -> Light {
    Light::Directional {
        direction_world: direction.normalize_or(Vec3::Y),
        irradiance: Vec3::splat(2.0),
        angular_diameter_rad,
    }
}

/// One mesh with one height map under one light.
fn scene(mesh: Mesh, map: HeightMap, height: HeightRef, world_from_local: Mat4, light: Light) -> Scene {
    Scene {
        name: "hostile relief".into(),
        meshes: vec![mesh],
        materials: vec![Material { height: Some(height), double_sided: true, ..Material::default() }],
        height_maps: vec![map],
        instances: vec![Instance { name: "object".into(), mesh: 0, material: 0, world_from_local }],
        lights: vec![light],
        ..Scene::default()
    }
}

const HEIGHT: HeightRef = HeightRef { map: 0, height_scale: 0.05, uv_scale: [4.0, 2.0] };
const LOW_SUN: Vec3 = Vec3::new(0.9, 0.3, 0.4);

fn hostile(
    name: &str,
    why: &'static str,
    scene: impl Fn() -> Result<Scene, Failure> + 'static,
) -> HostileScene {
    HostileScene {
        name: name.into(),
        why,
        scene: Box::new(scene),
        camera: None,
        size: SIZE,
        settings: settings(|_| {}),
        expectation: Expectation::Picture,
    }
}

/// A map on a ball.
fn on_ball(name: &str, why: &'static str, map: impl Fn() -> HeightMap + 'static) -> HostileScene {
    hostile(name, why, move || {
        Ok(scene(shapes::sphere(24), map(), HEIGHT, Mat4::IDENTITY, sun(LOW_SUN, 0.0)))
    })
}

fn maps() -> Vec<HostileScene> {
    vec![
        on_ball("map of 1 x 1", "every neighbour is the texel itself", || map(1, 1, |_, _| 0.7)),
        on_ball("map of 1 x 33", "one column of no power of two", || map(1, 33, |_, y| (y % 5) as f32 / 4.0)),
        on_ball("map of 17 x 1", "one row", || map(17, 1, |x, _| (x % 3) as f32 / 2.0)),
        on_ball("map of 37 x 23", "no power of two, no multiple of a tile", || {
            map(37, 23, |x, y| ((x * 7 + y * 13) % 11) as f32 / 10.0)
        }),
        on_ball("one height everywhere", "no bump at all, at height 4", || map(16, 16, |_, _| 4.0)),
        on_ball("heights about 0", "negative heights", || map(16, 16, |x, y| ((x + y) % 3) as f32 - 1.0)),
        on_ball("one texel alone", "a spike", || map(32, 32, |x, y| f32::from(u8::from((x, y) == (9, 11))))),
        on_ball("steps", "slopes without bound", || map(32, 32, |x, _| f32::from(u8::from(x % 16 < 8)))),
        on_ball("heights that are no numbers", "NaN and infinities between heights", || {
            map(16, 16, |x, y| match (x % 8, y % 8) {
                (1, 2) => f32::NAN,
                (4, 4) => f32::INFINITY,
                (6, 1) => f32::NEG_INFINITY,
                _ => ((x * y) % 5) as f32 / 4.0,
            })
        }),
        on_ball("nothing but NaN", "no height is left to go by", || map(8, 8, |_, _| f32::NAN)),
        on_ball("heights of 1e30", "squares beyond floats", || map(8, 8, |x, y| 1e30 * ((x + y) % 2) as f32)),
        on_ball("heights of 1e-40", "numbers that adapters flush", || {
            map(8, 8, |x, y| 1e-40 * ((x + y) % 2) as f32)
        }),
    ]
}

fn bumps() -> HeightMap {
    map(32, 32, |x, y| ((x / 4 + y / 4) % 2) as f32)
}

fn placements() -> Vec<HostileScene> {
    let placed = |name: &str, why, mesh: fn() -> Mesh, height: HeightRef, world_from_local: Mat4| {
        hostile(name, why, move || {
            Ok(scene(mesh(), bumps(), height.clone(), world_from_local, sun(LOW_SUN, 0.0)))
        })
    };
    let ball = || shapes::sphere(24);
    let scaled = |factor: f32| {
        (HeightRef { height_scale: 0.05 * factor, ..HEIGHT }, Mat4::from_scale(Vec3::splat(factor)))
    };
    let ((small, to_small), (large, to_large)) = (scaled(1e-3), scaled(1e3));
    let mirrored = || {
        let mut mesh = shapes::sphere(24);
        mesh.uvs.iter_mut().for_each(|uv| uv.x = 1.0 - uv.x);
        mesh
    };
    let collapsed = || {
        let mut mesh = shapes::sphere(24);
        mesh.uvs.fill(Vec2::new(0.3, 0.3));
        mesh
    };
    let torn = || {
        let mut mesh = shapes::saddle(8);
        mesh.triangles.truncate(61);
        mesh.triangles.push([0, 0, 1]);
        mesh.positions[40] = mesh.positions[41];
        mesh
    };
    let without_uvs = || {
        let mut mesh = shapes::sphere(24);
        mesh.uvs.clear();
        mesh.tangents.clear();
        mesh
    };
    vec![
        placed(
            "texels of 100 : 1",
            "anisotropic texture coordinates",
            ball,
            HeightRef { uv_scale: [100.0, 1.0], ..HEIGHT },
            Mat4::IDENTITY,
        ),
        placed("a ball of a millimetre", "curvature of 1000 / m", ball, small, to_small),
        placed("a ball of a kilometre", "curvature of 0.001 / m", ball, large, to_large),
        placed(
            "a ball squeezed flat",
            "a placement that is no rotation",
            ball,
            HEIGHT,
            Mat4::from_scale(Vec3::new(1.0, 1e-3, 1.0)),
        ),
        placed(
            "a mirrored ball",
            "a placement that turns triangles over",
            ball,
            HEIGHT,
            Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)),
        ),
        placed("mirrored texture coordinates", "u runs the other way", mirrored, HEIGHT, Mat4::IDENTITY),
        placed("one texture coordinate for all", "a frame without area", collapsed, HEIGHT, Mat4::IDENTITY),
        placed("a torn saddle", "open borders, and triangles without area", torn, HEIGHT, Mat4::IDENTITY),
        placed(
            "bumps as high as the ball is wide",
            "1 + kappa h far from 1",
            ball,
            HeightRef { height_scale: 2.0, ..HEIGHT },
            Mat4::IDENTITY,
        ),
        placed(
            "pits as deep as the ball",
            "heights below its centre",
            ball,
            HeightRef { height_scale: -2.0, ..HEIGHT },
            Mat4::IDENTITY,
        ),
        placed(
            "no height scale",
            "all bumps flat",
            ball,
            HeightRef { height_scale: 0.0, ..HEIGHT },
            Mat4::IDENTITY,
        ),
        placed(
            "uv scale of 0",
            "the map's first texel everywhere",
            ball,
            HeightRef { uv_scale: [0.0, 0.0], ..HEIGHT },
            Mat4::IDENTITY,
        ),
        HostileScene {
            expectation: Expectation::Refusal("texture coordinates"),
            ..placed(
                "a mesh without texture coordinates",
                "nobody can say where the map lies",
                without_uvs,
                HEIGHT,
                Mat4::IDENTITY,
            )
        },
    ]
}

fn lights() -> Vec<HostileScene> {
    let lit = |name: &str, why, light: Light| {
        let ground = move || Ok(scene(shapes::plane(4), bumps(), HEIGHT, Mat4::IDENTITY, light));
        let camera =
            Camera { eye: Vec3::new(0.0, 2.0, 3.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.8 };
        HostileScene { camera: Some(camera), ..hostile(name, why, ground) }
    };
    let point =
        |position_world| Light::Point { position_world, intensity: Vec3::splat(2.0), range: f32::INFINITY };
    vec![
        lit("light at the zenith", "no azimuth", sun(Vec3::Y, 0.0)),
        lit("light at the horizon", "every bump shadows all behind it", sun(Vec3::X, 0.0)),
        lit("light from behind along -x", "azimuth exactly +-pi", sun(Vec3::new(-1.0, 0.2, -0.0), 0.0)),
        lit("light from below", "the night side", sun(Vec3::new(0.3, -1.0, 0.1), 0.0)),
        lit("a light as wide as the sky", "an angular diameter of pi", sun(LOW_SUN, std::f32::consts::PI)),
        lit("a lamp on the ground", "a light at distance 0", point(Vec3::ZERO)),
        lit("a lamp that is nowhere", "NaN in a light", point(Vec3::NAN)),
    ]
}

/// Settings that are no numbers or far out of range.
fn settings_out_of_range() -> Vec<HostileScene> {
    [f32::NAN, f32::INFINITY, -1e30]
        .into_iter()
        .map(|value| HostileScene {
            settings: settings(|technique| {
                technique.radius_texels = value;
                technique.azimuths = 0;
                technique.candidates = 99;
                technique.march_steps = u32::MAX;
                technique.azimuths_per_prepare = 0;
            }),
            expectation: Expectation::Refusal("horizon-shadow: "),
            ..on_ball(&format!("a search radius of {value:e}"), "settings that are no numbers", bumps)
        })
        .collect()
}
