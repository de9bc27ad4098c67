//! The library's WGSL against the f64 model, on reliefs that look random and tables whose codes are.

#![allow(missing_docs, reason = "tests")]
#![allow(clippy::float_cmp, reason = "exact answers are promised")]

mod support;

use horizon_shadow::model::{self, Candidate, CandidateTables, Map, Point, Published, Ray, Slices, View};
use support::{
    CERTIFIED, CONTENTS_BETA_AND_DISTANCE, CONTENTS_COMPACT, CONTENTS_DISTANCE_AND_HEIGHT, EXACT, FLAT,
    MARCHED, PAPER, Probe, Query, SHEEN, Tables,
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
            let mut bend = [0; 3].map(|_: u8| random.between(kappa[0], kappa[1]));
            bend[1] *= 0.1;
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
    let radius_texels = p.radius_texels.into();
    let is_turned = [SHEEN, CERTIFIED, MARCHED].contains(&p.method);
    let ray = if is_turned {
        Ray::turned(&relief, &view, radius_texels)
    } else {
        Ray::new(&relief, &view, radius_texels)
    };
    let steepening = ray.texels_per_height / map.texels_per_height;
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
        CERTIFIED => {
            // Marched from where the near field ends.
            let crossings = ray.crossings(model::NEAR_TEXELS, ray.radius_texels);
            let start = ray.near().max(ray.floor());
            let best = crossings.windows(2).fold(start, |best, pair| {
                best.max(ray.tangent(0.5 * (pair[0] + pair[1]))).max(ray.tangent(pair[1]))
            });
            model::sine_of(best)
        }
        _ => model::sine_of(ray.march(p.march_steps)),
    }
}

/// Greatest difference of the sines, the model's minus the shader's, and the other way round.
fn differences(probe: &Probe, tables: &Tables, queries: &[Query]) -> [f64; 2] {
    let answers = probe.evaluate(tables, queries);
    let mut greatest = [0.0_f64; 2];
    for (query, answer) in queries.iter().zip(&answers) {
        assert!(answer.numbers().iter().all(|x| x.is_finite()), "{query:?}: {answer:?}");
        let more = expected(tables, query) - f64::from(answer.horizon);
        greatest = [greatest[0].max(more), greatest[1].max(-more)];
    }
    greatest
}

fn tables(method: u32, contents: u32) -> Tables {
    let mut parameters = random::parameters(SIZE, method);
    parameters.contents = contents;
    random::tables(SIZE, parameters, random::rough(SIZE, 1), 2)
}

const CURVATURES: [[f64; 2]; 3] = [[0.0, 0.0], [0.0, 0.03], [-0.03, 0.0]];

#[test]
fn horizons_agree_with_the_model() {
    let probe = Probe::new();
    for kappa in CURVATURES {
        let queries = queries(7, 4000, kappa);
        for method in [SHEEN, MARCHED] {
            let [more, less] = differences(&probe, &tables(method, CONTENTS_COMPACT), &queries);
            println!("curvature {kappa:?}, method {method}: {more:.1e}, {less:.1e}");
            assert!(more.max(less) < 2e-5, "{kappa:?} {method}: {more} {less}");
        }
    }
}

const PUBLISHED: [(u32, u32); 5] = [
    (FLAT, CONTENTS_BETA_AND_DISTANCE),
    (PAPER, CONTENTS_BETA_AND_DISTANCE),
    (PAPER, CONTENTS_DISTANCE_AND_HEIGHT),
    (EXACT, CONTENTS_BETA_AND_DISTANCE),
    (EXACT, CONTENTS_DISTANCE_AND_HEIGHT),
];

#[test]
fn the_published_methods_agree_with_the_model() {
    let probe = Probe::new();
    for kappa in CURVATURES {
        let queries = queries(7, 2000, kappa);
        for (method, contents) in PUBLISHED {
            // Samplers may return 8 bits again: a code of the angle is an 80th of a radian, and one of
            // the distance a tenth of a texel, over which this relief may rise by a quarter.
            let tables = tables(method, contents);
            let [more, less] = differences(&probe, &tables, &queries);
            println!("curvature {kappa:?}, method {method}, contents {contents}: {more:.1e}, {less:.1e}");
            let code = if contents == CONTENTS_BETA_AND_DISTANCE { 1.3e-2 } else { 2.5e-2 };
            assert!(more.max(less) < code, "{kappa:?} {method} {contents}: {more} {less}");
            // Where all codes are the same nothing is lost.
            for stored in [[128, 128], [200, 3], [40, 250], [0, 100], [255, 60], [90, 0]] {
                let mut tables = tables.clone();
                tables.published.fill(stored);
                let [more, less] = differences(&probe, &tables, &queries);
                assert!(more.max(less) < 5e-5, "{kappa:?} {method} {contents} {stored:?}: {more} {less}");
            }
        }
    }
}

#[test]
fn marching_to_the_end_is_exact() {
    let probe = Probe::new();
    for kappa in CURVATURES {
        let queries = queries(8, 4000, kappa);
        // Random tables decide nothing where the whole horizon is wanted.
        let [more, less] = differences(&probe, &tables(CERTIFIED, CONTENTS_COMPACT), &queries);
        println!("curvature {kappa:?}: {more:.1e}, {less:.1e}");
        assert!(more.max(less) < 1e-4, "{kappa:?}: {more} {less}");
    }
}

/// Codes of every candidate of a brute-force search from the centres of texels.
fn searched(method: u32, seed: u64) -> Tables {
    let mut all = tables(method, CONTENTS_COMPACT);
    all.heights = random::rough(SIZE, seed);
    let p = all.parameters;
    let relief = random::relief(&all);
    let codes = horizon_shadow::codes::Codes::new(horizon_shadow::Precision::Compact, p.radius_texels);
    for azimuth in 0..p.azimuths {
        let angle = std::f64::consts::TAU * f64::from(azimuth) / f64::from(p.azimuths);
        let direction = [angle.cos(), angle.sin()];
        let step = 0.5 / direction[0].abs().max(direction[1].abs());
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let at = [f64::from(x), f64::from(y)];
                let texels_per_height = p.texels_per_height.into();
                let word = wide(p.curvature).map(|kappa| {
                    let ray =
                        Ray { relief: &relief, at, direction, kappa, texels_per_height, radius_texels: 24.0 };
                    let winner = (1..)
                        .map(|i| step * f64::from(i))
                        .skip_while(|&d| d < 1.0)
                        .take_while(|&d| d <= 24.0)
                        .max_by(|&a, &b| ray.tangent(a).total_cmp(&ray.tangent(b)))
                        .expect("samples");
                    let slope = (ray.height(winner) - ray.height(0.0)) / winner;
                    codes.encode(slope as f32, winner as f32)
                });
                all.candidates[((azimuth * SIZE[1] + y) * SIZE[0] + x) as usize] = word[0] | word[1] << 16;
            }
        }
    }
    all
}

#[test]
fn sheen_and_certified_are_near_the_truth() {
    let probe = Probe::new();
    let queries = queries(9, 3000, [0.0, 0.02]);
    let sheen = searched(SHEEN, 4);
    let truth: Vec<f64> = queries.iter().map(|query| exact_horizon(&sheen, query)).collect();
    let mean = |found: &[f64]| {
        let sum: f64 = found.iter().zip(&truth).map(|(a, b)| (a - b).abs().to_degrees()).sum();
        sum / truth.len() as f64
    };
    let horizons: Vec<f64> = probe
        .evaluate(&sheen, &queries)
        .iter()
        .map(|a| f64::from(a.horizon).clamp(-1.0, 1.0).asin())
        .collect();
    let error = mean(&horizons);
    println!("mean horizon error: {error:.3} degrees");
    // 16 azimuths on a rough map of 24 texels, with the 8-fold slopes of its finest octave.
    assert!(error < 1.2, "{error}");

    // Where bounds decide, they decide as marching does.
    let wrong = |method: u32| {
        let tables = with_method(&sheen, method);
        let answers = probe.evaluate(&tables, &queries);
        let wrong = answers.iter().zip(&queries).zip(&truth).filter(|((answer, query), truth)| {
            let sine = f64::from(query.light[2]);
            let lit = sine.asin() > **truth && sine > night_sine(&tables, query);
            lit != (answer.visibility > 0.5)
        });
        wrong.count() as f64 / truth.len() as f64
    };
    let [sheen, certified] = [wrong(SHEEN), wrong(CERTIFIED)];
    println!("misclassified: sheen {sheen:.4}, certified {certified:.4}");
    assert!(sheen < 0.03 && certified < 0.004, "{sheen} {certified}");
}

/// Radians, of the relief sampled finely.
fn exact_horizon(tables: &Tables, query: &Query) -> f64 {
    let relief = random::relief(tables);
    let view = View::new(&map(tables), &point(query), wide(query.light)).expect("a metric");
    Ray::turned(&relief, &view, tables.parameters.radius_texels.into()).march_exact(5).atan()
}

/// The sine under which nothing of a convex surface is lit.
fn night_sine(tables: &Tables, query: &Query) -> f64 {
    let view = View::new(&map(tables), &point(query), wide(query.light)).expect("a metric");
    if view.kappa < 0.0 {
        -2.0
    } else {
        model::sine_of(model::floor(view.kappa.max(1e-12), view.texels_per_height))
    }
}

fn with_method(tables: &Tables, method: u32) -> Tables {
    let mut tables = tables.clone();
    tables.parameters.method = method;
    tables
}

#[test]
fn visibility_is_the_part_of_the_disc_above_the_horizon() {
    let probe = Probe::new();
    let tables = tables(SHEEN, CONTENTS_COMPACT);
    let mut queries = queries(10, 4000, [-0.02, 0.0]);
    let mut random = Random(3);
    for query in &mut queries {
        query.light_radius_rad = if random.unit() < 0.3 { 0.0 } else { random.between(1e-3, 0.4) as f32 };
    }
    let mut partly = 0;
    for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
        let sine = f64::from(query.light[2]);
        let horizon = expected(&tables, query).asin();
        let radius = f64::from(query.light_radius_rad);
        let part = model::fraction(horizon, sine.asin(), radius);
        partly += usize::from(part > 0.0 && part < 1.0);
        let found = f64::from(answer.visibility);
        if radius > 0.0 {
            assert!((found - part).abs() < 2e-5 + 2e-5 / radius, "{query:?}: {found} {part}");
        } else if (sine.asin() - horizon).abs() > 1e-4 {
            assert!((found - part).abs() < 1e-6, "{query:?}: {found} {part}");
        }
    }
    assert!(partly > 200, "{partly}");
}

#[test]
fn tiles_decide_as_their_bounds_say() {
    let probe = Probe::new();
    let mut tables = tables(SHEEN, CONTENTS_COMPACT);
    tables.parameters.flags = 4;
    tables.parameters.curvature = [-1.0, 1.0];
    let queries = queries(11, 2000, [-0.02, 0.0]);
    // Horizons of all tiles between sines of 0.2 and 0.4, whatever the random candidates say.
    tables.extents.fill([153, 179]);
    let scaled = map(&tables);
    let mut decided = [0; 2];
    for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
        let view = View::new(&scaled, &point(query), wide(query.light)).expect("a metric");
        let sine = view.sine / view.sine.hypot(view.cosine * view.steepening(&scaled));
        if sine > 0.43 {
            assert_eq!(answer.visibility, 1.0, "{query:?}");
            decided[0] += 1;
        }
        if sine < 0.17 {
            assert_eq!(answer.visibility, 0.0, "{query:?}");
            decided[1] += 1;
        }
    }
    assert!(decided[0] > 300 && decided[1] > 300, "{decided:?}");
}

#[test]
fn small_bumps_take_the_share_of_lit_horizons() {
    let probe = Probe::new();
    let mut tables = tables(SHEEN, CONTENTS_COMPACT);
    tables.parameters.flags = 1;
    tables.parameters.curvature = [0.0, 0.02];
    tables.moments.fill([0.25, 0.0725, 0.5, 0.26]);
    let mut queries = queries(12, 2000, [0.0, 0.0]);
    for query in &mut queries {
        // Five texels of the map a pixel.
        query.uv_step = [5.0 / SIZE[0] as f32, 0.0];
        query.light_radius_rad = 0.1;
    }
    for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
        let sine = f64::from(query.light[2]);
        // The least curvature's moments: a half float keeps 0.0725 to 3e-5.
        let part = if sine < -0.1 { 0.0 } else { model::prefiltered(0.25, 0.0725, sine, 0.1) };
        assert!(
            (f64::from(answer.visibility) - part).abs() < 1.5e-3,
            "{query:?}: {} {part}",
            answer.visibility
        );
    }
}

#[test]
fn normals_are_those_of_the_relief() {
    let probe = Probe::new();
    let tables = tables(SHEEN, CONTENTS_COMPACT);
    let (map, relief) = (map(&tables), random::relief(&tables));
    let mut queries = queries(13, 2000, [0.0, 0.0]);
    queries[0].normal = [0.0, 0.0, 7.0];
    for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
        let at = [0, 1].map(|i| f64::from(query.uv[i]) * map.size[i] - 0.5);
        let rise =
            |u: f64, v: f64| relief.height([at[0] + u, at[1] + v]) - relief.height([at[0] - u, at[1] - v]);
        let slopes = [rise(0.5, 0.0) * map.size[0], rise(0.0, 0.5) * map.size[1]];
        let expected = point(query).bump_normal(&map, slopes.map(|slope| slope * map.height_scale_m));
        let apart = (0..3).map(|i| (f64::from(answer.normal[i]) - expected[i]).powi(2)).sum::<f64>().sqrt();
        assert!(apart < 2e-4, "{query:?}: {:?} {expected:?}", answer.normal);
        let height = relief.height(at) * map.height_scale_m;
        assert!((f64::from(answer.height_m) - height).abs() < 1e-4);
    }
}

#[test]
fn mirrored_coordinates_see_the_mirrored_relief() {
    let probe = Probe::new();
    let mut tables = searched(SHEEN, 5);
    tables.parameters.method = MARCHED;
    let queries = queries(14, 1000, [0.0, 0.02]);
    // The same surface with u running backwards, and the map's repeat with the sign turned.
    let mirrored: Vec<Query> = queries
        .iter()
        .map(|&q| {
            let [e, f, g] = q.second_form;
            Query { uv: [-q.uv[0], q.uv[1]], along_u: q.along_u.map(|c| -c), second_form: [e, -f, g], ..q }
        })
        .collect();
    let plain = probe.evaluate(&tables, &queries);
    tables.parameters.uv_scale[0] = -1.0;
    for (a, b) in plain.iter().zip(probe.evaluate(&tables, &mirrored)) {
        assert!((a.horizon - b.horizon).abs() < 1e-4, "{a:?} {b:?}");
        assert!((0..3).all(|i| (a.normal[i] - b.normal[i]).abs() < 1e-4), "{a:?} {b:?}");
    }
}

#[test]
fn units_do_not_matter() {
    let probe = Probe::new();
    let mut tables = searched(SHEEN, 6);
    let queries = queries(15, 1000, [0.0, 0.02]);
    let metres = probe.evaluate(&tables, &queries);
    for scale in [1e-3_f32, 1e3] {
        tables.parameters.height_scale_m = 4.0 * scale;
        let scaled: Vec<Query> = queries
            .iter()
            .map(|&q| Query {
                along_u: q.along_u.map(|c| c * scale),
                along_v: q.along_v.map(|c| c * scale),
                second_form: q.second_form.map(|c| c * scale),
                ..q
            })
            .collect();
        for (a, b) in metres.iter().zip(probe.evaluate(&tables, &scaled)) {
            assert!((a.horizon - b.horizon).abs() < 1e-4, "{scale}: {a:?} {b:?}");
        }
    }
}
