//! The mathematics of horizon-shadow in f64: what the shaders are tested against.
//!
//! A relief of height h lies on a base surface whose normal curvature along the light's azimuth is
//! kappa (1 / texel, convex positive). From a point P at height h, a point Q that lies `distance` d
//! ahead and H = `rise` higher is seen under an angle beta' above P's tangent plane; lengths are in
//! texels. With gamma = kappa d
//!
//! tan(beta') = [H cos(gamma) - (1 + kappa h) c] / [(1 + kappa (h + H)) s],
//! s = d sin(gamma) / gamma, c = (1 - cos(gamma)) / kappa.                           ([`exact`])
//!
//! A convex base hides what is below tan(beta') = -sqrt(kappa h (2 + kappa h)).       ([`floor`])
//! The paper has instead (eqs. 2 and 3)
//!
//! tan(beta') = max(tan(beta) (1 - kappa h) - kappa d / 2, floor).                    ([`paper`])
//!
//! Where the base's geodesic torsion along the azimuth is tau, normals ahead lean sideways, so that
//! Sheen's methods look along an azimuth on the map that is turned by -tau h. ([`View::turned`])
//!
//! P is lit where L.N > tan(beta') |V|, V the light's part along the tangent plane.

mod lookup;
mod ray;
mod relief;
mod view;

pub use lookup::{Candidate, CandidateTables, Published, Slices};
pub use ray::Ray;
pub use relief::Relief;
pub use view::{Map, Point, View};

use std::f64::consts::{FRAC_PI_2, PI};

/// The tangent that stands for "no horizon"; its negative bounds tangents from above.
pub const NO_HORIZON: f64 = -1e4;

/// Below this distance, in texels, Sheen's methods trace the relief.
pub const NEAR_TEXELS: f64 = 1.0;

/// sin(angle) / angle.
pub fn sinc(angle_rad: f64) -> f64 {
    if angle_rad.abs() < 1e-5 { 1.0 - angle_rad * angle_rad / 6.0 } else { angle_rad.sin() / angle_rad }
}

/// (1 - cos(angle)) / angle^2, without cancellation.
pub fn versine(angle_rad: f64) -> f64 {
    0.5 * sinc(0.5 * angle_rad).powi(2)
}

/// tan(beta') of a point `distance` ahead whose slope (rise / distance) is `slope`; the limit where
/// the distance is 0. [`NO_HORIZON`] where it is a quarter turn away or beyond the centre of
/// curvature, so that no ray from P along the surface meets it.
pub fn exact_slope(kappa: f64, distance: f64, slope: f64, height: f64) -> f64 {
    let gamma = kappa * distance;
    let from_centre = 1.0 + kappa * height;
    let across = from_centre + gamma * slope;
    if gamma.abs() >= FRAC_PI_2 || across <= 0.0 {
        return NO_HORIZON;
    }
    let up = slope * gamma.cos() - from_centre * gamma * versine(gamma);
    (up / (across * sinc(gamma))).clamp(NO_HORIZON, -NO_HORIZON)
}

/// The same of a rise, for a distance above 0.
pub fn exact(kappa: f64, distance: f64, rise: f64, height: f64) -> f64 {
    exact_slope(kappa, distance, rise / distance, height)
}

/// tan(beta') of the smooth base's own horizon, seen from a height above it: eq. 3 with its sign put
/// right. [`NO_HORIZON`] where the base is not convex.
pub fn floor(kappa: f64, height: f64) -> f64 {
    if kappa <= 0.0 {
        return NO_HORIZON;
    }
    let x = (kappa * height).max(0.0);
    (-(x * (2.0 + x)).sqrt()).max(NO_HORIZON)
}

/// Eqs. 2 and 3: the paper's horizon on convex surfaces, and the flat one on others.
pub fn paper(kappa: f64, distance: f64, slope: f64, height: f64) -> f64 {
    if kappa < 0.0 {
        return slope;
    }
    (slope * (1.0 - kappa * height) - 0.5 * kappa * distance).max(floor(kappa, height))
}

/// Sine of the angle of a tangent.
pub fn sine_of(tangent: f64) -> f64 {
    tangent / tangent.hypot(1.0)
}

/// Tangent of the angle of a sine, within the bounds of [`NO_HORIZON`].
pub fn tangent_of(sine: f64) -> f64 {
    let cosine = ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt();
    if cosine == 0.0 {
        return sine.signum() * -NO_HORIZON;
    }
    (sine / cosine).clamp(NO_HORIZON, -NO_HORIZON)
}

/// Fraction of a disc of angular radius `radius_rad` that stands above a straight horizon, when its
/// centre is at the elevation `light_rad` and the horizon at `horizon_rad`:
/// 1/2 + (asin x + x sqrt(1 - x^2)) / pi, x = sin(light - horizon) / sin(radius).
/// A point light on the horizon is dark.
pub fn fraction(horizon_rad: f64, light_rad: f64, radius_rad: f64) -> f64 {
    let apart = light_rad - horizon_rad;
    if apart.abs() >= FRAC_PI_2 {
        return if apart > 0.0 { 1.0 } else { 0.0 };
    }
    let (above, radius) = (apart.sin(), radius_rad.sin());
    if above <= -radius {
        return 0.0;
    }
    if above >= radius {
        return 1.0;
    }
    let x = above / radius;
    0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / PI
}

/// Share of a normal distribution that lies below `x` standard deviations, by Simpson's rule.
pub fn normal_share(x: f64) -> f64 {
    let bounded = x.clamp(-9.0, 9.0);
    let density = |t: f64| (-0.5 * t * t).exp();
    let steps = 400;
    let step = bounded / f64::from(2 * steps);
    let sum: f64 = (0..steps)
        .map(|i| f64::from(2 * i) * step)
        .map(|t| density(t) + 4.0 * density(t + step) + density(t + 2.0 * step))
        .sum();
    0.5 + sum * step / 3.0 / (2.0 * PI).sqrt()
}

/// Visibility where bumps are smaller than a pixel: the share of horizons, whose sines are normally
/// distributed with this mean and mean square, that lie below the light. A disc's standard deviation
/// along a line is half its radius.
pub fn prefiltered(mean: f64, mean_square: f64, light_sine: f64, radius_rad: f64) -> f64 {
    let variance = (mean_square - mean * mean).max(0.0) + 0.25 * radius_rad * radius_rad;
    normal_share((light_sine - mean) / (variance + 1e-6).sqrt())
}
