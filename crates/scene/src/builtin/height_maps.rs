//! Height maps that need no file. Each is a function on the unit torus, so that it repeats without a
//! seam, sampled at texel centres.

mod cellular;
mod noise;
mod waves;

use rayon::prelude::*;

use crate::HeightMap;

/// The names that [`height_map`] knows.
pub const HEIGHT_MAPS: [&str; 7] =
    ["cylinders", "reptile_skin", "ripples", "dunes", "fbm", "fbm_smooth", "craters"];

/// One kind of relief.
struct Relief {
    /// Texels a side unless another number is asked for.
    size: u32,
    /// See [`height_map_texels`].
    texels: f32,
    /// Height in any unit at x, y in 0..1, for maps of so many texels along the shorter side.
    height: fn(f64, f64, u32) -> f64,
}

fn relief(name: &str) -> Option<Relief> {
    let (size, texels, height): (_, _, fn(f64, f64, u32) -> f64) = match name {
        "cylinders" => (128, 5.0, cellular::cylinders),
        "reptile_skin" => (256, 5.0, cellular::reptile_skin),
        "ripples" => (256, 3.0, waves::ripples),
        "dunes" => (256, 12.0, waves::dunes),
        "fbm" => (128, 14.0, noise::rough),
        "fbm_smooth" => (128, 14.0, noise::smooth),
        "craters" => (256, 24.0, cellular::craters),
        _ => return None,
    };
    Some(Relief { size, texels, height })
}

/// A built-in height map at its own size; see [`height_map_sized`].
pub fn height_map(name: &str) -> Option<HeightMap> {
    let Relief { size, .. } = relief(name)?;
    height_map_sized(name, [size; 2])
}

/// A built-in height map of `size` texels (each number clamped to 1..=8192), or `None` if the name is
/// not in [`HEIGHT_MAPS`]. Heights span 0..=1 exactly (0 where all are one), the map repeats along
/// both axes, and the same name and size give the same heights.
///
/// - `cylinders` (128 x 128): upright round columns with flat tops on flat ground, 4 x 4 of them;
/// - `reptile_skin` (256 x 256): keeled scales in staggered rows, with grooves between them;
/// - `ripples` (256 x 256): wind ripples on sand, steep on the lee side (+v), with junctions;
/// - `dunes` (256 x 256): three rows of dunes with sharp crests and slip faces on the lee side (+v);
/// - `fbm` (128 x 128): rough fractal ground; larger maps have finer detail;
/// - `fbm_smooth` (128 x 128): the same with rounded hills;
/// - `craters` (256 x 256): a field of craters of many sizes.
///
/// How high they are meant to be is [`height_map_texels`]. A map of another size shows the same
/// picture.
pub fn height_map_sized(name: &str, size: [u32; 2]) -> Option<HeightMap> {
    let Relief { height, .. } = relief(name)?;
    let [width, rows] = size.map(|texels| texels.clamp(1, 8192));
    let shorter = width.min(rows);
    let mut heights = vec![0.0; width as usize * rows as usize];
    heights.par_chunks_exact_mut(width as usize).enumerate().for_each(|(row, heights)| {
        let y = (row as f64 + 0.5) / f64::from(rows);
        for (column, value) in heights.iter_mut().enumerate() {
            *value = height((column as f64 + 0.5) / f64::from(width), y, shorter) as f32;
        }
    });
    let (least, greatest) = heights
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
    let range = greatest - least;
    for value in &mut heights {
        *value = if range > 0.0 { (*value - least) / range } else { 0.0 };
    }
    Some(HeightMap { name: name.into(), width, height: rows, heights })
}

/// The height of a built-in height map's 1 above its 0 at which it looks as meant, in texels of the
/// map at its own size: `height_scale` is this times the length of such a texel. `None` if the name
/// is not in [`HEIGHT_MAPS`].
pub fn height_map_texels(name: &str) -> Option<f32> {
    relief(name).map(|relief| relief.texels)
}

/// 0 at and below `from`, 1 at and above `to`, smooth between.
fn smooth_step(from: f64, to: f64, x: f64) -> f64 {
    let share = ((x - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
