//! Scenes that try to break whole frames: environments, materials and geometry at their worst.

use crate::{
    Scope,
    technique::{Expectation, Failure, HostileScene},
};
use compositor::Settings;
use diffuse_envmap::{Base, Method};
use glam::{Affine2, Mat4, Quat, Vec3};
use scene::{
    Camera, ColorSpace, Environment, Instance, Material, Mesh, Scene, Texture, TextureRef, Wrap, builtin, shapes,
};

/// All of them; the largest map in whole runs alone.
pub(super) fn scenes(scope: &Scope) -> Vec<HostileScene> {
    let mut all = maps();
    if !scope.quick {
        all.push(on_balls("map of 8192 x 4096", "memory, and texels narrower than rounding", || {
            builtin::environment_sized("sky", 8192).ok_or_else(|| "no such environment".into())
        }));
    }
    all.extend(geometry());
    all.extend(offsets());
    all
}

const SIZE: [u32; 2] = [96, 64];

fn settings(of: impl Fn(&mut diffuse_envmap::Settings)) -> Vec<(String, Settings)> {
    let methods = [
        ("sheen", diffuse_envmap::Settings::SHEEN),
        ("sheen, every tap, slerp", diffuse_envmap::Settings { base: Base::Slerp, ..diffuse_envmap::Settings::SHEEN_FULL }),
        ("paper", diffuse_envmap::Settings::PAPER),
    ];
    let compose = |(name, mut technique): (&str, diffuse_envmap::Settings)| {
        of(&mut technique);
        (name.to_owned(), Settings { diffuse_envmap: Some(technique), ..Settings::default() })
    };
    methods.into_iter().map(compose).collect()
}

/// Balls of every kind of roughness, and a floor.
fn balls(environment: Environment) -> Scene {
    let metal = |roughness| Material { metallic: 1.0, roughness, ..Material::default() };
    let materials = vec![metal(0.0), metal(0.004), metal(0.1), metal(0.5), metal(1.0), Material::default()];
    let ball = |index: usize| Instance {
        name: format!("ball {index}"),
        mesh: 0,
        material: index,
        world_from_local: Mat4::from_translation(Vec3::new(2.2 * index as f32 - 5.5, 0.0, 0.0)),
    };
    let floor = Instance {
        name: "floor".into(),
        mesh: 1,
        material: 2,
        world_from_local: Mat4::from_translation(Vec3::NEG_Y) * Mat4::from_scale(Vec3::splat(8.0)),
    };
    Scene {
        name: "balls".into(),
        meshes: vec![shapes::sphere(32), shapes::plane(1)],
        instances: (0..materials.len()).map(ball).chain([floor]).collect(),
        materials,
        environment: Some(environment),
        ..Scene::default()
    }
}

fn balls_camera() -> Camera {
    Camera { eye: Vec3::new(0.0, 3.0, 14.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.7 }
}

fn on_balls(
    name: &str,
    why: &'static str,
    environment: impl Fn() -> Result<Environment, Failure> + 'static,
) -> HostileScene {
    HostileScene {
        name: name.into(),
        why,
        scene: Box::new(move || Ok(balls(environment()?))),
        camera: Some(balls_camera()),
        size: SIZE,
        settings: settings(|_| {}),
        expectation: Expectation::Picture,
    }
}

/// An environment whose pixels were not repaired, as a host could make it.
fn raw(width: u32, height: u32, f: impl Fn(u32, u32) -> [f32; 3]) -> Result<Environment, Failure> {
    let count = width * height;
    let mut made = Environment::new("raw", width, height, vec![[0.5; 3]; count as usize])?;
    made.pixels = (0..count).map(|i| f(i % width, i / width)).collect();
    Ok(made)
}

fn maps() -> Vec<HostileScene> {
    let of_size = |name: &str, width: u32, height: u32| {
        on_balls(name, "sizes at which cells, levels and neighbours run out", move || {
            raw(width, height, |x, y| [x as f32, 1.0, 900.0 * (y % 3) as f32])
        })
    };
    vec![
        of_size("map of 1 x 1", 1, 1),
        of_size("map of 2 x 1", 2, 1),
        of_size("map of 3 x 5", 3, 5),
        of_size("map of 1 x 33", 1, 33),
        of_size("map of 257 x 1", 257, 1),
        on_balls("black map", "a mean of 0 under every quotient", || raw(64, 32, |_, _| [0.0; 3])),
        on_balls("one texel that is not black", "all the power in one cell", || {
            raw(64, 32, |x, y| if (x, y) == (20, 9) { [1e-6; 3] } else { [0.0; 3] })
        }),
        on_balls("sun of one texel of 1e5", "above half floats, 2e5 times the sky", || {
            raw(256, 128, |x, y| if (x, y) == (80, 40) { [1e5; 3] } else { [0.3, 0.4, 0.6] })
        }),
        on_balls("suns at both poles and on the seam", "texels without width, and neighbours across the edge", || {
            raw(256, 128, |x, y| match (x, y) {
                (_, 0 | 127) => [6e4; 3],
                (0, 64) | (255, 63) => [5e4, 0.0, 0.0],
                _ => [0.2; 3],
            })
        }),
        on_balls("texels that are no radiance", "infinities, NaN, negative, and beyond half floats", || {
            raw(64, 32, |x, y| match (x % 16, y % 8) {
                (3, 2) => [f32::INFINITY; 3],
                (7, 3) => [f32::NAN, 1.0, 1.0],
                (9, 5) => [-1.0, -1e30, 0.5],
                (12, 6) => [65505.0, 3e38, 1e-40],
                _ => [0.5; 3],
            })
        }),
        on_balls("nothing but infinity", "no texel is left to go by", || raw(16, 8, |_, _| [f32::INFINITY; 3])),
        on_balls("no environment", "nothing to light with", || raw(1, 1, |_, _| [0.0; 3]))
            .without_environment(),
    ]
}

impl HostileScene {
    fn without_environment(self) -> Self {
        let scene = self.scene;
        Self { scene: Box::new(move || Ok(Scene { environment: None, ..scene()? })), ..self }
    }
}

/// A lone mesh under the sky.
fn lone(
    name: &str,
    why: &'static str,
    camera: Camera,
    mesh: impl Fn() -> Mesh + 'static,
    material: impl Fn() -> Material + 'static,
) -> HostileScene {
    let scene = move || {
        let sky = builtin::environment_sized("sky", 256).ok_or("no such environment")?;
        let standing = Mat4::from_quat(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
        Ok(crate::scene_of(mesh(), material(), standing, sky))
    };
    HostileScene {
        name: name.into(),
        why,
        scene: Box::new(scene),
        camera: Some(camera),
        size: SIZE,
        settings: settings(|_| {}),
        expectation: Expectation::Picture,
    }
}

fn geometry() -> Vec<HostileScene> {
    let from = |eye| Camera { eye, target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.7 };
    let metal = |roughness: f32| move || Material { metallic: 1.0, roughness, double_sided: true, ..Material::default() };
    let plane = || shapes::plane(4);
    let turned = |normal: Vec3| {
        move || {
            let mut mesh = shapes::plane(4);
            mesh.normals.fill(normal);
            mesh
        }
    };
    vec![
        lone("seen along the normal", "the frame's pole at (0, 0, -1)", from(Vec3::new(0.0, 0.0, -3.0)), plane, metal(0.5)),
        lone("normals that face away", "r = -n at t = 0.5, where the axis vanishes", from(Vec3::new(0.0, 0.0, 3.0)), turned(Vec3::NEG_Y), metal(0.5)),
        lone("normals across the view", "reflections along the view", from(Vec3::new(0.0, 0.0, 3.0)), turned(Vec3::X), metal(0.2)),
        lone("normals of no length", "nothing to reflect about", from(Vec3::new(0.0, 0.0, 3.0)), turned(Vec3::ZERO), metal(0.4)),
        lone("normals that are not numbers", "NaN through every product", from(Vec3::new(0.0, 0.0, 3.0)), turned(Vec3::NAN), metal(0.4)),
        lone("grazing view", "lobes that dip below the horizon", from(Vec3::new(0.0, 3.0, 0.004)), plane, metal(0.25)),
        lone("roughness of 40", "beyond its range", from(Vec3::new(1.0, 0.0, 3.0)), plane, metal(40.0)),
        lone("roughness that is not a number", "NaN in a material", from(Vec3::new(1.0, 0.0, 3.0)), plane, metal(f32::NAN)),
        checkerboard(),
    ]
}

/// A checkerboard of mirror and matt, one texel a check: neighbouring pixels run different code.
fn checkerboard() -> HostileScene {
    let texture = || {
        let texel = |i: u32| [255, if (i % 32 + i / 32) % 2 == 0 { 0 } else { 255 }, 255, 255];
        Texture {
            name: "checkerboard".into(),
            width: 32,
            height: 32,
            rgba: (0..1024).flat_map(texel).collect(),
            color_space: ColorSpace::Linear,
        }
    };
    let reference = TextureRef {
        texture: 0,
        texture_from_vertex_uv: Affine2::from_scale(glam::Vec2::splat(2.0)),
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    };
    let checked = lone(
        "checkerboard of mirror and matt",
        "control flow that differs from pixel to pixel, with lookups inside",
        Camera { eye: Vec3::new(0.5, 0.5, 3.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.7 },
        || shapes::plane(1),
        move || Material { metallic: 1.0, metallic_roughness_texture: Some(reference.clone()), ..Material::default() },
    );
    let scene = checked.scene;
    HostileScene { scene: Box::new(move || Ok(Scene { textures: vec![texture()], ..scene()? })), ..checked }
}

/// Settings that are no numbers or far out of range.
fn offsets() -> Vec<HostileScene> {
    let sky = || builtin::environment_sized("sky", 128).ok_or_else(|| "no such environment".into());
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30];
    bad.into_iter()
        .map(|value| HostileScene {
            settings: settings(|technique| {
                technique.roughness_offset = value;
                technique.intensity = value;
                technique.one_tap_contrast = value;
                if let Method::Paper { rays, .. } = &mut technique.method {
                    *rays = 0;
                }
            }),
            ..on_balls(&format!("every setting {value:e}"), "settings that are no numbers or far out of range", sky)
        })
        .collect()
}
