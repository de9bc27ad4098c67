//! Procedural images that any language makes to the same bits.

use image_error::Image;

/// Uniform in 0..1, of a pixel, a channel and a seed.
pub(crate) fn noise(x: u32, y: u32, channel: u32, seed: u32) -> f64 {
    let hash = mix(mix(mix(3 * seed + channel).wrapping_add(x)).wrapping_add(y));
    f64::from(hash) / 2.0_f64.powi(32)
}

fn mix(mut i: u32) -> u32 {
    i ^= i >> 16;
    i = i.wrapping_mul(0x7feb352d);
    i ^= i >> 15;
    i = i.wrapping_mul(0x846ca68b);
    i ^ (i >> 16)
}

/// The values of `f(x, y, channel)`, rounded to f32.
pub(crate) fn values(size: [u32; 2], f: impl Fn(u32, u32, u32) -> f64) -> Vec<[f32; 3]> {
    let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    places.map(|(x, y)| [0, 1, 2].map(|channel| f(x, y, channel) as f32)).collect()
}

/// An image of the values of `f(x, y, channel)`.
pub(crate) fn image(size: [u32; 2], f: impl Fn(u32, u32, u32) -> f64) -> Image {
    Image::new(size[0] as usize, size[1] as usize, values(size, f)).unwrap()
}
