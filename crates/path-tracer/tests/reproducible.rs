//! The same samples are the same bits, wherever and in whichever order they are traced, and other
//! samples are independent of them.

#![allow(clippy::float_cmp, reason = "black is exactly 0")]

mod common;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use common::{add, camera, lamp, matt, settings};
use glam::{Mat4, Vec3};
use path_tracer::{Film, PathTracer, PixelFilter, Progress, Settings};
use scene::{AlphaMode, Light, Material, Scene, shapes};

/// A little of everything.
fn scene() -> Scene {
    let environment = scene::builtin::environment_sized("studio", 64);
    let mut scene = Scene { name: "test".into(), environment, ..Scene::default() };
    add(&mut scene, shapes::plane(1), matt(0.7), Mat4::from_scale(Vec3::splat(4.0)));
    let glossy = Material { metallic: 1.0, roughness: 0.4, ..Material::default() };
    add(&mut scene, shapes::sphere(24), glossy, Mat4::from_translation(Vec3::new(-1.2, 1.0, 0.0)));
    let mut glass = Material { alpha_mode: AlphaMode::Blend, double_sided: true, ..matt(0.3) };
    glass.base_color.w = 0.5;
    add(&mut scene, shapes::torus(0.3, 24), glass, Mat4::from_translation(Vec3::new(1.2, 0.5, 0.0)));
    let above = Mat4::from_translation(Vec3::Y * 3.0) * Mat4::from_rotation_x(std::f32::consts::PI);
    add(&mut scene, shapes::plane(1), lamp(4.0), above);
    scene.lights.push(Light::Directional {
        direction_world: Vec3::new(0.6, 0.8, 0.0),
        irradiance: Vec3::ONE,
        angular_diameter_rad: 0.1,
    });
    scene
}

fn trace(tracer: &PathTracer, settings: &Settings) -> Film {
    let eye = camera([0.5, 2.0, 6.0], [0.0, 0.7, 0.0]);
    tracer.render(&eye, settings, &|_| ControlFlow::Continue(())).unwrap()
}

fn with_threads(count: usize, work: impl FnOnce() -> Film + Send) -> Film {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(work)
}

#[test]
fn any_threads_and_any_ranges_give_the_same_bits() {
    let scene = scene();
    let tracer = PathTracer::new(&scene).unwrap();
    let whole = Settings { pixel_filter: PixelFilter::Gaussian { sigma_pixels: 0.5 }, ..settings(24, 12) };
    let film = with_threads(1, || trace(&tracer, &whole));
    for threads in [2, 3, 7] {
        assert_eq!(with_threads(threads, || trace(&tracer, &whole)), film);
    }
    // Another tracer of the same scene, too.
    let other = PathTracer::new(&scene).unwrap();
    let part = |samples| trace(&other, &Settings { samples, ..whole.clone() });
    let parts = vec![part(5..6), part(9..12), part(0..5), part(6..9)];
    assert_eq!(Film::merge(parts).unwrap(), film);
    assert_ne!(part(12..24).mean(), film.mean());
    assert_ne!(trace(&tracer, &Settings { seed: 1, ..whole.clone() }).mean(), film.mean());
}

/// Differences of the means of disjoint samples over the root of their summed variances: over all
/// pixels their mean is 0 and their variance 1, so that the variance in the film is the true one.
#[test]
fn disjoint_samples_differ_as_their_variances_say() {
    let tracer = PathTracer::new(&scene()).unwrap();
    let part = |samples| trace(&tracer, &Settings { samples, ..settings(40, 0) });
    let (one, other) = (part(0..256), part(256..512));
    let (means, variances) = ([one.mean(), other.mean()], [one.variance_of_mean(), other.variance_of_mean()]);
    let mut scores = Vec::new();
    for pixel in 0..means[0].len() {
        let difference = f64::from(means[0][pixel][1]) - f64::from(means[1][pixel][1]);
        let variance = f64::from(variances[0][pixel][1]) + f64::from(variances[1][pixel][1]);
        if variance > 1e-12 {
            scores.push(difference / variance.sqrt());
        }
    }
    let count = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / count;
    let variance = scores.iter().map(|score| (score - mean).powi(2)).sum::<f64>() / (count - 1.0);
    println!("{count} pixels: mean {mean:.4}, variance {variance:.4}");
    assert!(count > 1000.0);
    // Five standard deviations of each estimate for normal scores.
    assert!(mean.abs() < 5.0 / count.sqrt(), "{mean}");
    assert!((variance - 1.0).abs() < 5.0 * (2.0 / count).sqrt(), "{variance}");
}

#[test]
fn progress_is_reported_and_a_break_leaves_whole_samples() {
    let tracer = PathTracer::new(&scene()).unwrap();
    let eye = camera([0.5, 2.0, 6.0], [0.0, 0.7, 0.0]);
    // More pixels than samples of a pass: a sample at a time.
    let settings = settings(300, 4);
    let most = AtomicU64::new(0);
    let mut films = Vec::new();
    let observe = |progress: Progress| {
        most.fetch_max(progress.done_samples, Ordering::Relaxed);
        assert_eq!(progress.total_samples, 4 * 300 * 300);
        assert!(progress.remaining().is_some());
        ControlFlow::Continue(())
    };
    let film =
        tracer.render_progressive(&eye, &settings, &observe, &mut |film| films.push(film.clone())).unwrap();
    assert_eq!(most.into_inner(), 4 * 300 * 300);
    assert_eq!(films.iter().map(Film::samples_per_pixel).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert_eq!(films.last(), Some(&film));

    let stop = |after: u64| {
        let observe = move |progress: Progress| {
            if progress.done_samples > after { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        tracer.render(&eye, &settings, &observe).unwrap()
    };
    let early = stop(250_000);
    assert_eq!(early.samples().to_string(), "0..2");
    assert_eq!(early, films[1]);
    // What is left can be traced later, over several passes as well.
    let rest = Settings { samples: 2..4, ..settings.clone() };
    let rest = tracer.render(&eye, &rest, &|_| ControlFlow::Continue(())).unwrap();
    assert_eq!(Film::merge(vec![early, rest]).unwrap(), film);
    assert_eq!(stop(0).samples_per_pixel(), 0);
    assert!(stop(0).mean().as_flattened().iter().all(|&value| value == 0.0));
}
