//! Inputs that break naive code: every answer is finite and in its range, and known answers are exact.

#![allow(missing_docs, reason = "tests")]
#![allow(clippy::float_cmp, reason = "exact answers are promised")]

mod support;

use support::{
    Answer, CERTIFIED, CONTENTS_BETA_AND_DISTANCE, CONTENTS_COMPACT, CONTENTS_DISTANCE_AND_HEIGHT, EXACT,
    FLAT, MARCHED, NONE, PAPER, Probe, Query, SHEEN, Tables,
    random::{self, Random},
};

const METHODS: [(u32, u32); 8] = [
    (NONE, CONTENTS_COMPACT),
    (FLAT, CONTENTS_BETA_AND_DISTANCE),
    (PAPER, CONTENTS_BETA_AND_DISTANCE),
    (PAPER, CONTENTS_DISTANCE_AND_HEIGHT),
    (EXACT, CONTENTS_BETA_AND_DISTANCE),
    (SHEEN, CONTENTS_COMPACT),
    (CERTIFIED, CONTENTS_COMPACT),
    (MARCHED, CONTENTS_COMPACT),
];

const ODD: [f32; 12] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-20,
    1e20,
    f32::MAX,
    -f32::MAX,
    f32::MIN_POSITIVE,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
];

fn assert_sound(answer: &Answer, what: impl Fn() -> String) {
    assert!(answer.numbers().iter().all(|x| x.is_finite()), "{}: {answer:?}", what());
    assert!((0.0..=1.0).contains(&answer.visibility), "{}: {answer:?}", what());
    assert!(answer.horizon.abs() <= 1.000_01, "{}: {answer:?}", what());
    let squared: f32 = answer.normal.iter().map(|c| c * c).sum();
    assert!((squared - 1.0).abs() < 1e-4, "{}: {answer:?}", what());
    assert!((0.0..=1.0).contains(&answer.ambient[3]), "{}: {answer:?}", what());
}

fn tables(size: [u32; 2], method: u32, contents: u32, heights: Vec<f32>) -> Tables {
    let mut parameters = random::parameters(size, method);
    parameters.contents = contents;
    parameters.flags = 1 | 2 | 4;
    random::tables(size, parameters, heights, 3)
}

/// Queries of ordinary numbers in which one to three are odd.
fn odd_queries(count: usize) -> Vec<Query> {
    let mut random = Random(17);
    (0..count)
        .map(|_| {
            let mut query = Query::on_plane([0.3, 0.6], [24.0, 17.0], [0.48, 0.6, 0.64]);
            query.second_form = [4.0, 1.0, 3.0];
            query.uv_step = [0.01, 0.01];
            let floats: &mut [f32] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut query));
            for _ in 0..=random.word() % 3 {
                let place = (random.word() % floats.len() as u64) as usize;
                floats[place] = ODD[(random.word() % ODD.len() as u64) as usize];
            }
            query
        })
        .collect()
}

#[test]
fn any_surface_and_light_has_an_answer() {
    let probe = Probe::new();
    let queries = odd_queries(6000);
    for (method, contents) in METHODS {
        let tables = tables([24, 17], method, contents, random::rough([24, 17], 1));
        for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
            assert_sound(&answer, || format!("method {method}: {query:?}"));
        }
    }
}

#[test]
fn any_map_has_an_answer() {
    let probe = Probe::new();
    let mut random = Random(5);
    let queries: Vec<Query> = (0..128)
        .map(|_| {
            let angle = random.between(-3.2, 3.2);
            let light = [0.8 * angle.cos(), 0.8 * angle.sin(), 0.6].map(|c| c as f32);
            let mut query = Query::on_plane(
                [random.between(-2.0, 3.0) as f32, random.between(-2.0, 3.0) as f32],
                [5.0, 500.0],
                light,
            );
            query.second_form = [random.between(-2.0, 2.0) as f32, 0.5, random.between(-2e4, 2e4) as f32];
            query.light_radius_rad = random.between(0.0, 0.1) as f32;
            query
        })
        .collect();
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 0.0, 1.0, 0.3, -5.0];
    for size in [[1, 1], [1, 9], [9, 1], [2, 2], [13, 7]] {
        for wrap in [0, 1, 3] {
            for (method, contents) in METHODS {
                let heights = (0..size[0] * size[1]).map(|i| odd[i as usize % odd.len()]).collect();
                let mut tables = tables(size, method, contents, heights);
                tables.parameters.wrap = wrap;
                for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
                    assert_sound(&answer, || format!("{size:?} {wrap} method {method}: {query:?}"));
                }
            }
        }
    }
}

#[test]
fn any_scale_has_an_answer() {
    let probe = Probe::new();
    let queries = {
        let mut random = Random(23);
        let mut all = Vec::new();
        // Millimetres, metres and kilometres; uv 100 times denser along one axis; tiny and huge bends.
        for extent in [[1e-3, 1e-3], [1.0, 100.0], [1e5, 1e3], [1e6, 1e6]] {
            for kappa in [0.0, 1e-12, 1e-4, 1e-2, 1.0, 100.0, -1e-12, -0.05, -1.0, -100.0_f32] {
                for _ in 0..20 {
                    let angle = random.between(-3.2, 3.2) as f32;
                    let sine = random.between(-1.0, 1.0) as f32;
                    let cosine = (1.0 - sine * sine).sqrt();
                    let light = [cosine * angle.cos(), cosine * angle.sin(), sine];
                    let mut query =
                        Query::on_plane([random.unit() as f32, random.unit() as f32], extent, light);
                    query.second_form = [kappa * extent[0] * extent[0], 0.0, kappa * extent[1] * extent[1]];
                    all.push(query);
                }
            }
        }
        all
    };
    for height_scale_m in [0.0, 1e-6, 1.0, 1e5] {
        for (method, contents) in METHODS {
            let mut tables = tables([24, 17], method, contents, random::rough([24, 17], 2));
            tables.parameters.height_scale_m = height_scale_m;
            tables.parameters.texels_per_height = height_scale_m;
            for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
                assert_sound(&answer, || format!("{height_scale_m} method {method}: {query:?}"));
            }
        }
    }
}

/// Candidates of level ground: slope 0, one texel away.
const LEVEL: u32 = 512 * 0x1_0001;

#[test]
fn level_ground_is_its_own_horizon() {
    let probe = Probe::new();
    for method in [SHEEN, CERTIFIED] {
        // Every height is 4, and the map's least is 0.
        let mut tables = tables([24, 17], method, CONTENTS_COMPACT, vec![1.0; 24 * 17]);
        tables.parameters.flags = 0;
        tables.candidates.fill(LEVEL);
        let mut queries = Vec::new();
        for i in 0..360 {
            let angle = (i as f32).to_radians();
            for sine in [-0.3, -1e-4, 1e-4, 0.3_f32] {
                let cosine = (1.0 - sine * sine).sqrt();
                let light = [cosine * angle.cos(), cosine * angle.sin(), sine];
                let mut query = Query::on_plane([i as f32 * 0.013, 0.37], [24.0, 17.0], light);
                query.second_form = [0.015 * 576.0, 0.0, 0.015 * 289.0];
                queries.push(query);
            }
        }
        for (query, answer) in queries.iter().zip(probe.evaluate(&tables, &queries)) {
            assert_eq!(answer.horizon, 0.0, "method {method}: {query:?}");
            assert_eq!(answer.visibility, f32::from(query.light[2] > 0.0), "method {method}: {query:?}");
        }
    }
}

#[test]
fn the_dip_of_small_heights_keeps_its_digits() {
    let probe = Probe::new();
    // Nothing but the smooth base's horizon: no candidate rises above -511.
    let mut tables = tables([24, 17], SHEEN, CONTENTS_COMPACT, vec![1.0; 24 * 17]);
    tables.candidates.fill(0x1_0001);
    tables.parameters.flags = 0;
    tables.parameters.heights = [0.0, 1.0];
    // A lone peak of one texel falls more steeply than the base.
    tables.heights.fill(0.0);
    tables.heights[8 * 24 + 12] = 1.0;
    tables.parameters.height_scale_m = 1.0;
    tables.parameters.texels_per_height = 1.0;
    for kappa in [1e-8_f32, 5e-8, 1e-6, 1e-3] {
        let mut query = Query::on_plane([12.5 / 24.0, 8.5 / 17.0], [24.0, 17.0], [1.0, 0.0, 0.0]);
        query.second_form = [kappa * 576.0, 0.0, kappa * 289.0];
        let found = f64::from(probe.evaluate(&tables, &[query])[0].horizon);
        let x = f64::from(kappa);
        let expected = -(x * (2.0 + x)).sqrt() / (1.0 + x);
        assert!((found / expected - 1.0).abs() < 1e-4, "{kappa}: {found} {expected}");
    }
}

#[test]
fn zenith_nadir_and_night() {
    let probe = Probe::new();
    for (method, contents) in METHODS.into_iter().skip(1) {
        let mut tables = tables([24, 17], method, contents, random::rough([24, 17], 1));
        tables.parameters.flags = 0;
        let mut zenith = Query::on_plane([0.3, 0.4], [24.0, 17.0], [0.0, 0.0, 1.0]);
        zenith.second_form = [0.01 * 576.0, 0.0, 0.01 * 289.0];
        let nadir = Query { light: [0.0, 0.0, -1.0], ..zenith };
        // sqrt(0.04 * 2.04) = 0.286 is the tangent of the dip at the greatest height.
        let night = Query { light: [0.954, 0.0, -0.3], ..zenith };
        let found = probe.evaluate(&tables, &[zenith, nadir, night]);
        assert_eq!(found[0].visibility, 1.0, "method {method}");
        assert_eq!(found[1].visibility, 0.0, "method {method}");
        if method != FLAT {
            assert_eq!(found[2].visibility, 0.0, "method {method}");
        }
    }
}

#[test]
fn both_sides_of_the_seam_see_the_same() {
    let probe = Probe::new();
    let tables = tables([24, 17], SHEEN, CONTENTS_COMPACT, random::rough([24, 17], 1));
    for y in [0.0, -0.0, 1e-7, -1e-7, 1e-30, -1e-30_f32] {
        let at = |y| Query::on_plane([0.31, 0.43], [24.0, 17.0], [-0.8, y, 0.6]);
        let found = probe.evaluate(&tables, &[at(y), at(1e-6)]);
        assert!((found[0].horizon - found[1].horizon).abs() < 1e-4, "{y}: {found:?}");
    }
}

#[test]
fn a_pole_is_lit_where_it_faces_the_light() {
    let probe = Probe::new();
    for (method, contents) in METHODS.into_iter().skip(1) {
        let tables = tables([24, 17], method, contents, random::rough([24, 17], 1));
        for (light, lit) in [([0.6, 0.0, 0.8], 1.0), ([0.6, 0.0, -0.8], 0.0)] {
            let mut query = Query::on_plane([0.3, 0.4], [0.0, 17.0], light);
            let both = [query, {
                query.along_v = [0.0; 3];
                query
            }];
            for answer in probe.evaluate(&tables, &both) {
                assert_eq!((answer.visibility, answer.horizon), (lit, 0.0), "method {method}");
                assert_eq!(answer.normal, [0.0, 0.0, 1.0]);
            }
        }
    }
}

#[test]
fn azimuths_that_are_not_baked_count_for_nothing() {
    let probe = Probe::new();
    let mut tables = tables([24, 17], SHEEN, CONTENTS_COMPACT, vec![0.5; 24 * 17]);
    tables.parameters.flags = 4;
    tables.extents.fill([255, 255]);
    // All candidates are walls.
    tables.candidates.fill(900 * 0x1_0001);
    let query = Query::on_plane([0.3, 0.4], [24.0, 17.0], [0.8, 0.1, 0.6]);
    assert_eq!(probe.evaluate(&tables, &[query])[0].visibility, 0.0);
    tables.parameters.baked_azimuths = [0; 2];
    let found = probe.evaluate(&tables, &[query])[0];
    assert_eq!((found.visibility, found.horizon), (1.0, 0.0));
}
