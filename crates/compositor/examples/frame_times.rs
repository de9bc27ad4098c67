//! What each pass of a frame takes on this machine's adapter, and what each method of
//! diffuse-envmap takes for the same picture.
//!
//! `cargo run --release -p compositor --example frame_times -- SCENE [ENVIRONMENT]`
//!
//! Renders 512 x 512 pixels; every time is the median of 9 frames after 2 of warm-up, by the
//! adapter's own clock. Methods take turns within one process, so that their ratios hold.

use std::path::Path;

use compositor::{Compositor, Desc, Frame, SceneGpu, Settings};
use diffuse_envmap::{Distribution, Method, Settings as Lighting};
use gpu_context::{Gpu, HeadlessDesc, Timer, Timing};

const SIZE: [u32; 2] = [512, 512];
const WARM_UP: usize = 2;
const FRAMES: usize = 9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let Some(path) = arguments.next() else { return Err("usage: frame_times SCENE [ENVIRONMENT]".into()) };
    let limits = scene::Limits::default();
    let mut scene = scene::load::load_scene(Path::new(&path), &limits)?;
    if let Some(path) = arguments.next() {
        scene.environment = Some(scene::load::environment(Path::new(&path), &limits)?.0);
    } else if scene.environment.is_none() {
        scene.environment = scene::builtin::environment("studio");
    }
    let gpu = Gpu::headless(&HeadlessDesc::default())?;
    let uploaded = SceneGpu::upload(&gpu, &scene)?;
    let camera = scene.camera.unwrap_or_else(|| scene.framing_camera(1.0));
    println!("{}: {} triangles, {} x {} pixels", scene.name, scene.triangle_count(), SIZE[0], SIZE[1]);
    println!("{}", gpu.adapter_label());

    let paper = |rays| Lighting {
        method: Method::Paper { rays, distribution: Distribution::Cosine, rotate: true },
        ..Lighting::PAPER
    };
    let methods =
        [("Sheen".to_owned(), Lighting::SHEEN), ("Sheen, every tap".to_owned(), Lighting::SHEEN_FULL)];
    let methods: Vec<_> = methods
        .into_iter()
        .chain([1, 16, 64, 256, 1024].map(|rays| (format!("paper, {rays} rays"), paper(rays))))
        .collect();
    let desc = Desc { display_format: wgpu::TextureFormat::Rgba8UnormSrgb };
    let mut compositors =
        methods.iter().map(|_| Compositor::new(&gpu, &desc)).collect::<Result<Vec<_>, _>>()?;
    let mut times = vec![Vec::new(); methods.len()];
    for round in 0..WARM_UP + FRAMES {
        for (index, (_, lighting)) in methods.iter().enumerate() {
            let settings = Settings { diffuse_envmap: Some(*lighting), ..Settings::default() };
            let mut timer = Timer::new(&gpu)?;
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let frame = Frame { scene: &uploaded, camera: &camera, size: SIZE, timer: &timer };
            compositors[index].render(&gpu, &mut encoder, &settings, &frame)?;
            timer.resolve(&mut encoder);
            gpu.queue().submit([encoder.finish()]);
            timer.end_frame()?;
            gpu.wait()?;
            let timings = timer.finished_frame().unwrap_or_default();
            if round == 0 && index == 0 {
                println!("first frame, which builds the chain:");
                print_passes(&timings);
            }
            if round >= WARM_UP {
                times[index].push(timings);
            }
        }
    }
    println!("passes of a later frame (Sheen):");
    for label in times[0][0].iter().map(|timing| &timing.label) {
        println!("  {label:16} {}", shown(median(&times[0], label)));
    }
    let ours = median(&times[0], "diffuse-envmap");
    println!("diffuse-envmap by method:");
    for ((name, _), frames) in methods.iter().zip(&times) {
        let time = median(frames, "diffuse-envmap");
        let ratio =
            time.zip(ours).map_or(String::new(), |(time, ours)| format!("{:8.1} x Sheen", time / ours));
        println!("  {name:18} {}{ratio}", shown(time));
    }
    Ok(())
}

fn print_passes(timings: &[Timing]) {
    for timing in timings {
        println!("  {:16} {}", timing.label, shown(timing.time_ms));
    }
}

fn shown(time_ms: Option<f64>) -> String {
    time_ms.map_or("not measurable here".to_owned(), |time| format!("{time:9.2} ms"))
}

/// The median time of a pass over frames.
fn median(frames: &[Vec<Timing>], label: &str) -> Option<f64> {
    let mut times: Vec<f64> = frames
        .iter()
        .filter_map(|timings| timings.iter().find(|timing| timing.label == label)?.time_ms)
        .collect();
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}
