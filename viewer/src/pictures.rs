//! Pictures from files, to be compared or merged.

use crate::commands::{Failure, print_warnings};
use image_error::Image;
use path_tracer::{Film, film::MAX_FILE_BYTES};
use scene::{ColorSpace, Error, Limits, load};
use std::path::Path;

/// A picture of any file.
pub(crate) struct Picture {
    /// Its path, for messages.
    pub(crate) name: String,
    /// Linear RGB.
    pub(crate) image: Image,
    /// Whether it is made for displays: 8-bit sRGB.
    pub(crate) is_displayed: bool,
    /// Variance of each pixel, where the file tells it.
    pub(crate) variance: Option<Vec<[f32; 3]>>,
}

impl Picture {
    /// Reads a film, an EXR or Radiance picture, or a PNG or JPEG, told apart by their first bytes.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let bytes = read(path)?;
        if Film::is_film(&bytes) {
            let film = Film::from_exr(&bytes, &name)?;
            let (image, variance) = (mean(&film)?, Some(film.variance_of_mean()));
            return Ok(Self { name, image, is_displayed: false, variance });
        }
        if bytes.starts_with(b"\x89PNG") || bytes.starts_with(&[0xff, 0xd8]) {
            return Self::displayed(name, &bytes);
        }
        let (linear, warnings) = load::linear_image_from_bytes(&name, &bytes, &Limits::default())?;
        print_warnings(&warnings);
        let image = Image::new(linear.width as usize, linear.height as usize, linear.pixels)?;
        Ok(Self { name, image, is_displayed: false, variance: None })
    }

    fn displayed(name: String, bytes: &[u8]) -> Result<Self, Failure> {
        let texture = load::texture::texture_from_bytes(&name, bytes, ColorSpace::Srgb, &Limits::default())?;
        let (pixels, _) = texture.rgba.as_chunks::<4>();
        let encoded: Vec<_> = pixels
            .iter()
            .map(|&[red, green, blue, _]| [red, green, blue].map(|byte| f32::from(byte) / 255.0))
            .collect();
        let image = Image::from_srgb(texture.width as usize, texture.height as usize, &encoded)?;
        Ok(Self { name, image, is_displayed: true, variance: None })
    }
}

/// The film of a file.
pub(crate) fn film(path: &Path) -> Result<Film, Error> {
    Film::from_exr(&read(path)?, &path.display().to_string())
}

/// The film of an EXR file, unless the file does not say to be one.
pub(crate) fn film_if_it_is_one(path: &Path) -> Result<Option<Film>, Error> {
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("exr")) {
        return Ok(None);
    }
    let bytes = read(path)?;
    let film = || Film::from_exr(&bytes, &path.display().to_string());
    Film::is_film(&bytes).then(film).transpose()
}

/// The mean of a film.
pub(crate) fn mean(film: &Film) -> Result<Image, image_error::Error> {
    let [width, height] = film.size().map(|side| side as usize);
    Image::new(width, height, film.mean())
}

/// The bytes of a file that is no longer than the longest film.
fn read(path: &Path) -> Result<Vec<u8>, Error> {
    load::read_file(path, &Limits { file_bytes: MAX_FILE_BYTES, ..Limits::default() })
}
