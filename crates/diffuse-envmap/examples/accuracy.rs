//! Error of both methods against the reference integral on real environments.
//!
//! `cargo run --release -p diffuse-envmap --example accuracy -- FILE.hdr...`

#[path = "../tests/support/mod.rs"]
mod support;

use diffuse_envmap::{Distribution, Horizon, Method, Settings, model};
use support::{Probe, Query, directions, relative_mse};

fn main() {
    let mut probe = Probe::new();
    for path in std::env::args().skip(1) {
        let image = match image::open(&path) {
            Ok(image) => image.into_rgb32f(),
            Err(error) => {
                eprintln!("{path}: {error}");
                std::process::exit(1);
            }
        };
        let texels: Vec<[f32; 3]> = image.pixels().map(|p| p.0.map(|x| x.clamp(0.0, 65504.0))).collect();
        let map = probe.set_map(image.width(), image.height(), &texels);
        println!("{path}\n     t   brute 64  brute 1024  sheen 1..7   sheen 7");
        for t in [
            0.006, 0.012, 0.02, 0.03, 0.045, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 0.85, 0.9, 0.95,
            1.0,
        ] {
            row(&mut probe, &map, t);
        }
    }
}

fn row(probe: &mut Probe, map: &model::Map, t: f32) {
    let axes = directions(if t < 0.1 { 400 } else { 80 });
    let queries: Vec<_> = axes.iter().map(|&axis| Query::along(axis, t)).collect();
    let reference: Vec<[f64; 3]> = axes
        .iter()
        .map(|axis| {
            let axis = model::normalize_or(axis.map(f64::from), [0.0, 1.0, 0.0]);
            if t < 0.07 {
                model::integrate_over_lobe(map, axis, axis, f64::from(t), Horizon::Keep, 64, 128)
            } else {
                model::integrate_over_texels(map, axis, axis, f64::from(t), Horizon::Keep, 1)
            }
        })
        .collect();
    let brute = |rays| Settings {
        method: Method::Paper { rays, distribution: Distribution::Cosine, rotate: true },
        ..Settings::PAPER
    };
    let mut error = |settings: &Settings| relative_mse(&probe.radiance(settings, &queries), &reference);
    println!(
        "{t:6.3}  {:9.2e}  {:9.2e}  {:9.2e}  {:9.2e}",
        error(&brute(64)),
        error(&brute(1024)),
        error(&Settings::SHEEN),
        error(&Settings::SHEEN_FULL)
    );
}
