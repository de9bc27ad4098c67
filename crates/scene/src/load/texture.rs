//! Material textures from PNG and JPEG.

use super::decode::png_or_jpeg;
use crate::{ColorSpace, Error, Limits, Texture};

/// Decodes a PNG or JPEG to RGBA of 8 bits a channel.
///
/// `name` stands in the texture and in errors. Grey images are spread over RGB, a missing alpha
/// is 1, 16-bit channels are rounded to 8; colour profiles and EXIF orientation are ignored, as
/// glTF asks. An error if the bytes are neither format, damaged, or larger than
/// [`Limits::pixels`], which is checked before the pixels are decoded.
pub fn texture_from_bytes(
    name: &str,
    bytes: &[u8],
    color_space: ColorSpace,
    limits: &Limits,
) -> Result<Texture, Error> {
    let image = png_or_jpeg(name, bytes, limits)?.into_rgba8();
    let (width, height) = image.dimensions();
    Ok(Texture { name: name.into(), width, height, rgba: image.into_raw(), color_space })
}
