//! Linear images from Radiance (.hdr) and EXR files.

use std::io::Cursor;

use image::ImageDecoder;
use image::codecs::hdr::{HdrDecoder, HdrMetadata};

use super::decode::{check_size, contain, describe_start};
use super::exr_image;
use crate::{Error, Limits, Warning};

/// Linear RGB as a file has it; NaN, infinite and negative values included.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearImage {
    /// Pixels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `width * height` pixels from the top row.
    pub pixels: Vec<[f32; 3]>,
}

/// Decodes a Radiance RGBE or EXR image, told apart by their first bytes. `name` stands in messages.
///
/// A Radiance file's EXPOSURE and COLORCORR are divided out, as its format asks. Of an EXR file
/// the first part with R, G and B, or with Y, is taken at its first level, and placed into the
/// display window; alpha is ignored. An error if the bytes are no such image, damaged, or beyond
/// [`Limits::pixels`], which is checked before the pixels are decoded.
pub fn linear_image_from_bytes(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<(LinearImage, Vec<Warning>), Error> {
    if exr_image::is_exr(bytes) {
        decode_exr(name, bytes, limits)
    } else if bytes.starts_with(b"#?") {
        decode_radiance(name, bytes, limits)
    } else {
        Err(Error::new(name, "byte 0", describe_start(bytes), "a Radiance (.hdr) or EXR image"))
    }
}

/// R, G and B, or Y for all three.
fn decode_exr(name: &str, bytes: &[u8], limits: &Limits) -> Result<(LinearImage, Vec<Warning>), Error> {
    let image = exr_image::read(name, bytes, &[&["R", "G", "B"], &["Y"]], limits)?;
    let pixels = match image.channels.as_slice() {
        [red, green, blue] => {
            red.iter().zip(green).zip(blue).map(|((&red, &green), &blue)| [red, green, blue]).collect()
        }
        [grey] => grey.iter().map(|&value| [value; 3]).collect(),
        _ => Vec::new(),
    };
    Ok((LinearImage { width: image.width, height: image.height, pixels }, image.warnings))
}

/// RGBE, with its size checked between header and pixels.
fn decode_radiance(name: &str, bytes: &[u8], limits: &Limits) -> Result<(LinearImage, Vec<Warning>), Error> {
    let refused = |error: image::ImageError| {
        Error::new(name, "Radiance data", error.to_string(), "a complete RGBE image, rows from the top")
    };
    contain(name, || {
        // Lenient, because "#?RGBE" is as common a first line as "#?RADIANCE".
        let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(refused)?;
        let (width, height) = decoder.dimensions();
        check_size(name, width as u64, height as u64, limits)?;
        // Even the most compact row takes four bytes.
        if height as usize > bytes.len() / 4 {
            let found = format!("{height} rows in {} bytes", bytes.len());
            return Err(Error::new(name, "Radiance data", found, "at least 4 bytes a row"));
        }
        let metadata = decoder.metadata();
        let mut pixels = vec![[0.0_f32; 3]; width as usize * height as usize];
        decoder.read_image(bytemuck::cast_slice_mut(&mut pixels)).map_err(refused)?;
        let warnings = undo_exposure(name, &metadata, &mut pixels);
        Ok((LinearImage { width, height, pixels }, warnings))
    })
}

/// Divides by EXPOSURE and COLORCORR where the file has them and they are usable.
fn undo_exposure(name: &str, metadata: &HdrMetadata, pixels: &mut [[f32; 3]]) -> Vec<Warning> {
    let exposure = metadata.exposure.unwrap_or(1.0);
    let (red, green, blue) = metadata.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let divisors = [exposure * red, exposure * green, exposure * blue];
    if metadata.exposure.is_none() && metadata.color_correction.is_none() {
        return Vec::new();
    }
    let usable = divisors.iter().all(|divisor| divisor.is_normal() && *divisor > 0.0);
    let message = if usable {
        for pixel in pixels {
            *pixel = std::array::from_fn(|channel| pixel[channel] / divisors[channel]);
        }
        format!("the exposure of {divisors:?} was divided out")
    } else {
        format!("the exposure of {divisors:?} is not usable; it was ignored")
    };
    vec![Warning { file: name.into(), place: "EXPOSURE and COLORCORR".into(), message }]
}
