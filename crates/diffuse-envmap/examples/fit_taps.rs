//! Fits the tap table of `Method::Sheen` and prints `src/tap_table.rs`.
//!
//! `cargo run --release -p diffuse-envmap --example fit_taps > crates/diffuse-envmap/src/tap_table.rs`

use diffuse_envmap::{
    model,
    taps::{NODES, NODES_PER_OCTAVE, OCTAVES, Taps, chain_coefficient, node_roughness},
};

fn main() {
    // Below t = 1/8 a lobe is as good as flat, and the fit repeats itself octave by octave.
    let spherical_octaves = 3;
    let first = (OCTAVES - spherical_octaves) * NODES_PER_OCTAVE;
    let fitted: Vec<Taps> = (first..NODES)
        .map(|node| {
            let t = node_roughness(node);
            let (taps, [white, natural, single]) = fit(t);
            eprintln!(
                "t {t:.4}: relative L2 of the ring {white:.4} (white), {natural:.4} (natural); \
                 of the single tap {single:.4} (natural)"
            );
            taps
        })
        .collect();
    // A narrower lobe is the fitted one of a whole number of octaves above, made smaller.
    let table = (0..NODES).map(|node| {
        let octaves = first.saturating_sub(node).div_ceil(NODES_PER_OCTAVE);
        let above = fitted[node + octaves * NODES_PER_OCTAVE - first];
        let octaves = octaves as f64;
        Taps {
            axis_level: above.axis_level - octaves,
            ring_angle: above.ring_angle * (-octaves).exp2(),
            ring_level: above.ring_level - octaves,
        }
    });
    println!("//! Fitted by `examples/fit_taps.rs`; do not edit.\n");
    println!("use crate::taps::{{NODES, Taps}};\n");
    println!("/// The taps at `taps::node_roughness(node)`, from the narrowest lobe to t = 1.");
    println!("#[rustfmt::skip]\npub(crate) const TAP_TABLE: [Taps; NODES] = [");
    for taps in table {
        println!(
            "    Taps {{ axis_level: {:.5}, ring_angle: {:.6}, ring_level: {:.5} }},",
            taps.axis_level, taps.ring_angle, taps.ring_level
        );
    }
    println!("];");
}

/// The best taps for t, and their relative error over bands: for white noise, for a map whose
/// power falls as natural images' does, and the latter for the axis tap alone.
fn fit(t: f64) -> (Taps, [f64; 3]) {
    let bands = (14.0 / t).ceil() as usize;
    let target = model::legendre_coefficients(t, bands);
    // Between white and natural: error power weighted by k / (1 + k^2)^1.3, k = l t.
    let weight = |l: usize| {
        let k = l as f64 * t;
        k / (1.0 + k * k).powf(1.3)
    };
    let single = |p: &[f64]| -> f64 {
        (1..=bands).map(|l| weight(l) * (target[l] - chain_coefficient(p[0], l)).powi(2)).sum()
    };
    let axis_level = descend(&[(0.6 * t).log2()], 0.3, &single)[0];
    let build = |p: &[f64]| Taps { axis_level, ring_angle: p[0] * t, ring_level: p[1] };
    let objective = |p: &[f64]| -> f64 {
        let taps = build(p);
        let cosine = model::legendre(taps.ring_angle.cos(), bands);
        (1..=bands)
            .map(|l| weight(l) * (target[l] - cosine[l] * chain_coefficient(taps.ring_level, l)).powi(2))
            .sum()
    };
    let taps = build(&descend(&[0.63, t.log2() - 1.3], 0.1, &objective));
    let relative = |power: &dyn Fn(f64) -> f64, value: &dyn Fn(usize) -> f64| {
        let (mut error, mut total) = (0.0, 0.0);
        for (l, target) in target.iter().enumerate().skip(1) {
            let p = power(l as f64);
            error += p * (target - value(l)).powi(2);
            total += p * target.powi(2);
        }
        (error / total).sqrt()
    };
    let errors = [
        relative(&|l| l, &|l| taps.ring_coefficient(l)),
        relative(&|l| 1.0 / l, &|l| taps.ring_coefficient(l)),
        relative(&|l| 1.0 / l, &|l| chain_coefficient(axis_level, l)),
    ];
    (taps, errors)
}

/// Nelder and Mead's simplex descent from `start`.
fn descend(start: &[f64], step: f64, objective: &dyn Fn(&[f64]) -> f64) -> Vec<f64> {
    let n = start.len();
    let mut simplex: Vec<(f64, Vec<f64>)> = (0..=n)
        .map(|corner| {
            let mut p = start.to_vec();
            if corner > 0 {
                p[corner - 1] += step;
            }
            (objective(&p), p)
        })
        .collect();
    for _ in 0..150 {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        let centre: Vec<f64> =
            (0..n).map(|i| simplex[..n].iter().map(|(_, p)| p[i]).sum::<f64>() / n as f64).collect();
        let worst = simplex[n].1.clone();
        let along = |s: f64| -> (f64, Vec<f64>) {
            let p: Vec<f64> = (0..n).map(|i| centre[i] + s * (worst[i] - centre[i])).collect();
            (objective(&p), p)
        };
        let reflected = along(-1.0);
        simplex[n] = if reflected.0 < simplex[0].0 {
            let expanded = along(-2.0);
            if expanded.0 < reflected.0 { expanded } else { reflected }
        } else if reflected.0 < simplex[n - 1].0 {
            reflected
        } else {
            let contracted = along(0.5);
            if contracted.0 >= simplex[n].0 {
                let best = simplex[0].1.clone();
                for (value, p) in &mut simplex[1..] {
                    for i in 0..n {
                        p[i] = 0.5 * (p[i] + best[i]);
                    }
                    *value = objective(p);
                }
                continue;
            }
            contracted
        };
    }
    simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
    simplex.swap_remove(0).1
}
