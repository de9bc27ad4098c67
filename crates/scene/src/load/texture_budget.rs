//! Counts the textures of one scene against `Limits::texture_bytes`.

use std::io::Cursor;
use std::sync::atomic::{AtomicU64, Ordering};

use super::texture::texture_from_bytes;
use crate::{ColorSpace, Error, Limits, Texture};

/// What the textures of one scene may still take. Threads may share it.
pub(super) struct TextureBudget<'a> {
    limits: &'a Limits,
    total_bytes: AtomicU64,
}

impl<'a> TextureBudget<'a> {
    pub(super) fn new(limits: &'a Limits) -> Self {
        Self { limits, total_bytes: AtomicU64::new(0) }
    }

    /// Decodes a PNG or JPEG if the size in its header is still within the limit.
    pub(super) fn decode(&self, name: &str, bytes: &[u8], color_space: ColorSpace) -> Result<Texture, Error> {
        let unreadable =
            |error: &dyn ToString| Error::new(name, "image header", error.to_string(), "a PNG or JPEG image");
        let reader = image::ImageReader::new(Cursor::new(bytes));
        let reader = reader.with_guessed_format().map_err(|error| unreadable(&error))?;
        let (width, height) = reader.into_dimensions().map_err(|error| unreadable(&error))?;
        let bytes_decoded = 4 * u64::from(width) * u64::from(height);
        let total =
            self.total_bytes.fetch_add(bytes_decoded, Ordering::Relaxed).saturating_add(bytes_decoded);
        if total > self.limits.texture_bytes {
            let expected = format!("at most {} bytes (Limits::texture_bytes)", self.limits.texture_bytes);
            return Err(Error::new(
                name,
                "image size",
                format!("{total} bytes of textures so far"),
                expected,
            ));
        }
        texture_from_bytes(name, bytes, color_space, self.limits)
    }
}
