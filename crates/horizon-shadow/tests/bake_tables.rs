//! Sizes, limits and codes of the tables.

mod bake_support;

use bake_support::{Field, gpu};
use horizon_shadow::{
    Baker, Contents, Error, Heights, Parts, Precision, TableDesc, Tables, Wrap,
    codes::{Codes, SLOPE_SCALE},
};
use proptest::prelude::*;

fn desc(size: [u32; 2], azimuths: u32, contents: Contents) -> TableDesc {
    TableDesc {
        size,
        azimuths,
        contents,
        wrap: [Wrap::Repeat; 2],
        curvature_per_texel: [0.0, 0.02],
        texels_per_height: 10.0,
        radius_texels: 64.0,
    }
}

fn candidates(count: u32, precision: Precision) -> Contents {
    Contents::Candidates { count, precision }
}

#[test]
fn the_papers_memory_is_reproduced() {
    let paper = Contents::Published(Tables::BetaAndDistance);
    assert_eq!(desc([128, 128], 32, paper).memory_bytes(), 1_097_728);
    assert_eq!(desc([256, 256], 16, paper).memory_bytes(), 2_293_760);
}

#[test]
fn two_compact_candidates_take_less_than_twice_the_papers_memory() {
    let paper = Contents::Published(Tables::BetaAndDistance);
    for (size, azimuths) in [([128, 128], 32), ([256, 256], 16), ([100, 37], 64), ([256, 256], 4)] {
        let of = |contents| desc(size, azimuths, contents).memory_bytes();
        assert!(of(candidates(2, Precision::Compact)) <= 2 * of(paper));
        assert!(of(candidates(1, Precision::Compact)) < of(candidates(2, Precision::Compact)));
        assert!(of(Contents::Flat) < of(paper));
    }
}

#[test]
fn the_textures_take_what_the_description_says() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::rough([50, 30], 1);
    let view = field.view(&gpu);
    let heights = Heights { view: &view, range: field.range };
    for contents in [
        Contents::Flat,
        Contents::Published(Tables::BetaAndDistance),
        Contents::Published(Tables::DistanceAndHeight),
        candidates(1, Precision::Compact),
        candidates(2, Precision::Compact),
        candidates(3, Precision::Compact),
        candidates(1, Precision::Full),
        candidates(4, Precision::Full),
    ] {
        let desc = desc(field.size, 16, contents);
        let bake = baker.start(&gpu, &desc, &heights, Parts::default(), 0).expect("a bake");
        // The paper counts three bytes for height and normal, which are not the tables'.
        let tables = desc.memory_bytes() - 3 * 50 * 30;
        assert_eq!(bake.tables().memory_bytes(), tables, "{contents:?}");
    }
}

#[test]
fn one_curvature_is_enough_where_the_range_is_a_point() {
    let mut desc = desc([64, 64], 16, candidates(3, Precision::Compact));
    assert_eq!(desc.nodes(), [0.0, 0.01, 0.02]);
    desc.curvature_per_texel = [0.01, 0.01];
    assert_eq!(desc.nodes(), [0.01]);
    assert_eq!(desc.candidates(), 1);
    desc.contents = candidates(1, Precision::Compact);
    desc.curvature_per_texel = [-0.01, 0.03];
    assert!((desc.nodes()[0] - 0.01).abs() < 1e-9 && desc.nodes().len() == 1);
    desc.contents = Contents::Flat;
    assert_eq!((desc.nodes(), desc.candidates()), (vec![0.0], 0));
}

#[test]
fn numbers_out_of_range_are_named() {
    let good = desc([64, 64], 16, candidates(2, Precision::Compact));
    assert_eq!(good.check(), Ok(()));
    let named = |desc: TableDesc| match desc.check() {
        Err(Error::Value { what, .. }) => what,
        other => panic!("{other:?}"),
    };
    assert_eq!(named(TableDesc { size: [0, 64], ..good }), "height map's width");
    assert_eq!(named(TableDesc { size: [64, 0], ..good }), "height map's height");
    assert_eq!(named(TableDesc { azimuths: 3, ..good }), "azimuths");
    assert_eq!(named(TableDesc { azimuths: 65, ..good }), "azimuths");
    assert_eq!(named(TableDesc { contents: candidates(0, Precision::Full), ..good }), "candidates");
    assert_eq!(named(TableDesc { contents: candidates(5, Precision::Full), ..good }), "candidates");
    for curvature_per_texel in [[0.1, 0.0], [f32::NAN, 0.0], [0.0, f32::INFINITY]] {
        assert_eq!(named(TableDesc { curvature_per_texel, ..good }), "curvature per texel");
    }
    for texels_per_height in [-1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(named(TableDesc { texels_per_height, ..good }), "texels per height");
    }
    for radius_texels in [1.0, 5000.0, f32::NAN] {
        assert_eq!(named(TableDesc { radius_texels, ..good }), "radius in texels");
    }
}

#[test]
fn sizes_beyond_the_device_are_refused_before_memory_is_taken() {
    let gpu = gpu();
    let limit = gpu.device().limits().max_texture_dimension_2d;
    let contents = candidates(2, Precision::Compact);
    let refused = |size| match desc(size, 16, contents).check_device(&gpu) {
        Err(Error::Gpu(error @ gpu_context::Error::Limit { .. })) => error.to_string(),
        other => panic!("{other:?}"),
    };
    assert!(refused([limit + 1, 4]).contains(&format!("{}", limit + 1)));
    assert!(refused([4, limit + 1]).contains("height"));
    // A map that the device could hold, whose relief is larger than a buffer may be.
    let side = 8193.min(limit);
    if u64::from(side).pow(2) * 4 > gpu.device().limits().max_storage_buffer_binding_size {
        assert!(refused([side, side]).contains("bytes"));
    }
}

proptest! {
    #[test]
    fn codes_keep_slopes_and_distances(slope in -300.0_f32..300.0, t in 0.0_f32..1.0, radius in 2.0_f32..4096.0) {
        for precision in [Precision::Compact, Precision::Full] {
            let codes = Codes::new(precision, radius);
            let distance = 1.0 + (radius - 1.0) * t * t;
            let [found_slope, found_distance] = codes.decode(codes.encode(slope, distance));
            // Half a step of s / (scale + |s|), and half a step of the distance's root.
            let half_step = 1.0 / (1 << codes.slope_bits) as f32;
            let bounded = |s: f32| s / (SLOPE_SCALE + s.abs());
            let limit = 1.0 - 2.0 * half_step;
            prop_assert!((bounded(found_slope) - bounded(slope).clamp(-limit, limit)).abs() <= half_step * 1.01);
            let root = ((found_distance - 1.0) / (radius - 1.0)).max(0.0).sqrt();
            prop_assert!((root - t).abs() <= 0.5 / codes.greatest_distance_code() as f32 + 1e-3);
            prop_assert!((1.0..=radius * 1.0001).contains(&found_distance));
        }
    }

    #[test]
    fn codes_of_odd_numbers_are_within_range(slope in any::<f32>(), distance in any::<f32>()) {
        let codes = Codes::new(Precision::Compact, 64.0);
        let code = codes.encode(slope, distance);
        prop_assert!(code < 1 << 16);
        let [slope, distance] = codes.decode(code);
        prop_assert!(slope.is_finite() && (1.0..=64.0).contains(&distance));
    }
}

#[test]
fn level_ground_has_a_code() {
    for precision in [Precision::Compact, Precision::Full] {
        let codes = Codes::new(precision, 64.0);
        assert_eq!(codes.decode(codes.encode(0.0, 1.0)).map(f32::to_bits), [0.0_f32, 1.0].map(f32::to_bits));
        let [slope, distance] = codes.decode(codes.none());
        assert!(slope < -100.0 && distance <= 1.0);
        for (odd, extreme) in [(f32::NAN, -1.0), (f32::NEG_INFINITY, -1.0), (f32::INFINITY, 1.0)] {
            let slope = codes.slope(codes.slope_code(odd));
            assert!(slope.is_finite() && slope * extreme > 100.0, "{odd}: {slope}");
        }
    }
}
