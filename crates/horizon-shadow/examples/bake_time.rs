//! Times bakes of a rough map: brute force (one azimuth, times all) and sweep on the GPU, and brute
//! force on the CPU (some rows, times all).
//!
//! `cargo run --release -p horizon-shadow --example bake_time -- [SIZE] [RADIUS]`, texels.

use std::{ops::ControlFlow, time::Instant};

use gpu_context::{HeadlessDesc, upload};
use horizon_shadow::{Baker, Contents, Gpu, Heights, Parts, Precision, Search, TableDesc, Wrap, cpu, wgpu};

const AZIMUTHS: u32 = 32;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).map(|argument| argument.parse::<u32>());
    let size = numbers.next().transpose()?.unwrap_or(1024);
    let radius = numbers.next().transpose()?.unwrap_or(size / 2);
    let gpu = Gpu::headless(&HeadlessDesc::default())?;
    let heights = rough(size);
    let bytes = bytemuck::cast_slice(&heights);
    let texture =
        upload::texture_2d(&gpu, "heights", size, size, wgpu::TextureFormat::R32Float, bytes, None)?;
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let desc = TableDesc {
        size: [size, size],
        azimuths: AZIMUTHS,
        contents: Contents::Candidates { count: 2, precision: Precision::Compact },
        wrap: [Wrap::Repeat; 2],
        curvature_per_texel: [0.0, 0.02],
        texels_per_height: size as f32 / 8.0,
        radius_texels: radius as f32,
    };
    println!("{}; {size} x {size}, {AZIMUTHS} azimuths, radius {radius}", gpu.adapter_label());
    let baker = Baker::new(&gpu)?;
    // Eleven and a quarter degrees: neither along the axes nor along the diagonals.
    let brute_s = seconds(&gpu, &baker, &desc, &view, Search::BruteForce, 0b10)? * f64::from(AZIMUTHS);
    let sweep_s = seconds(&gpu, &baker, &desc, &view, Search::Sweep, u64::MAX)?;
    println!(
        "brute force {brute_s:.1} s (from one azimuth), sweep {sweep_s:.2} s: {:.1} x",
        brute_s / sweep_s
    );

    // On the CPU a map of few rows takes as long for each texel.
    let rows = 64.min(size);
    let strip = &heights[..(rows * size) as usize];
    let desc = TableDesc { size: [size, rows], ..desc };
    let field = cpu::HeightField { size: desc.size, values: strip, range: [0.0, 1.0], wrap: desc.wrap };
    let start = Instant::now();
    cpu::bake(&field, &desc, 0b10, &|_| ControlFlow::Continue(()))?;
    let cpu_s = start.elapsed().as_secs_f64() * f64::from(AZIMUTHS) * f64::from(size) / f64::from(rows);
    println!("brute force on the CPU {cpu_s:.1} s (from one azimuth of {rows} rows)");
    Ok(())
}

fn seconds(
    gpu: &Gpu,
    baker: &Baker,
    desc: &TableDesc,
    view: &wgpu::TextureView,
    search: Search,
    azimuths: u64,
) -> Result<f64, Box<dyn std::error::Error>> {
    let heights = Heights { view, range: [0.0, 1.0] };
    let mut bake = baker.start(gpu, desc, &heights, Parts::default(), azimuths)?;
    gpu.wait()?;
    let start = Instant::now();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    baker.record(gpu, &mut encoder, &mut bake, search, u32::MAX)?;
    gpu.queue().submit([encoder.finish()]);
    gpu.wait()?;
    Ok(start.elapsed().as_secs_f64())
}

/// Sines of ever shorter waves in odd directions, each half as high as the one before: 0..1.
fn rough(size: u32) -> Vec<f32> {
    let height = |x: f32, y: f32| -> f32 {
        let octave = |i: i32| {
            let turn = 2.4 * i as f32;
            let waves = (3 << i) as f32 * std::f32::consts::TAU / size as f32;
            0.5_f32.powi(i) * ((x * turn.cos() + y * turn.sin()) * waves + turn).sin()
        };
        (0..7).map(octave).sum::<f32>() / 4.0 + 0.5
    };
    (0..size * size).map(|i| height((i % size) as f32, (i / size) as f32).clamp(0.0, 1.0)).collect()
}
