//! Inputs that break naive code: whatever comes in, finite radiance goes out.

mod support;

use diffuse_envmap::{Method, Settings, wgpu};
use gpu_context::upload;
use proptest::prelude::*;
use support::{Probe, Query, directions};

fn check_finite(probe: &mut Probe, queries: &[Query]) {
    for settings in [Settings::PAPER, Settings::SHEEN, Settings::SHEEN_FULL] {
        for (query, found) in queries.iter().zip(probe.radiance(&settings, queries)) {
            assert!(
                found.iter().all(|x| x.is_finite() && *x >= 0.0),
                "{query:?} gave {found:?} ({settings:?})"
            );
        }
    }
}

fn hard_queries() -> Vec<Query> {
    let special = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, 1e-38, -1.0, 1.0, 1e38];
    let axes = [
        [0.0, 0.0, -1.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [-1.0, 0.0, -1e-20],
    ];
    let mut queries = Vec::new();
    for axis in axes {
        for t in [-1.0, 0.0, 1e-30, 1e-6, 0.5, 1.0, 2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            queries.push(Query::along(axis, t));
            // Seen from behind: at t = 0.5 mirror direction and normal cancel.
            queries.push(Query { normal: axis, view: axis, roughness: t });
            queries.push(Query { normal: axis, view: [axis[1], axis[2], axis[0]], roughness: t });
        }
    }
    for a in special {
        for b in special {
            queries.push(Query { normal: [a, b, 0.0], view: [b, 0.0, a], roughness: 0.3 });
            queries.push(Query { normal: [0.0, 1.0, 0.0], view: [a, b, a], roughness: b });
        }
    }
    queries
}

#[test]
fn maps_of_every_shape_give_finite_radiance() {
    let mut probe = Probe::new();
    for (width, height) in [(1, 1), (2, 1), (1, 2), (3, 5), (1, 33), (257, 1), (64, 32)] {
        let texels: Vec<_> =
            (0..width * height).map(|i| [(i % 7) as f32, 0.5, (i % 3) as f32 * 900.0]).collect();
        probe.set_map(width, height, &texels);
        check_finite(&mut probe, &hard_queries());
    }
}

#[test]
fn a_black_map_is_black_and_one_texel_is_constant() {
    let mut probe = Probe::new();
    let queries: Vec<_> = (0..=20).map(|i| Query::along([0.6, 0.0, 0.8], i as f32 / 20.0)).collect();
    probe.set_map(64, 32, &vec![[0.0; 3]; 64 * 32]);
    assert!(probe.radiance(&Settings::SHEEN, &queries).iter().flatten().all(|&x| x.to_bits() == 0));
    probe.set_map(1, 1, &[[0.25, 0.5, 2.0]]);
    for found in probe.radiance(&Settings::SHEEN, &queries) {
        for (x, expected) in found.iter().zip([0.25, 0.5, 2.0]) {
            assert!((x / expected - 1.0).abs() < 5e-4, "{found:?}");
        }
    }
}

#[test]
fn texels_that_are_no_radiance_do_not_spread() {
    let mut probe = Probe::new();
    // Raw half floats: infinity, NaN, -1, and the largest half.
    let bad = [0x7c00_u16, 0x7e00, 0xbc00, 0x7bff];
    let mut halves = vec![0x3800_u16; 64 * 32 * 4];
    for (i, half) in bad.into_iter().enumerate() {
        for channel in 0..3 {
            halves[(64 * (5 + 6 * i) + 13 * i) * 4 + channel] = half;
        }
    }
    let format = wgpu::TextureFormat::Rgba16Float;
    let texture =
        upload::texture_2d(&probe.gpu, "bad", 64, 32, format, bytemuck::cast_slice(&halves), None).unwrap();
    probe.set_texture(texture);
    let queries: Vec<_> = directions(400)
        .into_iter()
        .flat_map(|axis| [0.2, 0.4, 0.7, 1.0].map(|t| Query::along(axis, t)))
        .collect();
    let found = probe.radiance(&Settings::SHEEN, &queries);
    assert!(found.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
}

#[test]
fn a_surface_that_faces_away_does_not_outshine_the_map() {
    let mut probe = Probe::new();
    let texels: Vec<_> =
        (0..128 * 64).map(|i| if i == 64 * 20 + 40 { [60_000.0; 3] } else { [0.3; 3] }).collect();
    probe.set_map(128, 64, &texels);
    let (axes, sun) = (directions(64), [0.6, 0.5, -0.62]);
    let queries: Vec<_> =
        [0.001, 0.02, 0.05, 0.1, 0.2, 0.4, 0.5]
            .into_iter()
            .flat_map(|roughness| axes.iter().map(move |&view| Query { normal: sun, view, roughness }))
            .chain(axes.iter().flat_map(|&normal| {
                [0.02, 0.1, 0.3].map(|roughness| Query { normal, view: normal, roughness })
            }))
            .collect();
    for (query, found) in queries.iter().zip(probe.radiance(&Settings::SHEEN, &queries)) {
        assert!(found.iter().all(|&x| x <= 60_000.0), "{query:?}: {found:?}");
    }
}

#[test]
fn absurd_settings_are_bounded() {
    let mut probe = Probe::new();
    probe.set_map(8, 4, &[[1.0; 3]; 32]);
    for bad in [f32::NAN, f32::INFINITY, -1e30] {
        let settings = Settings {
            method: Method::Paper {
                rays: 0,
                distribution: diffuse_envmap::Distribution::Cosine,
                rotate: true,
            },
            roughness_offset: bad,
            intensity: bad,
            one_tap_contrast: bad,
            ..Settings::SHEEN
        };
        for settings in [settings, Settings { method: Method::Sheen, ..settings }] {
            let found = probe.radiance(&settings, &[Query::along([0.0, 1.0, 0.0], 0.4)]);
            assert!(found.iter().flatten().all(|x| x.is_finite()), "{settings:?}: {found:?}");
        }
    }
}

#[test]
fn any_query_on_any_map_gives_finite_radiance() {
    let probe = std::cell::RefCell::new(Probe::new());
    let float = prop_oneof![prop::num::f32::ANY, -1.0_f32..1.0];
    let vector = || prop::array::uniform3(float.clone());
    let query = (vector(), vector(), float.clone()).prop_map(|(normal, view, roughness)| Query {
        normal,
        view,
        roughness,
    });
    let map = (1_u32..40, 1_u32..40, prop::collection::vec(0.0_f32..65504.0, 8));
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(24));
    let cases = (map, prop::collection::vec(query, 256));
    runner
        .run(&cases, |((width, height, values), queries)| {
            let texels: Vec<_> = (0..(width * height) as usize)
                .map(|i| std::array::from_fn(|channel| values[(i * 3 + channel * i + channel) % 8]))
                .collect();
            probe.borrow_mut().set_map(width, height, &texels);
            check_finite(&mut probe.borrow_mut(), &queries);
            Ok(())
        })
        .unwrap();
}
