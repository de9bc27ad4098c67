//! What a correct caller of this crate can meet.

/// Why there is no number.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// An image without pixels.
    #[error("the image is empty: {width} x {height} pixels; expected at least 1 x 1")]
    Empty {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// An image's size and its number of pixels disagree.
    #[error("an image of {width} x {height} pixels was given {found} values")]
    Length {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        found: usize,
    },
    /// The two images differ in size.
    #[error(
        "the image has {found_width} x {found_height} pixels, \
         its reference {expected_width} x {expected_height}; make them alike"
    )]
    Size {
        /// Pixels in a row of the image.
        found_width: usize,
        /// Rows of the image.
        found_height: usize,
        /// Pixels in a row of the reference.
        expected_width: usize,
        /// Rows of the reference.
        expected_height: usize,
    },
    /// Every pixel is NaN or infinite in at least one of the images.
    #[error("none of the {pixels} pixels is finite in both images: there is nothing to compare")]
    NothingFinite {
        /// Pixels in each image.
        pixels: usize,
    },
    /// A variance is no variance.
    #[error("the variance of pixel {pixel} is {found}; expected 0 or more")]
    Variance {
        /// Index of the pixel, row by row.
        pixel: usize,
        /// The offending value, negative or NaN.
        found: f32,
    },
    /// A setting is outside its range.
    #[error("{name} is {found}; expected {expected}")]
    OutOfRange {
        /// Which setting.
        name: &'static str,
        /// What was given.
        found: f64,
        /// What is allowed, in words.
        expected: &'static str,
    },
    /// Exposures cannot be derived from a reference without light.
    #[error("the reference is black, so that it gives no exposures; give them explicitly")]
    BlackReference,
}
