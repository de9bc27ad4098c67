//! Height maps that break naive bakes.

mod bake_support;

use bake_support::{Field, bake, cpu_layer, decoded, exact_tangent, gpu, layer};
use horizon_shadow::{
    Baker, Contents, Error, Heights, Parts, Precision, Search, TableDesc, Tables, Wrap, codes::Codes, cpu,
};

const SEARCHES: [Search; 2] = [Search::Sweep, Search::BruteForce];

#[test]
fn a_constant_map_of_height_4_has_no_horizon() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    // Height 4 above the least, which no texel has.
    let field = Field { range: [0.0, 4.0], ..Field::new([40, 24], |_, _| 4.0) };
    for search in SEARCHES {
        for curvature in [[0.0, 0.0], [0.015, 0.015], [0.0, 0.02]] {
            let desc = field.desc(2, curvature, 1.0);
            let baked = bake(&gpu, &baker, &field, &desc, search, 0b1010_0101);
            for (azimuth, node) in [(0, 0), (2, 0), (5, 0), (7, 0), (2, desc.nodes().len() - 1)] {
                for [slope, distance] in decoded(&desc, &layer(&gpu, &baked, azimuth), node) {
                    // The nearest of equals: the farthest would make -19.4 degrees of it.
                    assert!(slope == 0.0 && distance < 1.6, "{search:?} {curvature:?}: {slope} {distance}");
                }
            }
        }
    }
}

#[test]
fn maps_of_one_texel_row_or_column_are_baked() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    for size in [[1, 1], [1, 50], [50, 1], [3, 2], [257, 5]] {
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            let field =
                Field { wrap: [wrap; 2], ..Field::new(size, |x, y| ((x * 7 + y * 5) % 11) as f32 / 11.0) };
            let desc = field.desc(2, [-0.01, 0.02], 6.0);
            let view = field.view(&gpu);
            let heights = Heights { view: &view, range: field.range };
            for search in SEARCHES {
                let parts = Parts { prefilter: true, ambient: true };
                let mut baked = baker.start(&gpu, &desc, &heights, parts, u64::MAX).expect("a bake");
                bake_support::record(&gpu, &baker, &mut baked, search);
                for azimuth in [0, 3, 4, 9] {
                    let on_gpu = layer(&gpu, &baked, azimuth);
                    if search == Search::BruteForce {
                        assert_eq!(on_gpu, cpu_layer(&field, &desc, azimuth), "{size:?} {wrap:?}");
                    }
                    for [slope, distance] in decoded(&desc, &on_gpu, 0) {
                        assert!(slope.abs() <= 7.0 && (1.0..=32.0).contains(&distance), "{slope} {distance}");
                    }
                }
            }
        }
    }
    assert!(gpu.take_errors().is_empty());
}

#[test]
fn heights_that_are_no_numbers_count_as_the_least() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let clean =
        Field::new([48, 32], |x, y| if (x + 3 * y) % 5 == 0 { 0.0 } else { ((x * y) % 9) as f32 / 8.0 });
    let mut odd = clean.clone();
    let odd_values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -f32::NAN];
    for (i, value) in odd.values.iter_mut().enumerate().filter(|(_, value)| **value == 0.0) {
        *value = odd_values[i % 4];
    }
    let desc = clean.desc(2, [0.0, 0.02], 10.0);
    for search in SEARCHES {
        let [clean, odd] = [&clean, &odd].map(|field| bake(&gpu, &baker, field, &desc, search, 0xff));
        for azimuth in 0..8 {
            assert!(layer(&gpu, &clean, azimuth) == layer(&gpu, &odd, azimuth), "{search:?} {azimuth}");
        }
    }
    assert_eq!(cpu_layer(&clean, &desc, 3), cpu_layer(&odd, &desc, 3));
}

#[test]
fn spikes_and_steps_keep_their_steep_horizons() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let spike = Field::new([33, 33], |x, y| if [x, y] == [16, 16] { 1.0 } else { 0.0 });
    let step =
        Field { wrap: [Wrap::Clamp; 2], ..Field::new([33, 33], |x, _| if x < 16 { 0.0 } else { 1.0 }) };
    for search in SEARCHES {
        for (field, height) in [(&spike, 1e5_f32), (&step, 1e5), (&spike, 40.0), (&step, 40.0)] {
            let desc = field.desc(2, [0.0, 0.02], height);
            let baked = bake(&gpu, &baker, field, &desc, search, 1);
            let row = &decoded(&desc, &layer(&gpu, &baked, 0), 0)[16 * 33..17 * 33];
            for (x, &[slope, distance]) in row.iter().enumerate().take(15) {
                let to_top = (16 - x) as f32;
                let expected = height / to_top;
                // Slopes are bounded by their code, half a step short of vertical.
                let close =
                    if expected > 100.0 { slope > 80.0 } else { (slope / expected - 1.0).abs() < 0.1 };
                assert!(close, "{search:?} {height}: {slope} {expected} at {x}");
                assert!((distance - to_top).abs() <= 0.05 * to_top + 0.6, "{distance} at {x}");
            }
        }
    }
}

#[test]
fn horizons_beyond_a_quarter_turn_are_left_out() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::rough([64, 64], 9);
    // A quarter turn is 3.1 texels, and heights reach beyond the centre where it is concave.
    for curvature in [[0.5, 0.5], [-0.5, -0.5], [-0.2, 0.2], [1e3, 1e3], [-1e3, 1e3]] {
        let mut desc = field.desc(2, curvature, 8.0);
        desc.contents = Contents::Candidates { count: 2, precision: Precision::Full };
        for search in SEARCHES {
            let baked = bake(&gpu, &baker, &field, &desc, search, 0b1010_1011);
            for azimuth in [0, 1, 3, 5, 7] {
                let on_gpu = layer(&gpu, &baked, azimuth);
                let cpu = cpu_layer(&field, &desc, azimuth);
                for (node, &kappa) in desc.nodes().iter().enumerate() {
                    let horizons = |layer: &[u8]| -> Vec<f64> {
                        let candidates = decoded(&desc, layer, node);
                        let tangent = |(&height, [slope, distance]): (&f32, [f32; 2])| {
                            let height = f64::from(height * 8.0);
                            exact_tangent(kappa.into(), height, slope.into(), distance.into())
                        };
                        field.values.iter().zip(candidates).map(tangent).collect()
                    };
                    let [on_gpu, cpu] = [&on_gpu, &cpu].map(|layer| horizons(layer));
                    let higher = on_gpu.iter().zip(&cpu).filter(|(gpu, cpu)| gpu.atan() > cpu.atan() + 0.01);
                    // Close to the centre of curvature the code of a slope is no longer exact.
                    assert!(higher.count() <= 64 * 64 / 100, "{search:?} {kappa}: horizons that are none");
                    let none = Codes::new(Precision::Full, desc.radius_texels).decode(1).map(f32::to_bits);
                    for [slope, distance] in decoded(&desc, &layer(&gpu, &baked, azimuth), node) {
                        let turn = f64::from(kappa * distance).abs();
                        assert!(
                            [slope, distance].map(f32::to_bits) == none
                                || turn < 1.001 * std::f64::consts::FRAC_PI_2
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn published_tables_stay_in_their_bytes() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::new([20, 20], |x, y| if (x, y) == (9, 9) { 1.0 } else { 0.0 });
    for contents in [
        Contents::Flat,
        Contents::Published(Tables::BetaAndDistance),
        Contents::Published(Tables::DistanceAndHeight),
    ] {
        let desc = TableDesc { contents, radius_texels: 8.0, ..field.desc(1, [0.0, 0.0], 1e6) };
        for search in SEARCHES {
            let baked = bake(&gpu, &baker, &field, &desc, search, 1);
            let on_gpu = layer(&gpu, &baked, 0);
            assert_eq!(on_gpu, cpu_layer(&field, &desc, 0), "{contents:?} {search:?}");
            if contents != Contents::Published(Tables::DistanceAndHeight) {
                // Vertical beside the spike, level far from it.
                let texel = |x: usize| on_gpu[(9 * 20 + x) * desc.texel_bytes() as usize];
                assert_eq!([texel(8), texel(9)], [255, 0], "{contents:?} {search:?}");
            }
        }
    }
}

#[test]
fn heights_that_do_not_fit_are_refused() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::rough([16, 16], 1);
    let view = field.view(&gpu);
    let desc = field.desc(2, [0.0, 0.02], 8.0);
    let refused = |desc: &TableDesc, range| {
        let heights = Heights { view: &view, range };
        match baker.start(&gpu, desc, &heights, Parts::default(), 1) {
            Err(Error::Value { what, .. }) => what,
            other => panic!("{other:?}"),
        }
    };
    for range in [[1.0, 0.0], [f32::NAN, 1.0], [0.0, f32::INFINITY]] {
        assert_eq!(refused(&desc, range), "range of heights");
        let field = Field { range, ..field.clone() };
        let go_on = |_| std::ops::ControlFlow::Continue(());
        assert!(matches!(cpu::bake(&field.on_cpu(), &desc, 1, &go_on), Err(Error::Value { .. })));
    }
    assert_eq!(refused(&TableDesc { size: [16, 17], ..desc }, field.range), "height map's size");
    let short = cpu::HeightField { values: &field.values[1..], ..field.on_cpu() };
    let go_on = |_| std::ops::ControlFlow::Continue(());
    assert!(matches!(cpu::bake(&short, &desc, 1, &go_on), Err(Error::Value { what: "height field", .. })));
}
