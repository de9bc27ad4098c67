//! How far an image is from its reference.
//!
//! Pure functions on [`Image`]s of linear RGB, without files, graphics or settings files. The first
//! argument is always the image that was found, the second the reference; both have the same size.
//!
//! - [`compare`] gives the numbers of a report in one go: relative mean squared error, mean
//!   absolute error, bias, energy ratio, percentiles. [`relative_mse`], [`mean_absolute`],
//!   [`bias`], [`energy_ratio`] and [`percentile`] give them one by one.
//! - [`misclassified`] is for images that answer a yes-or-no question per pixel, such as shadows.
//! - [`noise_relative_mse`] says how much of a relative mean squared error is the noise of a
//!   reference that was itself sampled.
//! - [`flip`] predicts what a person sees who flips between the two images.
//!
//! ```
//! use image_error::{Image, compare, flip};
//!
//! let reference = Image::new(2, 1, vec![[0.5; 3], [2.0; 3]])?;
//! let found = Image::new(2, 1, vec![[0.5; 3], [2.2; 3]])?;
//! let errors = compare(&found, &reference)?;
//! assert!(errors.relative_mse < 0.01 && errors.mean_signed > 0.0 && errors.non_finite == 0);
//! let flip = flip::hdr(&found, &reference, flip::PIXELS_PER_DEGREE)?;
//! println!("{:.3}, worst {:.3}", flip.map.mean(), flip.map.statistics().max);
//! # Ok::<(), image_error::Error>(())
//! ```
//!
//! # Pixels that are not finite
//! A pixel with a channel that is NaN or infinite in either image is never averaged in, and never
//! silently forgotten: every result says how many there were, or is documented to leave them out
//! beside one that says it. Where no pixel is left, there is an [`Error`] and no number.
//!
//! # Selections
//! All measures but FLIP look at pixels one by one. A selection of pixels is therefore an image of
//! one row: see [`Image::row`].

mod difference;
mod error;
pub mod flip;
mod image;

pub use difference::{
    Errors, bias, compare, energy_ratio, mean_absolute, misclassified, noise_relative_mse, percentile,
    relative_mse,
};
pub use error::Error;
pub use image::Image;
