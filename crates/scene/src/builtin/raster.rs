//! From a radiance of directions to the texels of a latitude-longitude map.

use glam::Vec3;
use rayon::prelude::*;

use crate::Environment;

/// A map of `width` x `width / 2` texels, each the mean of `side` x `side` samples of it.
pub(super) fn mean_over_texels(
    width: u32,
    side: u32,
    radiance: impl Fn(Vec3) -> Vec3 + Sync,
) -> Vec<[f32; 3]> {
    let height = width / 2;
    let texel = |column: u32, row: u32| {
        let mut sum = Vec3::ZERO;
        for index in 0..side * side {
            let x = column as f32 + ((index % side) as f32 + 0.5) / side as f32;
            let y = row as f32 + ((index / side) as f32 + 0.5) / side as f32;
            sum += radiance(Environment::direction_of(x / width as f32, y / height as f32));
        }
        (sum / (side * side) as f32).to_array()
    };
    (0..height)
        .into_par_iter()
        .flat_map_iter(|row| (0..width).map(move |column| texel(column, row)))
        .collect()
}
