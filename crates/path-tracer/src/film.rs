//! The film: what a path tracer knows of each pixel after some of its samples, and how films of
//! different samples become one.
//!
//! Adding floats in another order gives other bits. A film therefore adds integers: a radiance is
//! rounded once, to a multiple of 2^-41, and its square to a multiple of 2^-43, and the sums of
//! these 128-bit integers are exact. Exact sums are associative and commutative, so any partition
//! of the samples over threads, runs or machines, merged in any order, gives the same bits.
//!
//! What the rounding costs: the mean is off by at most 2^-42 of a unit of radiance, far below the
//! f32 it is shown in; and a channel whose samples differ by less than about 2^-22 (2.4e-7 units
//! of radiance) is not told from a constant one.

mod exr;
mod exr_reader;
mod fingerprint;
mod identity;
mod merge;
mod sample_ranges;
mod sums;

pub(crate) use fingerprint::SceneHash;
pub use fingerprint::fingerprint;
pub use identity::Identity;
pub use merge::Merge;
pub use sample_ranges::SampleRanges;
pub use sums::{MAX_RADIANCE, PixelSums};

use scene::Error;
use std::ops::Range;

/// The most pixels a side of a film has.
pub const MAX_SIDE: u32 = 16384;

/// The most pixels of a film: 2^26, which take 7 GiB as [`PixelSums`].
pub const MAX_PIXELS: u64 = 1 << 26;

/// The most samples of a pixel in one film: 2^24, the number up to which no sum can overflow.
pub const MAX_SAMPLES_PER_PIXEL: u32 = 1 << 24;

/// The longest file of a film: 116 bytes a pixel before compression, which may add a little.
pub const MAX_FILE_BYTES: u64 = 128 * MAX_PIXELS;

/// Sums of the samples of every pixel, and which samples they are. Takes 112 bytes a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    identity: Identity,
    size: [u32; 2],
    samples: SampleRanges,
    pixels: Vec<PixelSums>,
}

impl Film {
    /// A film of width x height pixels without samples. An error where a side is 0 or beyond
    /// [`MAX_SIDE`], the pixels are more than [`MAX_PIXELS`], or there is no memory for them.
    pub fn new(size: [u32; 2], identity: Identity) -> Result<Self, Error> {
        check_size(&identity.scene, size)?;
        let count = size[0] as usize * size[1] as usize;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|error| {
            let found = format!("{} x {} pixels, for which there is no memory ({error})", size[0], size[1]);
            Error::new(&identity.scene, "film size", found, "a smaller picture")
        })?;
        pixels.resize(count, PixelSums::default());
        Ok(Self { identity, size, samples: SampleRanges::default(), pixels })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// What was rendered.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Which samples every pixel has.
    pub fn samples(&self) -> &SampleRanges {
        &self.samples
    }

    /// How many samples every pixel has, 0 to [`MAX_SAMPLES_PER_PIXEL`].
    pub fn samples_per_pixel(&self) -> u32 {
        self.samples.count() as u32
    }

    /// The sums of all pixels, rows from the top.
    pub fn pixels(&self) -> &[PixelSums] {
        &self.pixels
    }

    /// The same to add samples to, in any order and from any thread. Whoever adds a sample adds one
    /// to every pixel, and then says so by [`Film::finish_samples`].
    pub fn pixels_mut(&mut self) -> &mut [PixelSums] {
        &mut self.pixels
    }

    /// Adds the radiance of one sample of one pixel (row * width + column; one out of range is
    /// ignored). See [`PixelSums::add`].
    pub fn add(&mut self, pixel: usize, radiance: [f64; 3]) {
        if let Some(sums) = self.pixels.get_mut(pixel) {
            sums.add(radiance);
        }
    }

    /// Records that every pixel has these samples now. An error where it had some of them already,
    /// or where they become more than [`MAX_SAMPLES_PER_PIXEL`].
    pub fn finish_samples(&mut self, samples: Range<u32>) -> Result<(), Error> {
        self.samples.insert(samples).map_err(|refusal| refusal.of(&self.identity.scene))
    }

    /// The mean radiance of each pixel, rows from the top; 0 where there are no samples. Samples
    /// that were no radiance ([`Film::invalid`]) count as black.
    pub fn mean(&self) -> Vec<[f32; 3]> {
        let count = self.samples_per_pixel();
        self.pixels.iter().map(|sums| sums.mean(count)).collect()
    }

    /// The variance of each pixel's mean, per channel: the unbiased sample variance over the number
    /// of samples. Infinite below two samples, of which nothing is known.
    pub fn variance_of_mean(&self) -> Vec<[f32; 3]> {
        let count = self.samples_per_pixel();
        self.pixels.iter().map(|sums| sums.variance_of_mean(count)).collect()
    }

    /// How many samples were NaN, infinite or negative in a channel, and were taken for black.
    pub fn invalid(&self) -> u64 {
        self.pixels.iter().map(|sums| u64::from(sums.invalid())).sum()
    }

    /// How many samples were beyond [`MAX_RADIANCE`] in a channel, and were brought back to it.
    pub fn clamped(&self) -> u64 {
        self.pixels.iter().map(|sums| u64::from(sums.clamped())).sum()
    }

    /// All films in one, bit by bit the film of all their samples, whatever their order.
    ///
    /// An error where there are none, where they differ in size or in what was rendered, where two
    /// hold the same samples, or where the samples become too many. Messages call the films "film
    /// 1", "film 2", ...; [`Merge`] gives them names and needs only two in memory.
    pub fn merge(films: Vec<Self>) -> Result<Self, Error> {
        let mut named =
            films.into_iter().enumerate().map(|(index, film)| (format!("film {}", index + 1), film));
        let Some((name, film)) = named.next() else {
            return Err(Error::new("merge", "films", "none", "one or more"));
        };
        let mut merge = Merge::new(name, film);
        for (name, film) in named {
            merge.add(name, &film)?;
        }
        Ok(merge.finish())
    }

    /// An EXR file: the mean as `R`, `G`, `B` for any program that shows pictures, the variance
    /// of the mean as layer `variance`, and the sums bit by bit, so that nothing is lost in a file.
    /// The same film gives the same bytes. An error only where the encoder refuses.
    pub fn to_exr(&self) -> Result<Vec<u8>, Error> {
        exr::encode(self)
    }

    /// Whether the bytes are an EXR file that says to be a film; the rest of it may still be refused.
    pub fn is_film(bytes: &[u8]) -> bool {
        exr_reader::is_film(bytes)
    }

    /// The film of a file that [`Film::to_exr`] made; `file` is its name in messages.
    ///
    /// Any other bytes are refused with the place, what was found and what was expected: a picture
    /// that is no film, missing or mistyped channels, impossible sizes (before memory is taken), and
    /// sums that contradict the picture or the number of samples.
    pub fn from_exr(bytes: &[u8], file: &str) -> Result<Self, Error> {
        exr_reader::decode(bytes, file)
    }
}

/// Refuses sizes beyond the limits.
fn check_size(name: &str, [width, height]: [u32; 2]) -> Result<(), Error> {
    let sides = 1..=MAX_SIDE;
    let fits = sides.contains(&width) && sides.contains(&height);
    if fits && u64::from(width) * u64::from(height) <= MAX_PIXELS {
        return Ok(());
    }
    let expected = format!("1 to {MAX_SIDE} pixels a side and at most {MAX_PIXELS} in all");
    Err(Error::new(name, "film size", format!("{width} x {height} pixels"), expected))
}
