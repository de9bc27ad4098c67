//! Incoherent rays per second: random origins and directions within the bounds of a mesh of about
//! 100 000 triangles, on one thread and on all.
//!
//! ```text
//! cargo run --release -p path-tracer --example rays_per_second
//! ```

use std::time::Instant;

use glam::{DVec3, Mat4};
use path_tracer::PathTracer;
use rayon::prelude::*;
use scene::{Instance, Material, Scene, shapes};

/// Rays of one run; the fastest of many short runs is the least disturbed.
const RAYS: u32 = 1 << 18;

const RUNS: u32 = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene { name: "torus".into(), ..Scene::default() };
    scene.meshes.push(shapes::torus(0.3, 158));
    scene.materials.push(Material { double_sided: true, ..Material::default() });
    let world_from_local = Mat4::IDENTITY;
    scene.instances.push(Instance { name: String::new(), mesh: 0, material: 0, world_from_local });
    let (low, high) = scene.bounds().ok_or("no bounds")?;
    let (low, size) = (low.as_dvec3(), (high - low).as_dvec3());

    let begin = Instant::now();
    let tracer = PathTracer::new(&scene)?;
    println!("{} triangles, prepared in {:.2} s", scene.triangle_count(), begin.elapsed().as_secs_f64());

    let trace = |index: u32| {
        let [x, y, z, turn, height] =
            std::array::from_fn(|dimension| uniform(u64::from(index) * 5 + dimension as u64));
        let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
        let up = 2.0 * height - 1.0;
        let across = (1.0 - up * up).sqrt();
        let direction = DVec3::new(across * cosine, up, across * sine).normalize();
        u64::from(tracer.trace_distance(low + size * DVec3::new(x, y, z), direction).is_some())
    };
    let measure = |threads: usize| -> Result<f64, Box<dyn std::error::Error>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let run = || (0..RAYS).into_par_iter().with_min_len(4096).map(trace).sum::<u64>();
        let times = (0..RUNS).map(|_| {
            let begin = Instant::now();
            let hits = pool.install(run);
            (begin.elapsed().as_secs_f64(), hits)
        });
        let (seconds, hits) =
            times.fold((f64::INFINITY, 0), |best, time| if time.0 < best.0 { time } else { best });
        let rate = f64::from(RAYS) / seconds;
        let share = hits as f64 / f64::from(RAYS);
        println!("{threads} threads: {:.2} million rays a second ({share:.2} of them hit)", rate * 1e-6);
        Ok(rate)
    };
    let one = measure(1)?;
    let threads = std::thread::available_parallelism()?.get();
    let all = measure(threads)?;
    println!("{threads} threads are {:.2} times as fast as one", all / one);
    Ok(())
}

/// A number of 0..1 that looks random (the finalizer of `SplitMix64`).
fn uniform(index: u64) -> f64 {
    let mut x = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
