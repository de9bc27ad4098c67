//! Scenes, environments and height maps that need no file.

mod height_maps;
mod raster;
mod showroom;
mod sky;
mod studio;

pub use height_maps::{HEIGHT_MAPS, height_map, height_map_sized, height_map_texels};

use crate::{Environment, Scene};

/// The names that [`environment`] knows.
pub const ENVIRONMENT_NAMES: [&str; 2] = ["sky", "studio"];

/// Texels per row of a built-in environment unless another number is asked for.
pub const ENVIRONMENT_WIDTH: u32 = 1024;

/// A built-in environment of 1024 x 512 texels; see [`environment_sized`].
pub fn environment(name: &str) -> Option<Environment> {
    environment_sized(name, ENVIRONMENT_WIDTH)
}

/// A built-in environment of `width` (clamped to 16..=8192, odd widths rounded up) by half as
/// many texels, or `None` if the name is not in [`ENVIRONMENT_NAMES`].
///
/// - `sky`: a clear sky over plain ground, with a sun of 0.53 degrees, 38 degrees high, that
///   brings about four fifths of the light; mean radiance about 1, the sun's near 1e5.
/// - `studio`: a dark room with soft boxes and strip lights over a grey floor; mean radiance
///   about 1.3, the lights' 9 to 120.
///
/// Texels hold the mean over their area, so that the light of small sources does not depend on
/// the resolution.
pub fn environment_sized(name: &str, width: u32) -> Option<Environment> {
    let width = width.clamp(16, 8192).next_multiple_of(2);
    let pixels = match name {
        "sky" => sky::pixels(width),
        "studio" => studio::pixels(width),
        _ => return None,
    };
    Environment::new(name, width, width / 2, pixels).ok()
}

/// The scene that is shown where no file is named: rows of spheres from mirror to matt, metal
/// and dielectric, and a pot, on a glossy floor in the studio, with a camera.
pub fn scene() -> Scene {
    showroom::scene()
}
