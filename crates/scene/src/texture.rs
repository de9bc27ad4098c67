//! Decoded 8-bit images for materials.

/// An RGBA image of 8 bits a channel, rows from the top.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The file or image name, for messages.
    pub name: String,
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `4 * width * height` bytes.
    pub rgba: Vec<u8>,
    /// How the bytes encode values. An image used both ways appears twice in a scene.
    pub color_space: ColorSpace,
}

/// How 8-bit texels encode values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// Colour with the sRGB transfer curve (opacity stays linear).
    Srgb,
    /// Plain numbers, 0..1.
    Linear,
}
