//! Films of made-up samples.

use path_tracer::{Film, Identity};
use std::ops::Range;

pub(crate) const SIZE: [u32; 2] = [7, 19];

pub(crate) fn identity() -> Identity {
    Identity {
        scene: "Überlänge.toml".into(),
        fingerprint: 0x0123_4567_89ab_cdef_0000_0000_0000_00ff,
        version: "0.1.0".into(),
        seed: u64::MAX,
        settings: "max bounces 3".into(),
    }
}

/// A radiance of many magnitudes, as a pure function.
pub(crate) fn radiance(pixel: usize, sample: u32) -> [f64; 3] {
    std::array::from_fn(|channel| {
        let mut bits = (pixel as u64) << 40 | u64::from(sample) << 8 | channel as u64;
        // The finalizer of SplitMix64.
        bits = (bits ^ bits >> 30).wrapping_mul(0xbf58476d1ce4e5b9);
        bits = (bits ^ bits >> 27).wrapping_mul(0x94d049bb133111eb);
        bits ^= bits >> 31;
        let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        10_f64.powf(12.0 * unit - 6.0)
    })
}

pub(crate) fn empty() -> Film {
    Film::new(SIZE, identity()).unwrap()
}

pub(crate) fn film(samples: Range<u32>) -> Film {
    let mut film = empty();
    for (pixel, sums) in film.pixels_mut().iter_mut().enumerate() {
        samples.clone().for_each(|sample| sums.add(radiance(pixel, sample)));
    }
    film.finish_samples(samples).unwrap();
    film
}
