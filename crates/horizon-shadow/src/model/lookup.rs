//! What the methods make of tables.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{NO_HORIZON, Ray, exact_slope, floor, paper, sine_of};

/// The two stored azimuths around a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slices {
    /// The one before it and the one after it.
    pub azimuths: [u32; 2],
    /// Weight of the second.
    pub weight: f64,
}

impl Slices {
    /// Azimuth i of `count` points along (cos, sin)(2 pi i / count).
    pub fn new(direction: [f64; 2], count: u32) -> Self {
        let turns = direction[1].atan2(direction[0]) / TAU;
        let position = (turns - turns.floor()) * f64::from(count);
        let first = position.floor() as u32 % count;
        Self { azimuths: [first, (first + 1) % count], weight: position - position.floor() }
    }
}

/// A horizon candidate of a texel and azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Rise over distance, in the texels of the bake.
    pub slope: f64,
    /// Texels.
    pub distance: f64,
}

/// Decoded candidates.
pub struct CandidateTables<'a> {
    /// How many azimuths there are.
    pub azimuths: u32,
    /// The curvatures that the candidates won, ascending, 1 / texel of the bake.
    pub nodes: &'a [f64],
    /// Texels between the map's 0 and 1 against those of the bake.
    pub steepening: f64,
    /// The candidates of a texel and azimuth, one for each node.
    pub candidates: &'a (dyn Fn([u32; 2], u32) -> Vec<Candidate> + Sync),
}

impl CandidateTables<'_> {
    /// The upper envelope at a corner: the largest exact horizon of all candidates, and the smooth
    /// base's. A lower bound, because every candidate is a point of the relief.
    pub fn envelope(&self, kappa: f64, height: f64, candidates: &[Candidate]) -> f64 {
        let tangent = |c: &Candidate| exact_slope(kappa, c.distance, c.slope * self.steepening, height);
        candidates.iter().map(tangent).fold(floor(kappa, height), f64::max)
    }

    /// The chord between the horizons at the nodes on both sides of the curvature. The envelope is
    /// convex, so this is (to first order) an upper bound; beyond the nodes the last one's.
    pub fn chord(&self, kappa: f64, height: f64, candidates: &[Candidate]) -> f64 {
        let at = |i: usize| {
            let (node, candidate) = (self.nodes.get(i)?, candidates.get(i)?);
            let slope = candidate.slope * self.steepening;
            Some((
                node * self.steepening,
                exact_slope(node * self.steepening, candidate.distance, slope, height),
            ))
        };
        let points: Vec<(f64, f64)> = (0..self.nodes.len()).map_while(at).collect();
        let Some(&(first, mut value)) = points.first() else { return NO_HORIZON };
        let mut before = first;
        for &(node, tangent) in &points[1..] {
            if kappa > before && node > before {
                let place = ((kappa - before) / (node - before)).min(1.0);
                value += place * (tangent - value);
            }
            before = node;
        }
        value
    }

    /// Blended sine of a function of the candidates over the four corners around the ray's point and
    /// the two azimuths around its direction, each evaluated at its own corner; and the least and
    /// greatest of the eight.
    pub fn blended(&self, ray: &Ray<'_>, of: impl Fn(&Self, f64, &[Candidate]) -> f64) -> [f64; 3] {
        let slices = Slices::new(ray.direction, self.azimuths);
        let low = ray.at.map(f64::floor);
        let [mut sum, mut least, mut greatest] = [0.0, f64::INFINITY, f64::NEG_INFINITY];
        for corner in 0..4_i64 {
            let step = [corner % 2, corner / 2];
            let texel = [low[0] as i64 + step[0], low[1] as i64 + step[1]];
            let share = |i: usize| {
                let part = ray.at[i] - low[i];
                if step[i] == 1 { part } else { 1.0 - part }
            };
            let height = ray.relief.texel(texel) * ray.texels_per_height;
            for (azimuth, part) in slices.azimuths.into_iter().zip([1.0 - slices.weight, slices.weight]) {
                let candidates = (self.candidates)(ray.relief.wrapped(texel), azimuth);
                let sine = sine_of(of(self, height, &candidates));
                sum += share(0) * share(1) * part * sine;
                least = f64::min(least, sine);
                greatest = f64::max(greatest, sine);
            }
        }
        [sum, least, greatest]
    }

    /// Sine of the horizon by [`crate::Method::Sheen`]: the near field traced, and beyond it the
    /// blended envelopes.
    pub fn sheen(&self, ray: &Ray<'_>) -> f64 {
        let near = sine_of(ray.near().max(ray.floor()));
        let [far, ..] = self.blended(ray, |tables, height, all| tables.envelope(ray.kappa, height, all));
        near.max(far)
    }
}

/// The paper's tables, filtered.
#[derive(Clone, Copy, Debug)]
pub enum Published {
    /// Angle and distance.
    BetaAndDistance {
        /// Radians above the flat base's plane, in the texels of the bake.
        beta_rad: f64,
        /// Texels.
        distance: f64,
    },
    /// Distance alone: eq. 4, with the height of the point itself, finds the slope.
    Distance(f64),
}

impl Published {
    /// From what a sampler returns: beta = (x - 1/2) pi, distance = radius y; or distance = radius x.
    pub fn decoded(stored: [f64; 2], radius_texels: f64, only_distance: bool) -> Self {
        if only_distance {
            return Self::Distance((radius_texels * stored[0]).max(0.25));
        }
        Self::BetaAndDistance { beta_rad: (stored[0] - 0.5) * PI, distance: radius_texels * stored[1] }
    }

    /// Distance and slope in the texels at the point.
    pub fn pair(self, ray: &Ray<'_>, steepening: f64) -> (f64, f64) {
        match self {
            Self::BetaAndDistance { beta_rad, distance } => {
                let bounded = beta_rad.clamp(-FRAC_PI_2, FRAC_PI_2).tan().clamp(NO_HORIZON, -NO_HORIZON);
                (distance, bounded * steepening)
            }
            Self::Distance(distance) => (distance, (ray.height(distance) - ray.height(0.0)) / distance),
        }
    }

    /// tan(beta') by [`crate::Method::Flat`].
    pub fn flat(self, ray: &Ray<'_>, steepening: f64) -> f64 {
        self.pair(ray, steepening).1
    }

    /// tan(beta') by [`crate::Method::Paper`].
    pub fn paper(self, ray: &Ray<'_>, steepening: f64) -> f64 {
        let (distance, slope) = self.pair(ray, steepening);
        paper(ray.kappa, distance, slope, ray.height(0.0))
    }

    /// tan(beta') by [`crate::Method::Exact`].
    pub fn exact(self, ray: &Ray<'_>, steepening: f64) -> f64 {
        let (distance, slope) = self.pair(ray, steepening);
        exact_slope(ray.kappa, distance, slope, ray.height(0.0)).max(ray.floor())
    }
}
