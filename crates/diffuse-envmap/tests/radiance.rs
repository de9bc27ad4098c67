//! The WGSL against the f64 model, on maps that are hard for it.

mod support;

use diffuse_envmap::{Base, Distribution, Gpu, Horizon, Method, Settings, model, wgpu};
use gpu_context::HeadlessDesc;
use support::{Probe, Query, directions, relative_mse};

const WIDTH: u32 = 128;
const HEIGHT: u32 = 64;

/// Fills a map from a function of texel column and row.
fn texels(f: impl Fn(u32, u32) -> [f32; 3]) -> Vec<[f32; 3]> {
    (0..WIDTH * HEIGHT).map(|i| f(i % WIDTH, i / WIDTH)).collect()
}

fn smooth() -> Vec<[f32; 3]> {
    texels(|x, y| {
        let (u, v) = (x as f32 / WIDTH as f32, y as f32 / HEIGHT as f32);
        let wave = 1.0 + (u * 12.566).sin() * (v * std::f32::consts::PI).sin();
        [wave, 0.2 + v, 1.5 - wave * 0.5]
    })
}

/// Bright above, dark below, and a dark half turn: edges in every direction.
fn edges() -> Vec<[f32; 3]> {
    texels(|x, y| [if y < HEIGHT / 2 { 2.0 } else { 0.25 }, if x < WIDTH / 2 { 1.0 } else { 0.1 }, 0.5])
}

/// A dim sky with one texel of 60,000 and a lamp of 5 x 4 texels of 300.
fn sun() -> Vec<[f32; 3]> {
    texels(|x, y| match (x, y) {
        (40, 20) => [60_000.0, 55_000.0, 50_000.0],
        (90..95, 30..34) => [300.0, 250.0, 200.0],
        _ => [0.3, 0.4, 0.6 - 0.004 * y as f32],
    })
}

fn unit(v: [f32; 3]) -> model::Vec3 {
    model::normalize_or(v.map(f64::from), [0.0, 1.0, 0.0])
}

/// The reference for queries along their axis.
fn reference(map: &model::Map, axes: &[[f32; 3]], t: f32) -> Vec<[f64; 3]> {
    axes.iter()
        .map(|&axis| {
            let axis = unit(axis);
            if t < 0.07 {
                model::integrate_over_lobe(map, axis, axis, f64::from(t), Horizon::Keep, 128, 256)
            } else {
                let parts = if t < 0.5 { 4 } else { 2 };
                model::integrate_over_texels(map, axis, axis, f64::from(t), Horizon::Keep, parts)
            }
        })
        .collect()
}

#[test]
fn a_mirror_is_the_lookup_to_the_last_bit() {
    let mut probe = Probe::new();
    let map = probe.set_map(WIDTH, HEIGHT, &sun());
    let queries: Vec<_> = directions(500).into_iter().map(|axis| Query::along(axis, 0.0)).collect();
    let lookup = Settings {
        method: Method::Paper { rays: 1, distribution: Distribution::Cosine, rotate: false },
        ..Settings::PAPER
    };
    let expected = probe.radiance(&lookup, &queries);
    assert_eq!(probe.radiance(&Settings::SHEEN, &queries), expected);
    // And the lookup is the bilinear one, within the filter's own precision of 1/256 texel.
    for (query, found) in queries.iter().zip(&expected) {
        let exact = map.sample(unit(query.normal));
        let greatest = if exact[0] > 1.0 { 60_000.0 } else { 1.0 };
        assert!((f64::from(found[0]) - exact[0]).abs() < greatest / 100.0, "{found:?} {exact:?}");
    }
}

#[test]
fn the_published_method_matches_the_model() {
    let mut probe = Probe::new();
    let map = probe.set_map(WIDTH, HEIGHT, &smooth());
    for (distribution, base, horizon) in [
        (Distribution::Cosine, Base::Lerp, Horizon::Discard),
        (Distribution::UniformAngle, Base::Slerp, Horizon::Keep),
        (Distribution::Cosine, Base::Lerp, Horizon::Keep),
    ] {
        let method = Method::Paper { rays: 37, distribution, rotate: false };
        let settings = Settings { method, base, horizon, ..Settings::PAPER };
        let mut queries = Vec::new();
        for (i, normal) in directions(40).into_iter().enumerate() {
            let (x, _) = model::frame(unit(normal));
            for (roughness, slope) in [(0.0, 0.3), (0.1, 3.0), (0.35, 30.0), (0.7, 1.0), (1.0, 0.0)] {
                let view = model::add_scaled(unit(normal).map(|c| -c), x, slope * (1.0 + i as f64 * 0.01));
                let view = model::normalize_or(view, x).map(|c| c as f32);
                queries.push(Query { normal, view, roughness });
            }
        }
        for (query, found) in queries.iter().zip(probe.radiance(&settings, &queries)) {
            let (normal, t) = (unit(query.normal), f64::from(query.roughness));
            let axis = model::base(model::mirror(unit(query.view), normal), normal, t, base);
            let exact = model::paper(&map, axis, normal, t, horizon, 37, distribution);
            for channel in 0..3 {
                let error = (f64::from(found[channel]) - exact[channel]).abs();
                // A ray on the horizon may fall on either side: one of 37.
                assert!(error < 0.01, "{query:?}: {found:?}, expected {exact:?}");
            }
        }
    }
}

#[test]
fn the_error_stays_small_on_every_map() {
    let mut probe = Probe::new();
    let axes = directions(120);
    // The sun's texel is 2.8 degrees wide, 200,000 times brighter than the sky and not round:
    // directions that see just its corner dominate the relative error.
    for (name, texels, limit) in [("smooth", smooth(), 5e-4), ("edges", edges(), 1e-3), ("sun", sun(), 1e-2)]
    {
        let map = probe.set_map(WIDTH, HEIGHT, &texels);
        for t in [0.02, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.45, 0.6, 0.8, 0.9, 1.0] {
            let queries: Vec<_> = axes.iter().map(|&axis| Query::along(axis, t)).collect();
            let found = probe.radiance(&Settings::SHEEN, &queries);
            let error = relative_mse(&found, &reference(&map, &axes, t));
            println!("{name:7} t {t:.2}: relMSE {error:.2e}");
            assert!(error < limit, "{name} t {t}: relMSE {error}");
        }
    }
}

#[test]
fn one_bright_texel_has_the_shape_of_the_lobe() {
    let mut probe = Probe::new();
    let texels = texels(|x, y| if (x, y) == (40, 20) { [60_000.0; 3] } else { [0.3; 3] });
    let map = probe.set_map(WIDTH, HEIGHT, &texels);
    let sun = map.direction(40, 20);
    for t in [0.1_f32, 0.15, 0.3, 0.6, 0.9, 1.0] {
        let queries: Vec<_> = (0..48)
            .map(|i| {
                let angle = f64::from(t) * 1.9 * f64::from(i % 16) / 15.0;
                Query::along(model::around(sun, angle, f64::from(i / 16)).map(|x| x as f32), t)
            })
            .collect();
        let found = probe.radiance(&Settings::SHEEN, &queries);
        let axes: Vec<_> = queries.iter().map(|query| query.normal).collect();
        let expected = reference(&map, &axes, t);
        let peak = expected[0][0];
        for (found, expected) in found.iter().zip(&expected) {
            let error = (f64::from(found[0]) - expected[0]).abs();
            assert!(error < 0.015 * peak, "t {t}: {found:?}, expected {expected:?}, peak {peak}");
        }
    }
}

#[test]
fn full_roughness_is_the_irradiance_within_one_percent() {
    let mut probe = Probe::new();
    let axes = directions(200);
    for (name, texels) in [("smooth", smooth()), ("edges", edges()), ("sun", sun())] {
        let map = probe.set_map(WIDTH, HEIGHT, &texels);
        let queries: Vec<_> = axes.iter().map(|&axis| Query::along(axis, 1.0)).collect();
        let found = probe.radiance(&Settings::SHEEN, &queries);
        let expected = reference(&map, &axes, 1.0);
        let mean = expected.iter().flatten().sum::<f64>() / 600.0;
        let pairs = found.iter().flatten().zip(expected.iter().flatten());
        let error = pairs.map(|(&x, &y)| (f64::from(x) - y).abs()).sum::<f64>() / 600.0 / mean;
        println!("{name}: mean absolute error {:.2} % of the mean", 100.0 * error);
        assert!(error < 0.01, "{name}: {error}");
    }
}

#[test]
fn a_furnace_returns_what_surrounds_it() {
    let mut probe = Probe::new();
    // Nearly constant: the constant map's short cut does not apply, the sum of weights does.
    for texels in [texels(|_, _| [0.75; 3]), texels(|x, y| [if (x, y) == (3, 9) { 0.7505 } else { 0.75 }; 3])]
    {
        probe.set_map(WIDTH, HEIGHT, &texels);
        for t in [0.0, 0.05, 0.3, 0.49, 0.7, 0.9, 1.0] {
            let queries: Vec<_> = directions(100).into_iter().map(|axis| Query::along(axis, t)).collect();
            for found in probe.radiance(&Settings::SHEEN_FULL, &queries) {
                assert!((found[0] / 0.75 - 1.0).abs() < 5e-4, "t {t}: {found:?}");
            }
        }
    }
}

#[test]
fn grazing_lobes_lose_what_dips_below_the_surface() {
    let mut probe = Probe::new();
    // Bright below the horizon: whatever leaks shows.
    let map = probe.set_map(WIDTH, HEIGHT, &texels(|_, y| [if y < HEIGHT / 2 { 1.0 } else { 3.0 }; 3]));
    let normal = [0.0, 1.0, 0.0];
    for t in [0.1_f32, 0.2, 0.3, 0.4] {
        let queries: Vec<_> = (0..40)
            .map(|i| {
                let (azimuth, incidence) = (i as f32 * 0.157, 88.0_f32.to_radians());
                let (sine, cosine) = incidence.sin_cos();
                let view = [sine * azimuth.cos(), -cosine, sine * azimuth.sin()];
                Query { normal, view, roughness: t }
            })
            .collect();
        for (query, found) in queries.iter().zip(probe.radiance(&Settings::SHEEN_FULL, &queries)) {
            let up = unit(normal);
            let axis = model::base(model::mirror(unit(query.view), up), up, f64::from(t), Base::Lerp);
            let exact =
                model::integrate_over_lobe(&map, axis, up, f64::from(t), Horizon::Discard, 128, 256)[0];
            assert!((f64::from(found[0]) / exact - 1.0).abs() < 0.12, "t {t}: {found:?}, expected {exact}");
        }
    }
}

#[test]
fn the_picture_changes_smoothly_with_roughness_and_direction() {
    let mut probe = Probe::new();
    probe.set_map(WIDTH, HEIGHT, &edges());
    let axis = unit([0.6, 0.05, 0.4]).map(|x| x as f32);
    let by_roughness: Vec<_> = (0..=960).map(|i| Query::along(axis, 0.04 + i as f32 * 0.001)).collect();
    let values = probe.radiance(&Settings::SHEEN, &by_roughness);
    for (i, pair) in values.windows(2).enumerate() {
        let change = (pair[1][0] - pair[0][0]).abs() / pair[0][0];
        assert!(change < 0.01, "t {}: changes by {change}", 0.04 + i as f32 * 0.001);
    }
    // A tenth of a degree a step, all around: the steepest step against the reference's steepest.
    for t in [0.1_f32, 0.25, 0.5, 0.9] {
        let turn: Vec<_> = (0..900)
            .map(|i| {
                let angle = (45.0 + 0.1 * f64::from(i)).to_radians();
                Query::along([0.8 * angle.cos(), 0.6, 0.8 * angle.sin()].map(|x| x as f32), t)
            })
            .collect();
        let found = probe.radiance(&Settings::SHEEN, &turn);
        let jerk = found.windows(3).map(|w| (w[2][1] - 2.0 * w[1][1] + w[0][1]).abs()).fold(0.0, f32::max);
        assert!(jerk < 0.004, "t {t}: second difference {jerk}");
    }
}

#[test]
fn every_backend_gives_the_same_radiance() {
    let on = |backends| {
        let gpu = Gpu::headless(&HeadlessDesc { backends, ..HeadlessDesc::default() }).ok()?;
        let mut probe = Probe::on(gpu);
        probe.set_map(WIDTH, HEIGHT, &edges());
        let queries: Vec<_> = directions(60)
            .into_iter()
            .flat_map(|axis| [0.0, 0.04, 0.1, 0.3, 0.6, 0.9, 1.0].map(|t| Query::along(axis, t)))
            .collect();
        Some(probe.radiance(&Settings::SHEEN_FULL, &queries))
    };
    let (Some(vulkan), Some(opengl)) = (on(wgpu::Backends::VULKAN), on(wgpu::Backends::GL)) else {
        println!("skipped: needs an adapter for Vulkan and one for OpenGL");
        return;
    };
    for (a, b) in vulkan.iter().flatten().zip(opengl.iter().flatten()) {
        assert!((a - b).abs() <= 0.02 * a.max(*b), "Vulkan {a}, OpenGL {b}");
    }
}

#[test]
fn rotation_and_parallax_turn_the_lookup() {
    let mut probe = Probe::new();
    probe.set_map(WIDTH, HEIGHT, &smooth());
    probe.prepare(&Settings::SHEEN, 0.0, 1.0);
    let plain = probe.evaluate(&[Query::along([1.0, 0.0, 0.0], 0.0)])[0];
    // Turned a quarter counter-clockwise seen from above, what was at +X is at -Z.
    probe.prepare(&Settings::SHEEN, std::f32::consts::FRAC_PI_2, 1.0);
    let turned = probe.evaluate(&[Query::along([0.0, 0.0, -1.0], 0.0)])[0];
    for channel in 0..3 {
        assert!((plain[channel] - turned[channel]).abs() < 2e-3, "{plain:?} {turned:?}");
    }
    // From the origin, 1 m from the wall x = 1 of a box captured at (-1, 0, 0), the direction
    // (1, 1, 0) hits (1, 1, 0), which the capture saw along (2, 1, 0).
    let parallax = Some(diffuse_envmap::ParallaxBox {
        min_world: [-3.0, -2.0, -2.0],
        max_world: [1.0, 2.0, 2.0],
        centre_world: [-1.0, 0.0, 0.0],
    });
    let seen = unit([2.0, 1.0, 0.0]).map(|x| x as f32);
    let asked = unit([1.0, 1.0, 0.0]).map(|x| x as f32);
    probe.prepare(&Settings::SHEEN, 0.0, 1.0);
    let expected = probe.evaluate(&[Query::along(seen, 0.2)])[0];
    probe.prepare(&Settings { parallax, ..Settings::SHEEN }, 0.0, 1.0);
    let found = probe.evaluate(&[Query::along(asked, 0.2)])[0];
    for channel in 0..3 {
        assert!((found[channel] - expected[channel]).abs() < 2e-3, "{found:?} {expected:?}");
    }
}
