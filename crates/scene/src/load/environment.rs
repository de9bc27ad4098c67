//! Environments from Radiance (.hdr) and EXR files.

use std::path::Path;

use super::decode::file_name;
use super::{linear_image_from_bytes, read_file};
use crate::{Environment, Error, Limits, Warning};

/// Reads an environment map; see [`environment_from_bytes`].
pub fn environment(path: &Path, limits: &Limits) -> Result<(Environment, Vec<Warning>), Error> {
    environment_from_bytes(&file_name(path), &read_file(path, limits)?, limits)
}

/// Decodes a latitude-longitude environment as [`linear_image_from_bytes`] does. Values that are no
/// radiance are replaced and counted in [`Environment::repairs`], with a warning. Errors as there.
pub fn environment_from_bytes(
    name: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<(Environment, Vec<Warning>), Error> {
    let (image, mut warnings) = linear_image_from_bytes(name, bytes, limits)?;
    let environment = Environment::new(name, image.width, image.height, image.pixels)?;
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
