//! Decodes the images that materials use.

use std::io::Cursor;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::{Document, buffers, uri};
use crate::load::texture::texture_from_bytes;
use crate::{ColorSpace, Error, Texture};

/// One texture for each (image, colour space), decoded in parallel. The size in each image's
/// header is counted against `Limits::texture_bytes` before the image is decoded.
pub(super) fn decode(document: &Document, uses: &[(usize, ColorSpace)]) -> Result<Vec<Texture>, Error> {
    let total = AtomicU64::new(0);
    uses.par_iter().map(|&(image, color_space)| decode_one(document, image, color_space, &total)).collect()
}

fn decode_one(
    document: &Document,
    index: usize,
    color_space: ColorSpace,
    total: &AtomicU64,
) -> Result<Texture, Error> {
    let place = format!("images[{index}]");
    let image = document.get(&document.root.images, ::gltf::json::Index::new(index as u32), &place)?;
    let read;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            read = uri::read(document, uri, &format!("{place}.uri"))?;
            &read[..]
        }
        (None, Some(view)) => buffers::view(document, view, &format!("{place}.bufferView"))?.0,
        (None, None) => return Err(document.error(place, "neither uri nor bufferView", "one of them")),
    };
    let uri = image.uri.as_ref().filter(|uri| !uri.starts_with("data:"));
    let name = image.name.as_ref().or(uri).map_or_else(|| format!("image {index}"), Clone::clone);
    let bytes_decoded = decoded_bytes(bytes)
        .map_err(|error| document.error(&place, error, "a PNG or JPEG image"))?;
    let sum = total.fetch_add(bytes_decoded, Ordering::Relaxed).saturating_add(bytes_decoded);
    if sum > document.limits.texture_bytes {
        let expected = format!("at most {} bytes (Limits::texture_bytes)", document.limits.texture_bytes);
        return Err(document.error(place, format!("{sum} bytes of textures so far"), expected));
    }
    texture_from_bytes(&name, bytes, color_space, document.limits).map_err(|error| {
        document.error(format!("{place} ({name:?}), {}", error.place), error.found, error.expected)
    })
}

/// Bytes of the decoded RGBA image, from the header alone.
fn decoded_bytes(bytes: &[u8]) -> Result<u64, String> {
    let reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string())?;
    let (width, height) = reader.into_dimensions().map_err(|error| error.to_string())?;
    Ok(4 * u64::from(width) * u64::from(height))
}
