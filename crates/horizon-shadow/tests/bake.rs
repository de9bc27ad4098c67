//! The GPU's tables against the CPU's, and the sweep's against the brute force search's.

mod bake_support;

use bake_support::{Field, bake, cpu_layer, gpu, horizons_deg, layer};
use horizon_shadow::{Baker, Contents, Precision, Search, Tables, Wrap};

/// Fraction of codes that differ, and the greatest difference of one.
fn difference(a: &[u8], b: &[u8], code_bytes: usize) -> (f64, u32) {
    assert_eq!(a.len(), b.len());
    let code = |bytes: &[u8]| bytes.iter().rev().fold(0_u32, |code, &byte| code << 8 | u32::from(byte));
    let pairs = a.chunks_exact(code_bytes).zip(b.chunks_exact(code_bytes));
    let differences: Vec<_> = pairs.map(|(a, b)| code(a).abs_diff(code(b))).filter(|&d| d > 0).collect();
    let greatest = differences.iter().copied().max().unwrap_or(0);
    (differences.len() as f64 / (a.len() / code_bytes) as f64, greatest)
}

#[test]
fn brute_force_on_the_gpu_is_the_cpus() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::rough([48, 40], 3);
    for (contents, code_bytes) in [
        (Contents::Candidates { count: 2, precision: Precision::Compact }, 2),
        (Contents::Candidates { count: 3, precision: Precision::Compact }, 2),
        (Contents::Candidates { count: 1, precision: Precision::Compact }, 2),
        (Contents::Candidates { count: 4, precision: Precision::Full }, 4),
        (Contents::Published(Tables::BetaAndDistance), 2),
        (Contents::Published(Tables::DistanceAndHeight), 1),
        (Contents::Flat, 1),
    ] {
        for wrap in [[Wrap::Repeat; 2], [Wrap::Clamp, Wrap::Repeat], [Wrap::Clamp; 2]] {
            let field = Field { wrap, ..field.clone() };
            let mut desc = field.desc(2, [-0.005, 0.02], 12.0);
            desc.contents = contents;
            let baked = bake(&gpu, &baker, &field, &desc, Search::BruteForce, u64::MAX);
            for azimuth in [0, 1, 5, 8, 14] {
                let (fraction, greatest) =
                    difference(&layer(&gpu, &baked, azimuth), &cpu_layer(&field, &desc, azimuth), code_bytes);
                println!("{contents:?} {wrap:?} {azimuth}: {fraction:.5} differ, at most by {greatest}");
            }
        }
    }
}

#[test]
fn the_sweep_finds_the_brute_forces_horizons() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    for (wrap, size) in [([Wrap::Repeat; 2], [128, 128]), ([Wrap::Clamp; 2], [96, 128])] {
        let field = Field { wrap, ..Field::rough(size, 7) };
        for curvature in [[0.0, 0.02], [0.015, 0.015], [-0.01, 0.0]] {
            let mut desc = field.desc(2, curvature, 24.0);
            desc.radius_texels = 64.0;
            desc.contents = Contents::Candidates { count: 2, precision: Precision::Full };
            let truth = bake(&gpu, &baker, &field, &desc, Search::BruteForce, u64::MAX);
            let swept = bake(&gpu, &baker, &field, &desc, Search::Sweep, u64::MAX);
            for (node, kappa) in desc.nodes().iter().enumerate() {
                let mut errors = Vec::new();
                for azimuth in 0..desc.azimuths {
                    let truth = horizons_deg(&field, &desc, &layer(&gpu, &truth, azimuth), node);
                    let swept = horizons_deg(&field, &desc, &layer(&gpu, &swept, azimuth), node);
                    errors.extend(truth.iter().zip(&swept).map(|(a, b)| (a - b).abs()));
                }
                errors.sort_by(f64::total_cmp);
                let mean = errors.iter().sum::<f64>() / errors.len() as f64;
                let p95 = errors[errors.len() * 95 / 100];
                let exact = errors.iter().filter(|&&e| e < 0.01).count() as f64 / errors.len() as f64;
                println!(
                    "{wrap:?} {kappa}: mean {mean:.4} p95 {p95:.4} max {:.2} same {exact:.4}",
                    errors[errors.len() - 1]
                );
            }
        }
    }
}
