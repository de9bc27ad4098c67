//! What FLIP must be, whatever the images: its laws, its answers to hostile input, and that neither
//! tiles nor threads show.

#![allow(clippy::float_cmp, reason = "what is compared exactly is exact by design")]

mod support;

use image_error::{Error, Image, flip};
use proptest::{collection::vec, prelude::*};
use support::{image, noise};

fn noisy(size: [u32; 2], seed: u32, scale: f64) -> Image {
    image(size, |x, y, c| scale * noise(x, y, c, seed))
}

const EXPOSURES: flip::Exposures = flip::Exposures { start: -3.0, stop: 2.0, count: 4 };

fn hdr_at(found: &Image, reference: &Image, exposures: flip::Exposures) -> flip::Hdr {
    flip::hdr_with(found, reference, 67.0, flip::ToneMapper::Aces, Some(exposures)).unwrap()
}

#[test]
fn an_image_is_no_different_from_itself() {
    let picture = noisy([70, 80], 1, 20.0);
    assert!(flip::ldr(&picture, &picture, 67.0).unwrap().values().iter().all(|&error| error == 0.0));
    let hdr = flip::hdr(&picture, &picture, 67.0).unwrap();
    assert!(hdr.map.values().iter().all(|&error| error == 0.0));
    assert!(hdr.exposure_map.iter().all(|&index| index == 0));
}

#[test]
fn opposite_colours_are_as_different_as_can_be() {
    let green = image([9, 9], |_, _, c| [0.0, 1.0, 0.0][c as usize]);
    let blue = image([9, 9], |_, _, c| [0.0, 0.0, 1.0][c as usize]);
    let map = flip::ldr(&green, &blue, 67.0).unwrap();
    assert!(map.values().iter().all(|error| (error - 1.0).abs() < 1e-5), "{:?}", map.statistics());
    let (black, white) = (image([9, 9], |_, _, _| 0.0), image([9, 9], |_, _, _| 1.0));
    let contrast = flip::ldr(&white, &black, 67.0).unwrap().mean();
    assert!((0.9..1.0).contains(&contrast), "{contrast}");
}

#[test]
fn errors_do_not_depend_on_which_image_comes_first() {
    let (one, other) = (noisy([90, 50], 1, 1.0), noisy([90, 50], 2, 0.7));
    assert_eq!(flip::ldr(&one, &other, 67.0), flip::ldr(&other, &one, 67.0));
    assert_eq!(hdr_at(&one, &other, EXPOSURES), hdr_at(&other, &one, EXPOSURES));
}

/// The filters reach ten pixels at this distance: further inside, a cut does not show. The cut
/// moves the borders of the tiles to other pixels.
#[test]
fn tiles_do_not_show() {
    let [width, height, left, top] = [600, 150, 37, 21];
    let cut = |seed| image([width - left, height - top], |x, y, c| noise(x + left, y + top, c, seed));
    let whole = flip::ldr(&noisy([width, height], 1, 1.0), &noisy([width, height], 2, 1.0), 67.0).unwrap();
    let part = flip::ldr(&cut(1), &cut(2), 67.0).unwrap();
    for y in top + 10..height {
        for x in left + 10..width {
            let one = whole.values()[(y * width + x) as usize];
            let other = part.values()[((y - top) * (width - left) + x - left) as usize];
            assert_eq!(one.to_bits(), other.to_bits(), "at {x}, {y}");
        }
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let (found, reference) = (noisy([300, 150], 1, 9.0), noisy([300, 150], 2, 9.0));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| flip::hdr(&found, &reference, 67.0).unwrap())
    };
    assert_eq!(on(1), on(5));
}

#[test]
fn the_exposure_map_names_the_exposure_that_is_worst() {
    let reference = image([40, 30], |x, y, c| 2.0_f64.powi(x as i32 / 5 - 4) * (0.5 + noise(x, y, c, 1)));
    let found = image([40, 30], |x, y, c| 2.0_f64.powi(x as i32 / 5 - 4) * (0.5 + noise(x, y, c, 2)));
    let exposures = flip::Exposures { start: -4.0, stop: 4.0, count: 5 };
    let hdr = hdr_at(&found, &reference, exposures);
    let single: Vec<_> = (0..exposures.count)
        .map(|index| {
            let stops = exposures.stops(index);
            assert_eq!(stops, 2.0 * index as f32 - 4.0);
            hdr_at(&found, &reference, flip::Exposures { start: stops, stop: stops, count: 1 }).map
        })
        .collect();
    for (i, (&error, &index)) in hdr.map.values().iter().zip(&hdr.exposure_map).enumerate() {
        assert_eq!(single[usize::from(index)].values()[i], error);
        assert!(single.iter().all(|map| map.values()[i] <= error));
    }
    let used = |index| hdr.exposure_map.contains(&index);
    assert!(used(0) && used(2) && used(4), "every brightness has its exposure");
}

#[test]
fn pixels_that_are_not_finite_have_no_error_and_do_not_spread() {
    let (found, reference) = (noisy([60, 40], 1, 1.0), noisy([60, 40], 2, 1.0));
    let clean = flip::ldr(&found, &reference, 67.0).unwrap();
    let mut pixels = found.pixels().to_vec();
    let hole = 20 * 60 + 30;
    pixels[hole][1] = f32::NAN;
    let broken = flip::ldr(&Image::new(60, 40, pixels).unwrap(), &reference, 67.0).unwrap();
    let statistics = broken.statistics();
    assert_eq!((broken.non_finite(), statistics.non_finite), (1, 1));
    assert!(broken.values()[hole].is_nan());
    assert_eq!(broken.heat_map()[hole], [0, 255, 0]);
    assert!((statistics.mean - clean.mean()).abs() < 0.01);
    let far = |i: usize| (i % 60).abs_diff(30) > 10 || (i / 60).abs_diff(20) > 10;
    for i in (0..60 * 40).filter(|&i| far(i)) {
        assert_eq!(broken.values()[i], clean.values()[i]);
    }
    let nothing = image([4, 4], |_, _, _| f64::NAN);
    let some = image([4, 4], |_, _, _| 1.0);
    assert_eq!(flip::ldr(&some, &nothing, 67.0), Err(Error::NothingFinite { pixels: 16 }));
    assert!(flip::hdr(&nothing, &some, 67.0).is_err());
}

#[test]
fn negative_values_are_black_and_the_largest_are_white() {
    let reference = noisy([20, 20], 1, 1.0);
    let with = |value: f64| image([20, 20], move |x, y, c| if x < 10 { value } else { noise(x, y, c, 2) });
    assert_eq!(flip::ldr(&with(-3.0), &reference, 67.0), flip::ldr(&with(0.0), &reference, 67.0));
    assert_eq!(flip::ldr(&with(1e30), &reference, 67.0), flip::ldr(&with(1.0), &reference, 67.0));
    for tone_mapper in [flip::ToneMapper::Aces, flip::ToneMapper::Reinhard, flip::ToneMapper::Hable] {
        let hdr = |value| flip::hdr_with(&with(value), &reference, 67.0, tone_mapper, None).unwrap();
        assert_eq!(hdr(-3.0), hdr(0.0));
        // Beyond the square root of the largest f32, and far below it.
        let (largest, white) = (hdr(f64::from(f32::MAX)).map, hdr(1e12).map);
        assert!(largest.values().iter().zip(white.values()).all(|(one, other)| (one - other).abs() < 1e-4));
        assert!(white.values()[0] > 0.5);
    }
}

#[test]
fn what_is_out_of_range_is_refused() {
    let (one, other) = (noisy([8, 8], 1, 1.0), noisy([8, 9], 1, 1.0));
    assert!(matches!(flip::ldr(&one, &other, 67.0), Err(Error::Size { .. })));
    assert!(matches!(flip::hdr(&one, &other, 67.0), Err(Error::Size { .. })));
    for pixels_per_degree in [0.0, -67.0, 0.5, 1001.0, f32::INFINITY, f32::NAN] {
        let error = flip::ldr(&one, &one, pixels_per_degree);
        assert!(matches!(error, Err(Error::OutOfRange { .. })), "{pixels_per_degree}");
    }
    let exposures = |start, stop, count| Some(flip::Exposures { start, stop, count });
    for wrong in [
        exposures(f32::NAN, 1.0, 2),
        exposures(0.0, f32::INFINITY, 2),
        exposures(1.0, 0.0, 2),
        exposures(0.0, 1.0, 0),
        exposures(0.0, 1.0, 1001),
        exposures(-121.0, 1.0, 2),
    ] {
        let error = flip::hdr_with(&one, &one, 67.0, flip::ToneMapper::Aces, wrong);
        assert!(matches!(error, Err(Error::OutOfRange { .. })), "{wrong:?}");
    }
    let black = noisy([8, 8], 1, 0.0);
    assert_eq!(flip::hdr(&one, &black, 67.0), Err(Error::BlackReference));
    assert_eq!(hdr_at(&black, &black, EXPOSURES).map.mean(), 0.0);
}

#[test]
fn the_nearest_and_furthest_viewers_are_served() {
    let (one, other) = (noisy([12, 9], 1, 1.0), noisy([12, 9], 2, 1.0));
    for pixels_per_degree in [1.0, 1000.0] {
        let map = flip::ldr(&one, &other, pixels_per_degree).unwrap();
        assert!(map.values().iter().all(|error| (0.0..=1.0).contains(error)));
        assert!(map.mean() > 0.01);
    }
}

#[test]
fn magma_goes_from_black_to_light_yellow() {
    assert_eq!(flip::magma(0.0), [0, 0, 4]);
    assert_eq!(flip::magma(64.4 / 255.0), [81, 18, 124]);
    assert_eq!(flip::magma(0.5), [183, 55, 121]);
    assert_eq!(flip::magma(1.0), [252, 253, 191]);
    assert_eq!((flip::magma(-1.0), flip::magma(7.0)), ([0, 0, 4], [252, 253, 191]));
    assert_eq!(flip::magma(f32::NAN), [0, 0, 4]);
    let luminance =
        |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    let rising = (0..255).all(|i| {
        luminance(flip::magma(i as f32 / 255.0)) < luminance(flip::magma((i + 1) as f32 / 255.0)) + 0.5
    });
    assert!(rising);
}

/// Every bit pattern of f32, and the values at the ends of its range.
fn anything() -> impl Strategy<Value = [f32; 3]> {
    prop_oneof![
        any::<[u32; 3]>().prop_map(|bits| bits.map(f32::from_bits)),
        any::<[u16; 3]>().prop_map(|values| values.map(|value| f32::from(value) / 1000.0)),
        Just([0.0; 3]),
        Just([f32::MAX, f32::MIN, f32::MIN_POSITIVE]),
        Just([1e-45; 3]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_input_gives_anything_but_an_error_in_range(
        pairs in vec((anything(), anything()), 1..30),
        tone_mapper in prop_oneof![
            Just(flip::ToneMapper::Aces), Just(flip::ToneMapper::Reinhard), Just(flip::ToneMapper::Hable)
        ],
        extreme in any::<bool>(),
    ) {
        let (found, reference): (Vec<_>, Vec<_>) = pairs.iter().copied().unzip();
        let finite = |pixel: &[f32; 3]| pixel.iter().all(|value| value.is_finite());
        let compared: Vec<_> = pairs.iter().map(|(x, y)| finite(x) && finite(y)).collect();
        let (x, y) = (Image::row(found).unwrap(), Image::row(reference).unwrap());
        let exposures = extreme.then_some(flip::Exposures { start: -120.0, stop: 120.0, count: 5 });
        let ldr = flip::ldr(&x, &y, 67.0);
        let hdr = flip::hdr_with(&x, &y, 67.0, tone_mapper, exposures);
        if !compared.contains(&true) {
            prop_assert!(ldr.is_err() && hdr.is_err());
            return Ok(());
        }
        let mut maps = vec![ldr.unwrap()];
        match hdr {
            Ok(hdr) => {
                prop_assert!(hdr.exposures.start.is_finite() && hdr.exposures.stop >= hdr.exposures.start);
                prop_assert!(hdr.exposure_map.iter().all(|&index| u32::from(index) < hdr.exposures.count));
                maps.push(hdr.map);
            }
            Err(error) => prop_assert_eq!(error, Error::BlackReference),
        }
        for map in maps {
            let in_range = |value: f64| (0.0..=1.0).contains(&value);
            for (&value, &compared) in map.values().iter().zip(&compared) {
                prop_assert_eq!(value.is_nan(), !compared);
                prop_assert!(!compared || in_range(f64::from(value)));
            }
            let s = map.statistics();
            prop_assert!(in_range(s.mean) && s.min <= s.weighted_quartile_1);
            prop_assert!(s.weighted_quartile_1 <= s.weighted_median && s.weighted_median <= s.weighted_quartile_3);
            prop_assert!(s.weighted_quartile_3 <= s.max && f64::from(s.min) <= s.mean * 1.000001);
        }
    }
}
