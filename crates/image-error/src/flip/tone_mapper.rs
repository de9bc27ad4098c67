//! What makes displayable colours of radiance, and the exposures at which it is to be judged.

use super::color::{self, Rgb};
use crate::{Error, Image, image::is_finite};

/// Radiance beyond this (after exposure) is white in every tone mapper; its square is still finite.
const LARGEST: f32 = 1e18;

/// Exposures further from 0 than this many stops leave the range of f32.
const MOST_STOPS: f64 = 120.0;

/// The displayed luminance that separates the exposures worth looking at (2021, exposure range).
const BRIGHT: f64 = 0.85;

/// How radiance becomes displayable (2021, tone mapping).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneMapper {
    /// Narkowicz's fit of the ACES film curve, on each channel, with the 0.6 that gives it the
    /// exposure of the original.
    #[default]
    Aces,
    /// `L / (1 + L)` on the luminance.
    Reinhard,
    /// Hable's film curve, on each channel, with white at 11.2.
    Hable,
}

/// The exposures of HDR-FLIP: `count` of them, spaced evenly from `start` to `stop`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The darkest exposure, in stops (radiance is multiplied by 2 to this power), within -120..=120.
    pub start: f32,
    /// The brightest exposure, in stops; not below `start`, at most 120.
    pub stop: f32,
    /// How many, 1..=1000. One alone is `start`.
    pub count: u32,
}

impl Exposures {
    /// The published choice (2021, exposure range): from the exposure that shows the brightest pixel
    /// of the reference at 0.85 of the display's range to the one that shows the median there, one
    /// exposure per stop and at least two. The median of an even number of pixels is the larger of the
    /// two in the middle; it counts as 2^-23 at least, and luminances count as 1e18 at most. Pixels that are not finite are left out, negative channels count as 0. Fails where the reference is black.
    pub fn automatic(reference: &Image, tone_mapper: ToneMapper) -> Result<Self, Error> {
        let finite = reference.pixels().iter().filter(|pixel| is_finite(pixel));
        let mut luminances: Vec<f32> =
            finite.map(|pixel| color::luminance(pixel.map(|value| value.clamp(0.0, LARGEST)))).collect();
        luminances.sort_unstable_by(f32::total_cmp);
        let largest = luminances.last().copied().unwrap_or(0.0);
        if largest <= 0.0 {
            return Err(Error::BlackReference);
        }
        let median = luminances.get(luminances.len() / 2).copied().unwrap_or(0.0).max(f32::EPSILON);
        let [largest, median] = [largest, median].map(f64::from);
        let stops = |luminance: f64| {
            (tone_mapper.bright_radiance() / luminance).log2().clamp(-MOST_STOPS, MOST_STOPS)
        };
        // A reference that is dimmer than the stand-in for its median has no range of its own.
        let (start, stop) = (stops(largest), stops(median.min(largest)));
        // From the ratio, because that of a power of two must not be rounded up by a whole stop.
        let count = (largest / median).log2().ceil().max(2.0);
        Ok(Self { start: start as f32, stop: stop as f32, count: count as u32 })
    }

    /// Refuses what is outside the documented ranges.
    pub(super) fn check(&self) -> Result<(), Error> {
        let within = |name, value: f32| {
            let error = Error::OutOfRange { name, found: f64::from(value), expected: "-120 to 120 stops" };
            if f64::from(value.abs()) <= MOST_STOPS { Ok(()) } else { Err(error) }
        };
        within("start exposure", self.start)?;
        within("stop exposure", self.stop)?;
        if self.stop < self.start {
            let expected = "no less than the start exposure";
            return Err(Error::OutOfRange { name: "stop exposure", found: f64::from(self.stop), expected });
        }
        if !(1..=1000).contains(&self.count) {
            return Err(Error::OutOfRange {
                name: "exposure count",
                found: f64::from(self.count),
                expected: "1 to 1000",
            });
        }
        Ok(())
    }

    /// The exposure of an index below `count`, in stops.
    pub fn stops(&self, index: u32) -> f32 {
        let last = self.count.saturating_sub(1).max(1) as f32;
        self.start + (self.stop - self.start) * index as f32 / last
    }
}

impl ToneMapper {
    /// The displayed colour of radiance that is 0 or more, in 0..=1.
    pub(super) fn apply(self, radiance: Rgb) -> Rgb {
        let displayed = match self {
            Self::Aces | Self::Hable => {
                let curve = self.curve();
                radiance.map(|value| rational(&curve, value.min(LARGEST)))
            }
            Self::Reinhard => {
                let radiance = radiance.map(|value| value.min(LARGEST));
                let scale = 1.0 / (1.0 + color::luminance(radiance));
                radiance.map(|value| value * scale)
            }
        };
        displayed.map(|value| value.clamp(0.0, 1.0))
    }

    /// The curve's coefficients k: it maps x to (k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5).
    const fn curve(self) -> [f32; 6] {
        match self {
            Self::Aces => [0.36 * 2.51, 0.6 * 0.03, 0.0, 0.36 * 2.43, 0.6 * 0.59, 0.14],
            Self::Reinhard => [0.0, 1.0, 0.0, 0.0, 1.0, 1.0],
            Self::Hable => [0.231_683, 0.013_791, 0.0, 0.18, 0.3, 0.018],
        }
    }

    /// The radiance that is displayed as [`BRIGHT`]: the positive root of the curve minus it.
    fn bright_radiance(self) -> f64 {
        let [k0, k1, k2, k3, k4, k5] = self.curve().map(f64::from);
        let (a, b, c) = (k0 - BRIGHT * k3, k1 - BRIGHT * k4, k2 - BRIGHT * k5);
        if a == 0.0 { -c / b } else { (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a) }
    }
}

fn rational(&[k0, k1, k2, k3, k4, k5]: &[f32; 6], x: f32) -> f32 {
    ((k0 * x + k1) * x + k2) / ((k3 * x + k4) * x + k5)
}
