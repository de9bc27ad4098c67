//! The library's WGSL against the f64 model, on reliefs that look random and tables whose codes are.

#![allow(missing_docs, reason = "tests")]

mod support;

use horizon_shadow::model::{self, Candidate, CandidateTables, Map, Point, Published, Ray, Slices, View};
use support::{
    CERTIFIED, CONTENTS_BETA_AND_DISTANCE, CONTENTS_DISTANCE_AND_HEIGHT, EXACT, FLAT, MARCHED, PAPER, Probe,
    Query, SHEEN, Tables,
    random::{self, Random},
};

const SIZE: [u32; 2] = [24, 17];

/// Points, lights and curvatures of all kinds over a surface of sheared parametrisation.
fn queries(seed: u64, count: usize, kappa: [f64; 2]) -> Vec<Query> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let angle = random.between(-std::f64::consts::PI, std::f64::consts::PI);
            let elevation = random.between(-0.6, 1.5);
            let (sine, cosine) = elevation.sin_cos();
            let light = [cosine * angle.cos(), cosine * angle.sin(), sine].map(|c| c as f32);
            let uv = [random.between(-1.5, 2.5) as f32, random.between(-1.5, 2.5) as f32];
            let mut query = Query::on_plane(uv, SIZE.map(|texels| texels as f32), light);
            query.along_u[1] = random.between(-3.0, 3.0) as f32;
            query.along_v[0] = random.between(-3.0, 3.0) as f32;
            let extent = SIZE.map(f64::from);
            let form = [extent[0] * extent[0], extent[0] * extent[1], extent[1] * extent[1]];
            let bend = [random.between(kappa[0], kappa[1]), 0.0, random.between(kappa[0], kappa[1])];
            query.second_form = [0, 1, 2].map(|i| (form[i] * bend[i]) as f32);
            query
        })
        .collect()
}

fn wide<const N: usize>(x: [f32; N]) -> [f64; N] {
    x.map(f64::from)
}

fn map(tables: &Tables) -> Map {
    let p = &tables.parameters;
    Map {
        size: wide(p.size),
        uv_scale: wide(p.uv_scale),
        height_scale_m: p.height_scale_m.into(),
        texels_per_height: p.texels_per_height.into(),
    }
}

fn point(query: &Query) -> Point {
    Point {
        uv: wide(query.uv),
        normal: wide(query.normal),
        along_u: wide(query.along_u),
        along_v: wide(query.along_v),
        second_form: wide(query.second_form),
    }
}

/// Candidates of the tests' random words, as the codes have them.
fn candidates(tables: &Tables) -> impl Fn([u32; 2], u32) -> Vec<Candidate> + Sync + '_ {
    let p = tables.parameters;
    let codes = horizon_shadow::codes::Codes::new(horizon_shadow::Precision::Compact, p.radius_texels);
    move |texel, azimuth| {
        let index = (azimuth * SIZE[1] + texel[1]) * SIZE[0] + texel[0];
        let word = tables.candidates[index as usize];
        [word & 0xffff, word >> 16]
            .map(|code| codes.decode(code))
            .map(|[slope, distance]| Candidate { slope: slope.into(), distance: distance.into() })
            .to_vec()
    }
}

/// What a sampler returns of the published tables.
fn sampled(tables: &Tables, at: [f64; 2], direction: [f64; 2]) -> [f64; 2] {
    let slices = Slices::new(direction, tables.parameters.azimuths);
    let low = at.map(f64::floor);
    let mut sum = [0.0; 2];
    for corner in 0..4_i64 {
        let step = [corner % 2, corner / 2];
        let texel = [0, 1].map(|i| (low[i] as i64 + step[i]).rem_euclid(SIZE[i].into()) as u32);
        let share: f64 = [0, 1]
            .map(|i| if step[i] == 1 { at[i] - low[i] } else { 1.0 - (at[i] - low[i]) })
            .iter()
            .product();
        for (azimuth, part) in slices.azimuths.into_iter().zip([1.0 - slices.weight, slices.weight]) {
            let code = tables.published[((azimuth * SIZE[1] + texel[1]) * SIZE[0] + texel[0]) as usize];
            (0..2).for_each(|i| sum[i] += share * part * f64::from(code[i]) / 255.0);
        }
    }
    sum
}

/// Sine of the horizon by a method of the model.
fn expected(tables: &Tables, query: &Query) -> f64 {
    let p = &tables.parameters;
    let relief = random::relief(tables);
    let map = map(tables);
    let Some(view) = View::new(&map, &point(query), wide(query.light)) else { return 0.0 };
    let ray = Ray {
        relief: &relief,
        at: view.at,
        direction: view.direction,
        kappa: view.kappa,
        texels_per_height: view.texels_per_height,
        radius_texels: p.radius_texels.into(),
    };
    let steepening = view.steepening(&map);
    let published = || {
        let stored = sampled(tables, view.at, view.direction);
        Published::decoded(stored, ray.radius_texels, p.contents == CONTENTS_DISTANCE_AND_HEIGHT)
    };
    match p.method {
        FLAT => model::sine_of(published().flat(&ray, steepening)),
        PAPER => model::sine_of(published().paper(&ray, steepening)),
        EXACT => model::sine_of(published().exact(&ray, steepening)),
        SHEEN => {
            let nodes = wide(p.curvature);
            let tables = CandidateTables {
                azimuths: p.azimuths,
                nodes: &nodes,
                steepening,
                candidates: &candidates(tables),
            };
            tables.sheen(&ray)
        }
        CERTIFIED => model::sine_of(ray.march_exact(1).max(ray.near())),
        _ => model::sine_of(ray.march(p.march_steps)),
    }
}

/// Greatest difference of the sines, and how many of `queries` are farther apart than `tolerance`.
fn compare(probe: &Probe, tables: &Tables, queries: &[Query], tolerance: f64) -> (f64, usize) {
    let answers = probe.evaluate(tables, queries);
    let mut greatest = 0.0_f64;
    let mut beyond = 0;
    for (query, answer) in queries.iter().zip(&answers) {
        assert!(answer.numbers().iter().all(|x| x.is_finite()), "{query:?}: {answer:?}");
        let difference = (f64::from(answer.horizon) - expected(tables, query)).abs();
        greatest = greatest.max(difference);
        if difference > tolerance {
            if beyond < 3 {
                println!("{}: {} {query:?}", answer.horizon, expected(tables, query));
            }
            beyond += 1;
        }
    }
    (greatest, beyond)
}

fn tables(method: u32, contents: u32) -> Tables {
    let mut parameters = random::parameters(SIZE, method);
    parameters.contents = contents;
    random::tables(SIZE, parameters, random::rough(SIZE, 1), 2)
}

#[test]
fn horizons_agree_with_the_model() {
    let probe = Probe::new();
    let methods = [
        (FLAT, CONTENTS_BETA_AND_DISTANCE),
        (PAPER, CONTENTS_BETA_AND_DISTANCE),
        (PAPER, CONTENTS_DISTANCE_AND_HEIGHT),
        (EXACT, CONTENTS_BETA_AND_DISTANCE),
        (EXACT, CONTENTS_DISTANCE_AND_HEIGHT),
        (SHEEN, support::CONTENTS_COMPACT),
        (CERTIFIED, support::CONTENTS_COMPACT),
        (MARCHED, support::CONTENTS_COMPACT),
    ];
    for kappa in [[0.0, 0.0], [0.0, 0.03], [-0.03, 0.0]] {
        let queries = queries(7, 4000, kappa);
        for (method, contents) in methods {
            let (greatest, beyond) = compare(&probe, &tables(method, contents), &queries, 1e-3);
            println!("{kappa:?} method {method} contents {contents}: {greatest:.2e}, {beyond} beyond");
        }
    }
}
