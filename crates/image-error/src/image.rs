//! An image as the measures take it.

use crate::Error;

/// Linear RGB with Rec. 709 primaries, row by row from the top. It has at least one pixel. Values
/// may be anything, NaN included: each measure says what it makes of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Image {
    /// An image of `width * height` linear pixels. Refuses one without pixels, and a number of
    /// pixels that is not that product.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self, Error> {
        if width == 0 || height == 0 {
            return Err(Error::Empty { width, height });
        }
        if width.checked_mul(height) != Some(pixels.len()) {
            return Err(Error::Length { width, height, found: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }

    /// An image of one row, for the measures that look at pixels one by one: a selection of pixels.
    /// Refuses an empty one.
    pub fn row(pixels: Vec<[f32; 3]>) -> Result<Self, Error> {
        Self::new(pixels.len(), 1, pixels)
    }

    /// An image of one quantity in whatever unit, as a shade of grey: visibilities, angles. Means
    /// over its channels are means over the quantity. Errors as in [`Self::new`].
    pub fn from_grey(width: usize, height: usize, values: &[f32]) -> Result<Self, Error> {
        Self::new(width, height, values.iter().map(|&value| [value; 3]).collect())
    }

    /// An image from sRGB-encoded values in 0..=1 (bytes divided by 255), decoded to linear ones
    /// with the curve of IEC 61966-2-1. Errors as in [`Self::new`].
    pub fn from_srgb(width: usize, height: usize, encoded: &[[f32; 3]]) -> Result<Self, Error> {
        Self::new(width, height, encoded.iter().map(|pixel| pixel.map(linear_from_srgb)).collect())
    }

    /// Pixels in a row, at least 1.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows, at least 1.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// Nothing where both images have the same size.
    pub(crate) fn check_same_size(&self, reference: &Self) -> Result<(), Error> {
        if (self.width, self.height) == (reference.width, reference.height) {
            return Ok(());
        }
        Err(Error::Size {
            found_width: self.width,
            found_height: self.height,
            expected_width: reference.width,
            expected_height: reference.height,
        })
    }
}

/// Whether all channels are finite.
pub(crate) fn is_finite(pixel: &[f32; 3]) -> bool {
    pixel.iter().all(|value| value.is_finite())
}

fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
