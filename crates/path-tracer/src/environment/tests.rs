//! Tests of the environment's radiance and of drawing directions from it.

#![allow(clippy::float_cmp, reason = "exact zeros and equal densities are meant")]

use std::f64::consts::PI;
use std::path::PathBuf;

use glam::DVec3;
use scene::{Environment, Limits};

use super::{EnvironmentSampler, Place};
use crate::chi_squared::{Bins, Numbers, integrate, significance, test};

/// A map of random texels, some of them black (not the first).
fn random_map(width: u32, height: u32, seed: u64) -> Environment {
    let mut numbers = Numbers(seed);
    let texel = |index| {
        let [a, b, c] = numbers.three();
        if index > 0 && numbers.next() < 0.3 {
            [0.0; 3]
        } else {
            [a, b, 5.0 * c * c].map(|value| value as f32)
        }
    };
    let pixels = (0..width * height).map(texel).collect();
    let made = Environment::new("random", width, height, pixels).unwrap();
    Environment { intensity: 1.7, rotation_rad: 0.83, ..made }
}

/// Texels of `dark`, and one of `bright`.
fn one_texel(width: u32, height: u32, index: usize, bright: f32, dark: f32) -> Environment {
    let mut pixels = vec![[dark; 3]; (width * height) as usize];
    pixels[index] = [bright; 3];
    let made = Environment::new("one texel", width, height, pixels).unwrap();
    Environment { rotation_rad: -2.1, ..made }
}

fn sampler(environment: &Environment) -> EnvironmentSampler {
    EnvironmentSampler::new(environment).unwrap()
}

/// Unit directions all over the sphere, poles and axes included.
fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    let spiral = (0..=count).map(move |i| {
        let height = 1.0 - 2.0 * f64::from(i) / f64::from(count);
        let (radius, turn) = ((1.0 - height * height).sqrt(), 2.399963 * f64::from(i));
        DVec3::new(radius * turn.cos(), height, radius * turn.sin())
    });
    spiral.chain([DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z])
}

#[test]
fn radiance_is_the_scene_s() {
    for environment in [random_map(1, 1, 1), random_map(2, 1, 2), random_map(3, 5, 3), random_map(64, 32, 4)]
    {
        let sampler = sampler(&environment);
        for direction in directions(2000) {
            let found = sampler.radiance(direction);
            let expected = environment.radiance_world(direction.as_vec3());
            for channel in 0..3 {
                let error = found[channel] - f64::from(expected[channel]);
                assert!(error.abs() < 3e-4, "{direction}: {found:?} {expected}");
            }
        }
    }
}

#[test]
fn rotation_is_that_of_the_scene() {
    // The middle of the map is +X of its own space; turned a quarter, counter-clockwise seen from
    // above, it is -Z of the world.
    let made = one_texel(64, 32, 16 * 64 + 32, 100.0, 0.0);
    let turned = Environment { rotation_rad: std::f32::consts::FRAC_PI_2, ..made };
    let sampler = sampler(&turned);
    let brightest = directions(20_000)
        .max_by(|a, b| sampler.radiance(*a)[0].total_cmp(&sampler.radiance(*b)[0]))
        .unwrap();
    assert!(brightest.dot(DVec3::NEG_Z) > 0.99, "{brightest}");
    let (drawn, _) = sampler.sample([0.5, 0.5]).unwrap();
    assert!(drawn.dot(DVec3::NEG_Z) > 0.98, "{drawn}");
}

#[test]
fn samples_follow_the_density() {
    let maps = [
        random_map(1, 1, 3),
        random_map(2, 1, 3),
        random_map(3, 5, 3),
        random_map(17, 9, 5),
        random_map(64, 32, 6),
        one_texel(32, 16, 32 * 5 + 31, 1e5, 1.0),
        one_texel(16, 8, 3, 10.0, 0.1),
        one_texel(16, 8, 16 * 7, 10.0, 0.1),
    ];
    for (i, map) in maps.iter().enumerate() {
        let (sampler, mut numbers) = (sampler(map), Numbers(i as u64));
        let mut draw = || {
            let [u, v, _] = numbers.three();
            sampler.sample([u, v]).map(|(direction, _)| direction)
        };
        // Circles about the map's own axis; texels' edges are among the bins' where they divide.
        let bins = Bins::even(DVec3::Y, 15, 32);
        let outcome = test(&bins, &|direction| sampler.pdf(direction), &mut draw, 100_000);
        println!("map {i}: p {:.3}, total {:.5}", outcome.p_value, outcome.total);
        assert!((outcome.total - 1.0).abs() < 2e-3, "map {i}: {outcome:?}");
        assert!(outcome.p_value > significance(maps.len()), "map {i}: {outcome:?}");
    }
}

/// The integral of the density, cell by cell.
fn total_density(sampler: &EnvironmentSampler) -> f64 {
    let mut total = 0.0;
    for row in 0..=sampler.map.height {
        for column in 0..sampler.map.width {
            let inside = |along: f64, down: f64| {
                let direction = sampler.map.direction(&Place { column, row, along, down });
                sampler.pdf(sampler.world_from_own(direction))
            };
            total += integrate(&inside, [0.0, 1.0, 0.0, 1.0], f64::INFINITY) * sampler.map.solid_angle(row);
        }
    }
    total
}

#[test]
fn density_totals_one_and_belongs_to_the_samples() {
    for map in [
        random_map(1, 1, 1),
        random_map(3, 5, 3),
        random_map(200, 100, 8),
        one_texel(128, 64, 4000, 1e5, 1e-3),
    ] {
        let sampler = sampler(&map);
        let total = total_density(&sampler);
        assert!((total - 1.0).abs() < 1e-9, "{total}");
        let mut numbers = Numbers(4);
        for _ in 0..20_000 {
            let (direction, pdf) = sampler.sample([numbers.next(), numbers.next()]).unwrap();
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let again = sampler.pdf(direction);
            // Right on an edge the density of the next cell may be found.
            assert!((again / pdf - 1.0).abs() < 1e-6 || numbers.next() < 1e-3, "{direction} {pdf} {again}");
        }
    }
}

#[test]
fn whatever_shines_can_be_drawn() {
    let mut maps = vec![random_map(1, 1, 3), random_map(2, 1, 3), random_map(3, 5, 3), random_map(40, 20, 7)];
    for index in [0, 5, 15, 16, 63, 64, 112, 127] {
        maps.push(one_texel(16, 8, index, 1e5, 0.0));
    }
    // A faint texel that is 10^20 times darker than its neighbour.
    let mut faint = one_texel(16, 8, 60, 1e5, 0.0);
    faint.pixels[63] = [1e-15; 3];
    faint.pixels[100] = [1e-15; 3];
    maps.push(faint);
    for map in &maps {
        let sampler = sampler(map);
        for direction in directions(30_000) {
            let (radiance, pdf) = (sampler.radiance(direction), sampler.pdf(direction));
            assert!(pdf > 0.0 || radiance == [0.0; 3], "{direction}: {radiance:?}");
            assert!(pdf.is_finite());
        }
    }
}

/// The mean of radiance over density, its standard error, and the integral of radiance.
fn estimate(environment: &Environment, count: u32) -> (f64, f64, f64) {
    let (sampler, mut numbers) = (sampler(environment), Numbers(9));
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let (direction, pdf) = sampler.sample([numbers.next(), numbers.next()]).unwrap();
        let value = sampler.radiance(direction)[1] / pdf;
        sum += value;
        squares += value * value;
    }
    let (mean, count) = (sum / f64::from(count), f64::from(count));
    let deviation = ((squares / count - mean * mean) / count).sqrt();
    // The bilinear map's integral: its texels' tents, by quadrature between their centres.
    let radiance = |u: f64, v: f64| {
        let own = DVec3::new(
            (2.0 * PI * (u - 0.5)).cos() * (PI * v).sin(),
            (PI * v).cos(),
            (2.0 * PI * (u - 0.5)).sin() * (PI * v).sin(),
        );
        sampler.radiance(sampler.world_from_own(own))[1] * 2.0 * PI * PI * (PI * v).sin()
    };
    let (width, height) = (sampler.map.width, sampler.map.height);
    let mut exact = 0.0;
    for row in 0..2 * height {
        for column in 0..2 * width {
            let at = |i: usize, n: usize| i as f64 / (2 * n) as f64;
            let rect = [at(column, width), at(column + 1, width), at(row, height), at(row + 1, height)];
            exact += integrate(&radiance, rect, 1e-3);
        }
    }
    (mean, deviation, exact)
}

#[test]
fn samples_estimate_the_light_of_the_bilinear_map() {
    // The spread of one sample: colours have one that no density can help.
    for (map, limit) in [
        (random_map(3, 5, 3), 0.7),
        (random_map(40, 20, 7), 0.7),
        (one_texel(64, 32, 64 * 10 + 5, 1e5, 1.0), 0.05),
        (one_texel(16, 8, 0, 1e5, 0.0), 0.2),
    ] {
        let (mean, deviation, exact) = estimate(&map, 200_000);
        let spread = deviation * 200_000.0_f64.sqrt() / exact;
        println!("{mean} +- {deviation}, {exact}; one sample {spread:.3}");
        assert!((mean - exact).abs() < 4.5 * deviation + 1e-6 * exact, "{mean} +- {deviation}, {exact}");
        assert!(spread < limit, "{spread}");
    }
}

#[test]
fn nothing_is_drawn_where_nothing_shines() {
    let black = one_texel(4, 2, 0, 0.0, 0.0);
    assert!(EnvironmentSampler::new(&black).is_none());
    let lit = one_texel(4, 2, 0, 1.0, 1.0);
    for intensity in [0.0, f32::NAN, f32::INFINITY, -1.0] {
        assert!(EnvironmentSampler::new(&Environment { intensity, ..lit.clone() }).is_none());
    }
    let torn = Environment { width: 5, ..lit.clone() };
    assert!(EnvironmentSampler::new(&torn).is_none());
    let turned = Environment { rotation_rad: f32::NAN, ..lit };
    let sampler = sampler(&turned);
    for u in [[f64::NAN; 2], [-1.0; 2], [2.0; 2], [0.0; 2], [1.0; 2]] {
        let (direction, pdf) = sampler.sample(u).unwrap();
        assert!(direction.is_finite() && pdf > 0.0);
    }
}

#[test]
fn real_maps_with_suns() {
    let folder = std::env::var_os("SHEEN_TEST_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    for name in
        ["rooitou_park_1k.hdr", "potsdamer_platz_1k.hdr", "studio_small_03_1k.hdr", "stage_env_latlong.exr"]
    {
        let path = folder.join("hdri").join(name);
        if !path.exists() {
            println!("skipped: test data absent");
            return;
        }
        let (environment, _) = scene::load::environment(&path, &Limits::default()).unwrap();
        let sampler = sampler(&environment);
        let mut numbers = Numbers(2);
        // Sums over cells instead of quadrature: bins are blocks of them.
        let (mut found, mut expected) = (vec![0.0; 32 * 16], vec![0.0; 32 * 16]);
        let (columns, rows) = (sampler.map.width, sampler.map.height + 1);
        let bin = |column: usize, row: usize| (row * 16 / rows) * 32 + column * 32 / columns;
        for row in 0..rows {
            for column in 0..columns {
                expected[bin(column, row)] += 200_000.0 * sampler.chance(column, row);
            }
        }
        for _ in 0..200_000 {
            let (direction, _) = sampler.sample([numbers.next(), numbers.next()]).unwrap();
            let place = sampler.map.place(sampler.own_from_world(direction));
            found[bin(place.column, place.row)] += 1.0;
        }
        let p_value = crate::chi_squared::p_value(&found, &expected);
        println!("{name}: p {p_value:.3}");
        assert!(p_value > significance(4), "{name}: {p_value}");
        for direction in directions(20_000) {
            let dark = sampler.radiance(direction) == [0.0; 3];
            assert!(dark || sampler.pdf(direction) > 0.0, "{name}: {direction}");
        }
    }
}
