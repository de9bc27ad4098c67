//! What every image loader shares: size checks before memory is taken, the two containers that
//! the `image` crate decodes for us, and the wall around panics of decoders.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use crate::{Error, Limits};

/// Refuses sizes of zero and sizes beyond `Limits::pixels`.
pub(super) fn check_size(name: &str, width: u64, height: u64, limits: &Limits) -> Result<(), Error> {
    let pixels = width.saturating_mul(height);
    if pixels == 0 || pixels > limits.pixels || width > u32::MAX as u64 || height > u32::MAX as u64 {
        let expected = format!("1 to {} pixels", limits.pixels);
        return Err(Error::new(name, "image size", format!("{width} x {height}"), expected));
    }
    Ok(())
}

/// Runs a decoder of another crate and turns a panic in it into an error.
///
/// The workspace builds with overflow checks, and decoders of hostile files have arithmetic that
/// relies on wrapping (an example: `image`'s Radiance decoder multiplies the run length by 256 for
/// each run marker in a row). A file must not be able to end the program, and the decoder works
/// on its own state only, so nothing half-made can be seen afterwards.
pub(super) fn contain<T>(name: &str, decode: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(decode)).unwrap_or_else(|_| {
        Err(Error::new(name, "pixel data", "data that the decoder cannot follow", "a valid image"))
    })
}

/// Decodes a PNG or JPEG, told apart by their first bytes.
pub(super) fn png_or_jpeg(name: &str, bytes: &[u8], limits: &Limits) -> Result<DynamicImage, Error> {
    let refused = |error: image::ImageError| {
        Error::new(name, "image data", error.to_string(), "a complete PNG or JPEG image")
    };
    let Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = image::guess_format(bytes) else {
        return Err(Error::new(name, "byte 0", describe_start(bytes), "a PNG or JPEG image"));
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut decoder_limits = image::Limits::default();
    // 16 bytes a pixel: the widest pixel is RGBA of 16 bits, and a decoder may hold it twice.
    decoder_limits.max_alloc = Some(limits.pixels.saturating_mul(16));
    reader.limits(decoder_limits);
    contain(name, || {
        let decoder = reader.into_decoder().map_err(refused)?;
        let (width, height) = decoder.dimensions();
        check_size(name, width as u64, height as u64, limits)?;
        DynamicImage::from_decoder(decoder).map_err(refused)
    })
}

/// The first bytes of a file for an error message.
pub(super) fn describe_start(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "an empty file".into();
    }
    let start: Vec<String> = bytes.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    format!("bytes {}", start.join(" "))
}

/// A file's name as errors and loaded data carry it.
pub(super) fn file_name(path: &std::path::Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
