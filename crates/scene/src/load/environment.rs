//! Environments from Radiance (.hdr) and EXR files.

use std::io::Cursor;
use std::path::Path;

use image::ImageDecoder;
use image::codecs::hdr::{HdrDecoder, HdrMetadata};

use super::decode::{check_size, contain, describe_start, file_name};
use super::{exr_image, read_file};
use crate::{Environment, Error, Limits, Warning};

/// Reads an environment map; see [`environment_from_bytes`].
pub fn environment(path: &Path, limits: &Limits) -> Result<(Environment, Vec<Warning>), Error> {
    environment_from_bytes(&file_name(path), &read_file(path, limits)?, limits)
}

/// Decodes a latitude-longitude environment of Radiance RGBE or EXR, told apart by their first
/// bytes.
///
/// A Radiance file's EXPOSURE and COLORCORR are divided out, as its format asks. Of an EXR file
/// the first part with R, G and B, or with Y, is taken at its first level, and placed into the
/// display window; alpha is ignored. Values that are no radiance are replaced and counted in
/// [`Environment::repairs`], with a warning. An error if the bytes are no such image, damaged, or
/// beyond [`Limits::pixels`], which is checked before the pixels are decoded.
pub fn environment_from_bytes(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<(Environment, Vec<Warning>), Error> {
    let (environment, mut warnings) = if exr_image::is_exr(bytes) {
        decode_exr(name, bytes, limits)?
    } else if bytes.starts_with(b"#?") {
        decode_radiance(name, bytes, limits)?
    } else {
        return Err(Error::new(name, "byte 0", describe_start(bytes), "a Radiance (.hdr) or EXR image"));
    };
    warnings.extend(notices(&environment));
    Ok((environment, warnings))
}

/// Warns of replaced values and of a shape that is not latitude-longitude.
fn notices(environment: &Environment) -> Vec<Warning> {
    let warning = |place: &str, message: String| Warning {
        file: environment.name.clone(),
        place: place.into(),
        message,
    };
    let mut warnings = Vec::new();
    let repairs = environment.repairs;
    if repairs.total() > 0 {
        let message = format!(
            "replaced {} NaN, {} infinite and {} negative channel values",
            repairs.nan, repairs.infinite, repairs.negative
        );
        warnings.push(warning("pixels", message));
    }
    let (width, height) = (environment.width, environment.height);
    if width as u64 != 2 * height as u64 {
        let message =
            format!("{width} x {height} is not twice as wide as high; it is stretched over the sphere");
        warnings.push(warning("image size", message));
    }
    warnings
}

/// R, G and B, or Y for all three.
fn decode_exr(name: &str, bytes: &[u8], limits: &Limits) -> Result<(Environment, Vec<Warning>), Error> {
    let image = exr_image::read(name, bytes, &[&["R", "G", "B"], &["Y"]], limits)?;
    let pixels = match image.channels.as_slice() {
        [red, green, blue] => {
            red.iter().zip(green).zip(blue).map(|((&red, &green), &blue)| [red, green, blue]).collect()
        }
        [grey] => grey.iter().map(|&value| [value; 3]).collect(),
        _ => Vec::new(),
    };
    Ok((Environment::new(name, image.width, image.height, pixels)?, image.warnings))
}

/// RGBE, with its size checked between header and pixels.
fn decode_radiance(name: &str, bytes: &[u8], limits: &Limits) -> Result<(Environment, Vec<Warning>), Error> {
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
        Ok((Environment::new(name, width, height, pixels)?, warnings))
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
