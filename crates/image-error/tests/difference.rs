//! The measures that look at pixels one by one: against values worked out by hand, an oracle that is
//! written down plainly, and the laws that they obey.

#![allow(clippy::float_cmp, reason = "what is compared exactly is exact by design")]

mod support;

use image_error::{Error, Image, bias, compare, energy_ratio, mean_absolute, misclassified};
use image_error::{noise_relative_mse, percentile, relative_mse};
use proptest::{collection::vec, prelude::*};
use support::{image, noise};

fn row(pixels: &[[f32; 3]]) -> Image {
    Image::row(pixels.to_vec()).unwrap()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} instead of {expected}");
}

#[test]
fn numbers_worked_out_by_hand() {
    let reference = row(&[[1.0, 1.0, 1.0], [2.0, 0.0, 4.0]]);
    let found = row(&[[1.5, 1.0, 1.0], [1.0, 0.5, 4.0]]);
    let errors = compare(&found, &reference).unwrap();
    // The mean of y^2 is 23 / 6.
    let eps = 0.01 * 23.0 / 6.0;
    assert_near(errors.relative_mse, (0.25 / (1.0 + eps) + 1.0 / (4.0 + eps) + 0.25 / eps) / 6.0);
    assert_near(errors.mean_absolute, 2.0 / 6.0);
    assert_near(errors.mean_signed, 0.0);
    assert_near(errors.energy_ratio, 1.0);
    assert_near(errors.relative_bias, 0.0);
    assert_near(errors.largest, 1.0);
    assert_near(errors.percentile_99_9, 1.0);
    assert_near(percentile(&found, &reference, 0.5).unwrap(), 0.5);
    assert_near(percentile(&found, &reference, 0.0).unwrap(), 0.5);
    assert_eq!((errors.compared, errors.non_finite), (2, 0));
}

#[test]
fn percentile_leaves_the_named_share_of_pixels_above() {
    let reference = image([1000, 1], |_, _, _| 0.0);
    let found = image([1000, 1], |x, _, channel| if channel == 1 { -f64::from(x * 37 % 1000) } else { 0.0 });
    assert_near(compare(&found, &reference).unwrap().percentile_99_9, 998.0);
    assert_near(percentile(&found, &reference, 0.25).unwrap(), 249.0);
    assert_near(percentile(&found, &reference, 1.0).unwrap(), 999.0);
    for quantile in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(percentile(&found, &reference, quantile), Err(Error::OutOfRange { .. })));
    }
}

#[test]
fn pixels_that_are_not_finite_are_counted_and_left_out() {
    let reference = [[1.0, 2.0, 3.0], [0.5, 0.5, 0.5], [f32::INFINITY, 1.0, 1.0], [4.0, 4.0, 4.0]];
    let found = [[1.1, 2.0, 2.0], [0.5, f32::NAN, 0.5], [1.0, 1.0, 1.0], [4.0, 5.0, 4.0]];
    let errors = compare(&row(&found), &row(&reference)).unwrap();
    let expected = compare(&row(&[found[0], found[3]]), &row(&[reference[0], reference[3]])).unwrap();
    assert_eq!((errors.compared, errors.non_finite), (2, 2));
    assert_eq!(errors.relative_mse.to_bits(), expected.relative_mse.to_bits());
    assert_eq!(errors.mean_absolute.to_bits(), expected.mean_absolute.to_bits());
    assert_eq!(errors.largest.to_bits(), expected.largest.to_bits());
    let nothing = compare(&row(&found[1..3]), &row(&reference[1..3]));
    assert_eq!(nothing, Err(Error::NothingFinite { pixels: 2 }));
}

#[test]
fn black_references_have_documented_limits() {
    let (black, grey) = (row(&[[0.0; 3]; 4]), row(&[[0.5; 3]; 4]));
    let same = compare(&black, &black).unwrap();
    assert_eq!((same.relative_mse, same.energy_ratio, same.relative_bias), (0.0, 1.0, 0.0));
    let other = compare(&grey, &black).unwrap();
    assert_eq!((other.relative_mse, other.energy_ratio), (f64::INFINITY, f64::INFINITY));
    assert_eq!((other.mean_absolute, other.mean_signed), (0.5, 0.5));
    let darker = row(&[[-0.5; 3]; 4]);
    assert_eq!(energy_ratio(&darker, &black).unwrap(), f64::NEG_INFINITY);
    assert_eq!(compare(&black, &grey).unwrap().energy_ratio, 0.0);
}

#[test]
fn sizes_are_checked() {
    assert_eq!(Image::new(0, 3, vec![]), Err(Error::Empty { width: 0, height: 3 }));
    assert_eq!(Image::row(vec![]), Err(Error::Empty { width: 0, height: 1 }));
    assert_eq!(Image::new(2, 2, vec![[0.0; 3]; 3]), Err(Error::Length { width: 2, height: 2, found: 3 }));
    let huge = Image::new(usize::MAX, 2, vec![[0.0; 3]; 3]);
    assert_eq!(huge, Err(Error::Length { width: usize::MAX, height: 2, found: 3 }));
    let (wide, high) = (image([3, 2], |_, _, _| 0.5), image([2, 3], |_, _, _| 0.5));
    let error = compare(&wide, &high).unwrap_err();
    assert_eq!(error.to_string(), "the image has 3 x 2 pixels, its reference 2 x 3; make them alike");
    assert!(misclassified(&wide, &high, 0.5).is_err());
}

#[test]
fn misclassified_pixels_are_those_on_the_other_side() {
    let reference = Image::from_grey(5, 1, &[0.0, 1.0, 1.0, 0.0, 0.5]).unwrap();
    let found = Image::from_grey(5, 1, &[0.4, 0.6, 0.4, 0.6, 0.5]).unwrap();
    assert_near(misclassified(&found, &reference, 0.5).unwrap(), 0.4);
    assert_near(misclassified(&found, &found, 0.5).unwrap(), 0.0);
    assert!(misclassified(&found, &reference, f32::NAN).is_err());
    let colours = row(&[[0.0, 0.0, 1.0]]);
    assert_near(misclassified(&colours, &row(&[[0.0; 3]]), 0.5).unwrap(), 1.0);
}

#[test]
fn noise_of_the_reference_is_what_it_adds_on_average() {
    let size = [256, 256];
    let truth = |x: u32, y: u32, c: u32| 1.0 + f64::from(x + 2 * y) / 256.0 + f64::from(c);
    // Uniform noise of this width has a variance of a twelfth of its square.
    let width = |x: u32| 0.02 + 0.2 * f64::from(x) / 256.0;
    // Errors of both signs, so that the noise of the denominators has no direction.
    let found = image(size, |x, y, c| truth(x, y, c) * if (x + y) % 2 == 0 { 1.01 } else { 0.99 });
    let noisy = image(size, |x, y, c| truth(x, y, c) + width(x) * (noise(x, y, c, 1) - 0.5));
    let variance = support::values(size, |x, _, _| width(x).powi(2) / 12.0);

    let against_truth = relative_mse(&found, &image(size, truth)).unwrap();
    let against_noise = relative_mse(&found, &noisy).unwrap();
    let noise = noise_relative_mse(&noisy, &variance).unwrap();
    assert!(noise > 0.5 * against_truth, "the noise is too small to be seen");
    let found = against_noise - noise;
    assert!((found - against_truth).abs() < 0.02 * against_truth, "{found} instead of {against_truth}");
}

#[test]
fn variances_that_are_none_are_refused() {
    let reference = row(&[[1.0; 3], [2.0; 3]]);
    let fine = [0.25; 3];
    assert!(noise_relative_mse(&reference, &[fine]).is_err());
    assert_eq!(
        noise_relative_mse(&reference, &[fine, [0.1, -0.5, 0.1]]),
        Err(Error::Variance { pixel: 1, found: -0.5 })
    );
    assert!(noise_relative_mse(&reference, &[fine, [f32::NAN; 3]]).is_err());
    let unknown = noise_relative_mse(&reference, &[fine, [f32::INFINITY; 3]]).unwrap();
    assert_eq!(unknown, f64::INFINITY);
    let eps = 0.01 * 2.5;
    assert_near(
        noise_relative_mse(&reference, &[fine, fine]).unwrap(),
        0.125 / (1.0 + eps) + 0.125 / (4.0 + eps),
    );
    let partly = row(&[[1.0; 3], [f32::NAN; 3]]);
    assert_near(noise_relative_mse(&partly, &[fine, [f32::NAN; 3]]).unwrap(), 0.25 / 1.01);
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let size = [300, 250];
    let reference = image(size, |x, y, c| 1.0 / (0.001 + noise(x, y, c, 1)));
    let found = image(size, |x, y, c| 1.0 / (0.001 + noise(x, y, c, 2)));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| compare(&found, &reference).unwrap())
    };
    assert_eq!(on(1), on(7));
}

/// The same as [`relative_mse`], as plainly as it can be said.
fn plain_relative_mse(found: &[[f32; 3]], reference: &[[f32; 3]]) -> f64 {
    let flat =
        |pixels: &[[f32; 3]]| pixels.iter().flatten().map(|&value| f64::from(value)).collect::<Vec<_>>();
    let (x, y) = (flat(found), flat(reference));
    let count = x.len() as f64;
    let eps = 0.01 * y.iter().map(|y| y * y).sum::<f64>() / count;
    x.iter().zip(&y).map(|(x, y)| (x - y).powi(2) / (y * y + eps)).sum::<f64>() / count
}

fn pixels() -> impl Strategy<Value = Vec<([f32; 3], [f32; 3])>> {
    vec(([0.0_f32..100.0, 0.0..1.0, 0.0..0.01], [0.001_f32..100.0, 0.0..1.0, 0.0..0.01]), 1..60)
}

/// Every bit pattern of f32.
fn anything() -> impl Strategy<Value = [f32; 3]> {
    prop_oneof![
        any::<[u32; 3]>().prop_map(|bits| bits.map(f32::from_bits)),
        Just([0.0; 3]),
        Just([f32::MAX, f32::MIN, f32::MIN_POSITIVE]),
        Just([1e-45, -1e-45, 0.0]),
    ]
}

proptest! {
    #[test]
    fn measures_obey_their_laws(pairs in pixels(), scale in 0.001_f32..1000.0) {
        let (found, reference): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        let errors = compare(&row(&found), &row(&reference)).unwrap();
        let plain = plain_relative_mse(&found, &reference);
        prop_assert!((errors.relative_mse - plain).abs() <= 1e-12 * plain);

        // The single functions say the same as the report.
        let (x, y) = (row(&found), row(&reference));
        prop_assert_eq!(relative_mse(&x, &y).unwrap(), errors.relative_mse);
        prop_assert_eq!(mean_absolute(&x, &y).unwrap(), errors.mean_absolute);
        prop_assert_eq!(bias(&x, &y).unwrap(), errors.mean_signed);
        prop_assert_eq!(energy_ratio(&x, &y).unwrap(), errors.energy_ratio);
        prop_assert_eq!(percentile(&x, &y, 1.0).unwrap(), errors.largest);

        // Scale: to within the rounding of the scaled images.
        let scaled = |pixels: &[[f32; 3]]| row(&pixels.iter().map(|p| p.map(|v| v * scale)).collect::<Vec<_>>());
        let other = compare(&scaled(&found), &scaled(&reference)).unwrap();
        prop_assert!((other.relative_mse - errors.relative_mse).abs() <= 1e-4 * (errors.relative_mse + 1e-6));
        let expected = errors.mean_absolute * f64::from(scale);
        prop_assert!((other.mean_absolute - expected).abs() <= 1e-4 * expected + 1e-6);

        // Exchange: the bias changes its sign, the absolute error does not.
        let back = compare(&y, &x).unwrap();
        prop_assert_eq!(back.mean_signed, -errors.mean_signed);
        prop_assert_eq!(back.mean_absolute, errors.mean_absolute);
        prop_assert!(errors.mean_signed.abs() <= errors.mean_absolute * (1.0 + 1e-12));
        prop_assert!(errors.percentile_99_9 <= errors.largest);

        // More light is a positive bias.
        let brighter = row(&reference.iter().map(|p| p.map(|v| v + 0.5)).collect::<Vec<_>>());
        prop_assert!(bias(&brighter, &y).unwrap() > 0.49);
        prop_assert!(energy_ratio(&brighter, &y).unwrap() > 1.0);

        let same = compare(&y, &y).unwrap();
        prop_assert_eq!((same.relative_mse, same.mean_absolute, same.largest), (0.0, 0.0, 0.0));
        prop_assert_eq!((same.energy_ratio, same.mean_signed), (1.0, 0.0));
    }

    #[test]
    fn no_input_gives_nan(pairs in vec((anything(), anything()), 1..20), threshold in any::<f32>()) {
        let (found, reference): (Vec<_>, Vec<_>) = pairs.iter().copied().unzip();
        let finite = |pixel: &[f32; 3]| pixel.iter().all(|value| value.is_finite());
        let compared = pairs.iter().filter(|(x, y)| finite(x) && finite(y)).count();
        let (x, y) = (row(&found), row(&reference));
        match compare(&x, &y) {
            Err(error) => {
                prop_assert_eq!(error, Error::NothingFinite { pixels: pairs.len() });
                prop_assert_eq!(compared, 0);
            }
            Ok(errors) => {
                prop_assert_eq!((errors.compared, errors.non_finite), (compared, pairs.len() - compared));
                let all = [
                    errors.relative_mse, errors.mean_absolute, errors.mean_signed, errors.relative_bias,
                    errors.energy_ratio, errors.percentile_99_9, errors.largest,
                ];
                prop_assert!(all.iter().all(|value| !value.is_nan()), "{all:?}");
                prop_assert!(errors.relative_mse >= 0.0 && errors.mean_absolute >= 0.0);
            }
        }
        let _ = misclassified(&x, &y, threshold);
        if let Ok(noise) = noise_relative_mse(&y, &found) {
            prop_assert!(noise >= 0.0);
        }
    }
}
