//! What is measured about the path tracer: rays per second, with one thread and with all, and the
//! seconds until a picture's relative error is small.

use crate::{
    Context, Scope, path_traced,
    technique::{
        Again, Benchmark, Fact, Failure, Frame, Make, Measurement, Role, Running, Subject, Technique,
        Throughput, TruthImage,
    },
    test_data,
};
use glam::{DVec3, Mat4, Vec3};
use image_error::{Image, noise_relative_mse, relative_mse};
use path_tracer::{Film, PathTracer, Settings};
use scene::{Camera, Environment, Instance, Limits, Material, Scene, builtin, load, shapes};
use std::{ops::ControlFlow, time::Instant};

/// The registration.
pub(crate) const TECHNIQUE: Technique = Technique {
    name: "path-tracer",
    summary: "The reference image of a scene, on the CPU.",
    libraries: &[],
    exemptions: &[],
    comparisons: |_| Vec::new(),
    benchmarks,
    measurements,
    stress: |_| Vec::new(),
    hostile_scenes: |_| Vec::new(),
    figures: |_| Vec::new(),
};

/// Rays of one round.
const RAYS: usize = 200_000;
/// Pixels a side of pictures.
const SIDE: u32 = 128;
/// The error at which a picture counts as done.
const SMALL: f64 = 1e-3;

fn benchmarks(_: &Scope) -> Vec<Benchmark> {
    let benchmark = |setting: &str, work: Work| Benchmark {
        scene: "teapot-100k".into(),
        setting: setting.into(),
        size: [SIDE; 2],
        truth: None,
        subjects: vec![
            subject("all threads", Role::Ours, 0, work),
            subject("one thread", Role::Baseline, 1, work),
        ],
        skips: Vec::new(),
    };
    vec![
        benchmark("camera rays", Work::CameraRays),
        benchmark("rays in all directions", Work::AnyRays),
        benchmark("paths", Work::Paths),
    ]
}

/// What a round traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Work {
    /// Rays of one camera, row by row: neighbours take the same way.
    CameraRays,
    /// Rays from the bounding box in every direction: none takes another's way.
    AnyRays,
    /// Whole paths, materials and environment included, one sample a pixel.
    Paths,
}

fn subject(method: &str, role: Role, threads: usize, work: Work) -> Subject {
    let start: Make<Running> = Box::new(move |_| start(threads, work));
    Subject { method: method.into(), role, series: None, start }
}

/// Builds the scene's hierarchy and a pool of so many threads (0: as many as there are).
fn start(threads: usize, work: Work) -> Result<Running, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let scene = teapot();
    let camera = scene.framing_camera(1.0);
    let tracer = PathTracer::new(&scene)?;
    let rays = match work {
        Work::CameraRays => camera_rays(&camera),
        Work::AnyRays => any_rays(&scene),
        Work::Paths => Vec::new(),
    };
    let per_frame = if work == Work::Paths { f64::from(SIDE * SIDE) } else { rays.len() as f64 };
    let unit = if work == Work::Paths { "paths" } else { "rays" };
    let settings = Settings::new([SIDE; 2], 1);
    let frame: Again<Frame> = Box::new(move |_| {
        if work == Work::Paths {
            pool.install(|| tracer.render(&camera, &settings, &|_| ControlFlow::Continue(())))?;
        } else {
            let hits = pool.install(|| count_hits(&tracer, &rays));
            if hits == 0 {
                return Err("no ray met the mesh".into());
            }
        }
        Ok(Frame::default())
    });
    let throughput = Some(Throughput { unit, per_frame });
    Ok(Running { prepare: None, frame, picture: None, memory_bytes: None, throughput })
}

fn count_hits(tracer: &PathTracer, rays: &[(DVec3, DVec3)]) -> usize {
    use rayon::prelude::*;
    rays.par_iter().filter(|(origin, direction)| tracer.trace_distance(*origin, *direction).is_some()).count()
}

/// A teapot of 102,400 triangles under a sky.
fn teapot() -> Scene {
    Scene {
        name: "teapot".into(),
        meshes: vec![shapes::teapot(40)],
        materials: vec![Material { roughness: 0.4, ..Material::default() }],
        instances: vec![Instance {
            name: "teapot".into(),
            mesh: 0,
            material: 0,
            world_from_local: Mat4::IDENTITY,
        }],
        environment: builtin::environment_sized("sky", 256),
        ..Scene::default()
    }
}

fn camera_rays(camera: &Camera) -> Vec<(DVec3, DVec3)> {
    let side = (RAYS as f64).sqrt() as u32;
    let pixels = (0..side).flat_map(|y| (0..side).map(move |x| [x, y]));
    let direction = |pixel| DVec3::from(crate::pixel_direction(camera, [side; 2], pixel)).normalize();
    pixels.map(|pixel| (camera.eye.as_dvec3(), direction(pixel))).collect()
}

/// Origins and directions on additive recurrences of irrational steps: evenly spread, the same on
/// every machine.
fn any_rays(scene: &Scene) -> Vec<(DVec3, DVec3)> {
    let (low, high) = scene.bounds().unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
    let part = |index: usize, prime: f64| (index as f64 * prime.sqrt()).fract();
    let ray = |index: usize| {
        let at = DVec3::new(part(index, 2.0), part(index, 3.0), part(index, 5.0));
        let y = 2.0 * part(index, 7.0) - 1.0;
        let (sine, cosine) = (std::f64::consts::TAU * part(index, 11.0)).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        let direction = DVec3::new(radius * cosine, y, radius * sine).normalize();
        (low.as_dvec3() + at * (high - low).as_dvec3(), direction)
    };
    (0..RAYS).map(ray).collect()
}

fn measurements(scope: &Scope) -> Vec<Measurement> {
    let long = if scope.quick { 1 << 12 } else { 1 << 13 };
    let rough = Material { metallic: 1.0, roughness: 0.5, ..Material::default() };
    let diffuse = Material { roughness: 1.0, ks: Some(Vec3::ZERO), ..Material::default() };
    [("diffuse", diffuse), ("rough-metal", rough)]
        .into_iter()
        .map(|(name, material)| Measurement {
            name: format!("time-to-error-{name}"),
            how: format!(
                "A {name} torus on a plane of the same material under a photographed environment, 64 x 64 pixels, \
                 all threads: the seconds until relMSE is {SMALL:e}. The error is taken to {long} samples of \
                 another seed, less those samples' own noise, at each doubling of the samples; the time is \
                 interpolated, because the error falls in proportion to it."
            ),
            run: Box::new(move |context| time_to_error(context, &material, long)),
        })
        .collect()
}

fn time_to_error(context: &mut Context, material: &Material, long: u32) -> Result<Vec<Fact>, Failure> {
    let environment = environment()?;
    let environment_name = environment.name.clone();
    let scene = on_a_plane(material, environment);
    let camera = Camera { eye: Vec3::new(2.2, 1.9, 2.8), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.7 };
    let reference = Settings { seed: 1, ..Settings::new([64; 2], long) };
    let truth = path_traced(context, &scene, &camera, &reference)?;
    let noise = noise_relative_mse(&truth.image, truth.variance_of_mean.as_deref().unwrap_or_default())?;
    if noise > 0.5 * SMALL {
        return Err(format!("the reference's own noise is {noise:.1e}: it cannot resolve {SMALL:e}").into());
    }
    let tracer = PathTracer::new(&scene)?;
    let mut film: Option<Film> = None;
    let (mut seconds, mut samples, mut error) = (0.0, 0, f64::INFINITY);
    while error > SMALL {
        if context.is_stopped() || samples >= long {
            return Err(format!("the error is {error:.1e} after {samples} samples a pixel").into());
        }
        let next = Settings { samples: samples..(2 * samples).max(4), ..Settings::new([64; 2], 0) };
        let started = Instant::now();
        let more = tracer.render(&camera, &next, &|_| ControlFlow::Continue(()))?;
        seconds += started.elapsed().as_secs_f64();
        samples = next.samples.end;
        let whole = match film.take() {
            Some(film) => Film::merge(vec![film, more])?,
            None => more,
        };
        error = error_of(&whole, &truth)? - noise;
        film = Some(whole);
    }
    let fact = |name: &str, value: f64, unit: &str, note: String| Fact {
        name: name.into(),
        value,
        unit: unit.into(),
        note,
    };
    let share = (error / SMALL).max(0.0);
    let note =
        format!("interpolated from relMSE {error:.2e} after {samples} samples a pixel in {seconds:.2} s");
    Ok(vec![
        fact("time until relMSE 1e-3", seconds * share, "s", note),
        fact("samples a pixel until then", f64::from(samples) * share, "", String::new()),
        fact("paths a second", 4096.0 * f64::from(samples) / seconds, "1/s", String::new()),
        fact("noise of the reference", noise, "relMSE", format!("{}; {environment_name}", truth.how)),
    ])
}

fn error_of(film: &Film, truth: &TruthImage) -> Result<f64, Failure> {
    let [width, height] = film.size().map(|side| side as usize);
    Ok(relative_mse(&Image::new(width, height, film.mean())?, &truth.image)?)
}

/// A photographed studio where the test data is there, else the built-in one.
fn environment() -> Result<Environment, Failure> {
    if let Some(path) = test_data("hdri/studio_small_03_1k.hdr") {
        return Ok(load::environment(&path, &Limits::default())?.0);
    }
    builtin::environment("studio").ok_or_else(|| "there is no built-in studio".into())
}

fn on_a_plane(material: &Material, environment: Environment) -> Scene {
    let placed = |name: &str, mesh, world_from_local| Instance {
        name: name.into(),
        mesh,
        material: 0,
        world_from_local,
    };
    Scene {
        name: "torus".into(),
        meshes: vec![shapes::torus(0.4, 96), shapes::plane(1)],
        materials: vec![material.clone()],
        instances: vec![
            placed("torus", 0, Mat4::IDENTITY),
            placed(
                "plane",
                1,
                Mat4::from_translation(Vec3::new(0.0, -0.4, 0.0)) * Mat4::from_scale(Vec3::splat(3.0)),
            ),
        ],
        environment: Some(environment),
        ..Scene::default()
    }
}
