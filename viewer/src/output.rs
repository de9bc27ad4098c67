//! Pictures to files: encoded in memory, then written whole or not at all.

use crate::commands::Failure;
use compositor::{Settings, headless::HdrImage, tone_map};
use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::fs::{self, File};
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

/// The kinds of picture that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Linear scene-referred f32, lossless.
    Exr,
    /// Tone mapped sRGB, 8 bits a channel.
    Png,
}

impl Format {
    /// The format that a path's extension asks for, and whether its folder is there, so that
    /// nobody waits for a picture that cannot be kept.
    pub(crate) fn of_path(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let format = match extension.as_deref() {
            Some("exr") => Self::Exr,
            Some("png") => Self::Png,
            _ => {
                let found =
                    extension.map_or_else(|| "no extension".to_owned(), |extension| format!(".{extension}"));
                return Err(Failure::Usage(format!(
                    "{}: found {found}, expected .exr or .png",
                    path.display()
                )));
            }
        };
        if !folder_of(path).is_dir() {
            return Err(refused(path, "no such folder", "a folder that exists"));
        }
        if path.is_dir() {
            return Err(refused(path, "a folder", "a file"));
        }
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
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&bytes, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())?;
    Ok(file)
}

/// Writes a file beside its final place and moves it there, so that nobody ever sees half of it.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let partial = folder_of(path).join(format!(".{name}.{}.partial", std::process::id()));
    let written = File::create_new(&partial)
        .and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        })
        .and_then(|()| fs::rename(&partial, path));
    written.map_err(|error| {
        // Nothing to remove where it could not even be created.
        fs::remove_file(&partial).ok();
        refused(path, &error.to_string(), "a place that can be written")
    })
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn refused(path: &Path, found: &str, expected: &str) -> Failure {
    scene::Error::new(path.display().to_string(), "output", found, expected).into()
}
