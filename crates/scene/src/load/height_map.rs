//! Height maps from PNG, JPEG and EXR.

use std::path::Path;

use image::DynamicImage;

use super::decode::{file_name, png_or_jpeg};
use super::{exr_image, read_file};
use crate::{Error, HeightMap, Limits, Warning};

/// Reads a height map; see [`height_map_from_bytes`].
pub fn height_map(path: &Path, limits: &Limits) -> Result<(HeightMap, Vec<Warning>), Error> {
    height_map_from_bytes(&file_name(path), &read_file(path, limits)?, limits)
}

/// Decodes a height map of 8- or 16-bit PNG (or JPEG), whose black to white becomes 0..1, or of
/// EXR, whose channel Y, R or Z (the first that exists) is taken as it is.
///
/// Of colour images the red channel counts. Heights that are not finite become 0, with a
/// warning. An error if the bytes are no such image, damaged, or beyond [`Limits::pixels`].
pub fn height_map_from_bytes(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<(HeightMap, Vec<Warning>), Error> {
    if exr_image::is_exr(bytes) {
        return exr_heights(name, bytes, limits);
    }
    let image = png_or_jpeg(name, bytes, limits)?;
    let (width, height) = (image.width(), image.height());
    Ok((HeightMap { name: name.into(), width, height, heights: unit_heights(&image) }, Vec::new()))
}

/// The red (or only) channel, with the largest code as 1.
fn unit_heights(image: &DynamicImage) -> Vec<f32> {
    let from_8 = |code: u8| code as f32 / 255.0;
    let from_16 = |code: u16| code as f32 / 65535.0;
    match image {
        DynamicImage::ImageLuma8(grey) => grey.iter().copied().map(from_8).collect(),
        DynamicImage::ImageLumaA8(grey) => grey.pixels().map(|pixel| from_8(pixel.0[0])).collect(),
        DynamicImage::ImageLuma16(grey) => grey.iter().copied().map(from_16).collect(),
        DynamicImage::ImageLumaA16(grey) => grey.pixels().map(|pixel| from_16(pixel.0[0])).collect(),
        color => color.to_rgb16().pixels().map(|pixel| from_16(pixel.0[0])).collect(),
    }
}

/// The first of the channels Y, R and Z.
fn exr_heights(name: &str, bytes: &[u8], limits: &Limits) -> Result<(HeightMap, Vec<Warning>), Error> {
    let image = exr_image::read(name, bytes, &[&["Y"], &["R"], &["Z"]], limits)?;
    let [mut heights] = <[Vec<f32>; 1]>::try_from(image.channels)
        .map_err(|_| Error::new(name, "channels", "none", "Y, R or Z"))?;
    let mut replaced = 0;
    for height in heights.iter_mut().filter(|height| !height.is_finite()) {
        *height = 0.0;
        replaced += 1;
    }
    let mut warnings = image.warnings;
    if replaced > 0 {
        let message = format!("{replaced} heights are NaN or infinite; they were replaced by 0");
        warnings.push(Warning { file: name.into(), place: "pixels".into(), message });
    }
    Ok((HeightMap { name: name.into(), width: image.width, height: image.height, heights }, warnings))
}
