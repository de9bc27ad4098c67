//! Pictures to files: encoded in memory, so that they can be written whole or not at all.

use crate::commands::Failure;
use compositor::{Settings, headless::HdrImage, tone_map};
use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use scene::output::check_place;
use std::io::Cursor;
use std::path::Path;

/// The kinds of picture that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Linear scene-referred f32, lossless.
    Exr,
    /// Tone mapped sRGB, 8 bits a channel.
    Png,
}

impl Format {
    /// All formats.
    pub(crate) const ALL: [Self; 2] = [Self::Exr, Self::Png];

    fn extension(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Png => "png",
        }
    }

    /// The one of `formats` that a path's extension asks for. Also looks whether the place can be
    /// written, so that nobody waits for a picture that cannot be kept.
    pub(crate) fn of_path(path: &Path, formats: &[Self]) -> Result<Self, Failure> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let wanted = |format: &&Self| extension.as_deref() == Some(format.extension());
        let Some(&format) = formats.iter().find(wanted) else {
            let found =
                extension.map_or_else(|| "no extension".to_owned(), |extension| format!(".{extension}"));
            let expected: Vec<_> = formats.iter().map(|format| format!(".{}", format.extension())).collect();
            let place = path.display();
            return Err(Failure::Usage(format!(
                "{place}: found {found}, expected {}",
                expected.join(" or ")
            )));
        };
        check_place(path)?;
        Ok(format)
    }

    /// The bytes of the file.
    pub(crate) fn encode(self, picture: &HdrImage, settings: &Settings) -> Result<Vec<u8>, String> {
        match self {
            Self::Exr => encode_exr(picture),
            Self::Png => encode_png(picture, settings),
        }
    }
}

fn encode_exr(picture: &HdrImage) -> Result<Vec<u8>, String> {
    let width = picture.width as usize;
    let pixel = |position: exr::math::Vec2<usize>| {
        let start = 4 * (position.y() * width + position.x());
        match picture.rgba.get(start..start + 3) {
            Some(&[red, green, blue]) => (red, green, blue),
            _ => (0.0, 0.0, 0.0),
        }
    };
    let size = (width, picture.height as usize);
    let image = Image::from_encoded_channels(size, Encoding::SMALL_LOSSLESS, SpecificChannels::rgb(pixel));
    let mut file = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut file).map_err(|error| error.to_string())?;
    Ok(file.into_inner())
}

fn encode_png(picture: &HdrImage, settings: &Settings) -> Result<Vec<u8>, String> {
    let (pixels, _) = picture.rgba.as_chunks::<4>();
    let bytes: Vec<u8> = pixels
        .iter()
        .flat_map(|&[red, green, blue, _]| {
            tone_map::display_srgb8([red, green, blue], settings.exposure_ev, settings.tone_curve)
        })
        .collect();
    png(&bytes, [picture.width, picture.height])
}

/// A PNG of 8-bit RGB pixels, rows from the top.
pub(crate) fn png(rgb: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, String> {
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())?;
    Ok(file)
}
