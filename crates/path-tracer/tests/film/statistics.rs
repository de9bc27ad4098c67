//! Means, variances, counts and limits.

use crate::common::{SIZE, empty, film, identity, radiance};
use path_tracer::Film;
use path_tracer::film::{MAX_RADIANCE, MAX_SAMPLES_PER_PIXEL, MAX_SIDE, PixelSums};

/// Mean and unbiased variance of the mean in two passes.
fn two_pass(samples: &[f64]) -> (f64, f64) {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let spread: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
    (mean, spread / (count - 1.0) / count)
}

#[test]
fn mean_and_variance_are_those_of_two_passes() {
    let film = film(3..40);
    let (means, variances) = (film.mean(), film.variance_of_mean());
    for pixel in 0..means.len() {
        for channel in 0..3 {
            let samples: Vec<f64> = (3..40).map(|sample| radiance(pixel, sample)[channel]).collect();
            let (mean, variance) = two_pass(&samples);
            let close = |found: f32, expected: f64| (f64::from(found) / expected - 1.0).abs() < 1e-6;
            assert!(close(means[pixel][channel], mean), "{} {mean}", means[pixel][channel]);
            assert!(close(variances[pixel][channel], variance), "{} {variance}", variances[pixel][channel]);
        }
    }
}

#[test]
fn the_variance_is_unbiased() {
    // Over all pairs of four values with repetition, the mean of the estimates is the variance of
    // the mean of two: that of one value over 2.
    let values = [0.0, 1.0, 5.0, 10.0];
    let mut estimates = 0.0;
    for a in values {
        for b in values {
            let mut sums = PixelSums::default();
            sums.add([a; 3]);
            sums.add([b; 3]);
            estimates += f64::from(sums.variance_of_mean(2)[0]) / 16.0;
        }
    }
    let expected = (16.0 + 9.0 + 1.0 + 36.0) / 4.0 / 2.0;
    assert!((estimates - expected).abs() < 1e-6, "{estimates} {expected}");
}

#[test]
fn constants_have_no_variance_and_few_samples_an_infinite_one() {
    for value in [0.0, 1e-9, 0.1, 1.0 / 3.0, 12345.678, MAX_RADIANCE] {
        let mut sums = PixelSums::default();
        assert_eq!(sums.mean(0), [0.0; 3]);
        assert_eq!(sums.variance_of_mean(0), [f32::INFINITY; 3]);
        sums.add([value; 3]);
        assert_eq!(sums.variance_of_mean(1), [f32::INFINITY; 3]);
        (1..1000).for_each(|_| sums.add([value; 3]));
        let [mean, ..] = sums.mean(1000).map(f64::from);
        assert!((mean - value).abs() <= 2_f64.powi(-42) + value * 6e-8, "{mean} {value}");
        // 2^-22 for the rounding of the squares, 2^-26 of the value for that of f64.
        let floor = (2_f64.powi(-22) + value * 2_f64.powi(-26)).powi(2) / 999.0;
        let [variance, ..] = sums.variance_of_mean(1000).map(f64::from);
        assert!((0.0..floor).contains(&variance), "{value}: {variance} {floor}");
    }
}

#[test]
fn what_is_no_radiance_is_counted_and_adds_nothing() {
    let mut film = empty();
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-300] {
        film.add(5, [1.0, odd, 1.0]);
    }
    film.add(5, [-0.0, 0.0, 8.0]);
    film.add(6, [1.0, 2e9, 1e300]);
    film.add(7 * 19, [1.0; 3]);
    film.finish_samples(0..5).unwrap();
    assert_eq!((film.invalid(), film.clamped()), (4, 1));
    assert_eq!((film.pixels()[5].invalid(), film.pixels()[6].clamped()), (4, 1));
    let mean = film.mean();
    assert_eq!(mean[5], [0.0, 0.0, 1.6]);
    let most = (MAX_RADIANCE / 5.0) as f32;
    assert_eq!(mean[6], [0.2, most, most]);
    assert_eq!(mean[4], [0.0; 3]);
}

#[test]
fn sums_do_not_overflow_at_the_limit() {
    let mut sums = PixelSums::default();
    sums.add([MAX_RADIANCE; 3]);
    // Doubling 24 times makes 2^24 samples.
    for _ in 0..24 {
        let same = sums;
        sums.merge(&same);
    }
    assert_eq!(sums.mean(MAX_SAMPLES_PER_PIXEL), [MAX_RADIANCE as f32; 3]);
    assert_eq!(sums.variance_of_mean(MAX_SAMPLES_PER_PIXEL), [0.0; 3]);
}

#[test]
fn sizes_are_checked_before_memory_is_taken() {
    for size in [[0, 1], [1, 0], [MAX_SIDE + 1, 1], [MAX_SIDE, MAX_SIDE], [u32::MAX, u32::MAX]] {
        let error = Film::new(size, identity()).unwrap_err().to_string();
        assert!(error.contains(&format!("{} x {}", size[0], size[1])), "{error}");
        assert!(error.contains("expected 1 to 16384"), "{error}");
    }
    assert_eq!(Film::new(SIZE, identity()).unwrap().size(), SIZE);
    assert_eq!(size_of::<PixelSums>(), 112, "as documented");
}

#[test]
fn samples_are_finished_once() {
    let mut film = empty();
    assert_eq!(film.samples().to_string(), "none");
    film.finish_samples(8..16).unwrap();
    film.finish_samples(0..4).unwrap();
    film.finish_samples(20..20).unwrap();
    assert_eq!(film.samples().to_string(), "0..4, 8..16");
    for (range, both) in
        [(3..4, "3..4"), (0..100, "0..4"), (4..9, "8..9"), (5..9, "8..9"), (15..17, "15..16")]
    {
        let error = film.finish_samples(range).unwrap_err().to_string();
        assert!(error.contains(&format!("found {both} twice")), "{error}");
    }
    film.finish_samples(4..8).unwrap();
    assert_eq!(film.samples().to_string(), "0..16");
    assert_eq!(film.samples_per_pixel(), 16);
    let error = film.finish_samples(16..u32::MAX).unwrap_err().to_string();
    assert!(error.contains("4294967295 samples a pixel, expected at most 16777216"), "{error}");
    film.finish_samples(u32::MAX - 3..u32::MAX).unwrap();
    assert_eq!(film.samples_per_pixel(), 19);
}
