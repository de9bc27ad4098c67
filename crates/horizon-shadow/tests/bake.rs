//! The GPU's tables against the CPU's, and the sweep's against the brute force search's.

mod bake_support;

use bake_support::{Field, bake, cpu_layer, gpu, horizons_deg, layer};
use horizon_shadow::{Baker, Contents, Gpu, Precision, Search, TableDesc, Tables, Wrap};

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
        (Contents::Candidates { count: 1, precision: Precision::Compact }, 2),
        (Contents::Candidates { count: 2, precision: Precision::Compact }, 2),
        (Contents::Candidates { count: 3, precision: Precision::Compact }, 2),
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
                let on_gpu = layer(&gpu, &baked, azimuth);
                let on_cpu = cpu_layer(&field, &desc, azimuth);
                assert_eq!(on_gpu.len() as u32, 48 * 40 * desc.texel_bytes());
                // Where a device contracts products and sums, or takes another arc tangent, a code
                // that lies on the border of two may take the other.
                let (fraction, greatest) = difference(&on_gpu, &on_cpu, code_bytes);
                let found = format!("{contents:?} {wrap:?} {azimuth}: {fraction}, by {greatest}");
                assert!(fraction <= 2e-3 && greatest <= 1, "{found}");
            }
        }
    }
}

/// For each node: mean, 95th percentile and share below 0.01 degrees of the errors of the sweep's
/// horizons in some azimuths.
fn sweep_errors(
    gpu: &Gpu,
    baker: &Baker,
    field: &Field,
    desc: &TableDesc,
    azimuths: &[u32],
) -> Vec<[f64; 3]> {
    let bits = azimuths.iter().fold(0, |bits, azimuth| bits | 1 << azimuth);
    let truth = bake(gpu, baker, field, desc, Search::BruteForce, bits);
    let swept = bake(gpu, baker, field, desc, Search::Sweep, bits);
    let of_node = |node| {
        let mut errors_deg = Vec::new();
        for &azimuth in azimuths {
            let truth = horizons_deg(field, desc, &layer(gpu, &truth, azimuth), node);
            let swept = horizons_deg(field, desc, &layer(gpu, &swept, azimuth), node);
            errors_deg.extend(truth.iter().zip(&swept).map(|(a, b)| (a - b).abs()));
        }
        errors_deg.sort_by(f64::total_cmp);
        let count = errors_deg.len();
        let mean = errors_deg.iter().sum::<f64>() / count as f64;
        let same = errors_deg.iter().filter(|&&error| error < 0.01).count() as f64 / count as f64;
        [mean, errors_deg[count * 95 / 100], same]
    };
    (0..desc.nodes().len()).map(of_node).collect()
}

#[test]
fn the_sweep_finds_the_brute_forces_horizons() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    // The last one's bumps are four texels wide and as high as the others'.
    for (wrap, size, greatest_mean_deg) in [
        ([Wrap::Repeat; 2], [128, 128], 0.04),
        ([Wrap::Clamp; 2], [96, 128], 0.05),
        ([Wrap::Repeat, Wrap::Clamp], [70, 45], 0.1),
    ] {
        let field = Field { wrap, ..Field::rough(size, 7) };
        for (curvature, texels_per_height) in
            [([0.0, 0.02], 24.0), ([0.015, 0.015], 24.0), ([-0.01, 0.0], 24.0), ([0.0, 0.02], 60.0)]
        {
            let mut desc = field.desc(2, curvature, texels_per_height);
            desc.azimuths = 12;
            desc.radius_texels = 64.0;
            desc.contents = Contents::Candidates { count: 2, precision: Precision::Full };
            let errors = sweep_errors(&gpu, &baker, &field, &desc, &[0, 1, 2, 4, 7, 9, 11]);
            for (kappa, [mean, p95, same]) in desc.nodes().iter().zip(errors) {
                let found = format!(
                    "{size:?} {texels_per_height} {kappa}: mean {mean:.4} p95 {p95:.4} same {same:.4}"
                );
                println!("{found}");
                assert!(mean < greatest_mean_deg && p95 < 0.01 && same > 0.965, "{found}");
            }
        }
    }
}

#[test]
fn the_sweep_follows_far_horizons_over_the_whole_radius() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    // One wall on a plain: each texel's horizon is the wall, up to 100 texels away, and where the
    // ground is concave the rim of what the radius lets it see.
    let field = Field::new([160, 12], |x, _| if x == 150 { 1.0 } else { 0.0 });
    for curvature in [[0.0, 0.0], [-0.004, -0.004], [0.004, 0.004]] {
        let mut desc = field.desc(1, curvature, 40.0);
        desc.radius_texels = 100.0;
        desc.azimuths = 8;
        desc.contents = Contents::Candidates { count: 1, precision: Precision::Full };
        let [mean, _, same] = sweep_errors(&gpu, &baker, &field, &desc, &[0, 1, 2, 3, 4, 5, 6, 7])[0];
        assert!(mean < 1e-3 && same > 0.9999, "{curvature:?}: mean {mean:.5} same {same:.5}");
    }
}
