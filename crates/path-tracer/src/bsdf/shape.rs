//! The shapes of lobes, without reflectance, behind one interface.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::{Parameters, azimuthal, blinn::Blinn, ggx::Ggx, mirrored, round::Round};
use crate::Lobe;

/// Lobes narrower than this (in radians) are perfect mirrors: rays cannot resolve them.
const NARROWEST: f64 = 1e-7;

/// A lobe of reflectance one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// Equal radiance in all directions.
    Lambert,
    /// The mirror direction alone.
    Mirror,
    Ggx(Ggx),
    Blinn(Blinn),
    Round(Round),
}

impl Shape {
    /// A material's specular lobe.
    pub(super) fn specular(parameters: &Parameters, lobe: Lobe) -> Self {
        let exponent = parameters.shininess.unwrap_or_else(|| exponent(parameters.roughness));
        match lobe {
            Lobe::Ggx => Self::ggx(parameters.roughness),
            Lobe::Blinn => Self::blinn(exponent),
            Lobe::PhongCone => Self::cone(parameters.spread_rad, parameters.shininess, exponent),
            Lobe::DiffusedEnvironment => Self::diffused(parameters.roughness),
        }
    }

    /// The same kind of lobe for a clear coat of this roughness.
    pub(super) fn coat(roughness: f64, lobe: Lobe) -> Self {
        Self::specular(&Parameters { roughness, ..Parameters::default() }, lobe)
    }

    pub(super) fn ggx(roughness: f64) -> Self {
        let alpha = roughness * roughness;
        if alpha < NARROWEST { Self::Mirror } else { Self::Ggx(Ggx { alpha }) }
    }

    fn blinn(exponent: f64) -> Self {
        if 2.0 / exponent < NARROWEST * NARROWEST { Self::Mirror } else { Self::Blinn(Blinn { exponent }) }
    }

    /// The Phong exponent of equal width is a quarter of Blinn's. Where one of spread and exponent
    /// is missing, the weight at the rim of the cone is 1 %.
    fn cone(spread_rad: Option<f64>, shininess: Option<f64>, exponent: f64) -> Self {
        const LOG_RIM_WEIGHT: f64 = -4.605170185988091;
        let tied_angle = || (LOG_RIM_WEIGHT / (0.25 * exponent)).exp().acos();
        let half_angle_rad = spread_rad.unwrap_or_else(tied_angle).clamp(0.0, FRAC_PI_2);
        let sine = half_angle_rad.sin();
        let tied_shine = LOG_RIM_WEIGHT / (0.5 * (-sine * sine).ln_1p());
        let shine = match (spread_rad, shininess) {
            (Some(_), None) => tied_shine,
            _ => 0.25 * exponent,
        };
        let narrow = half_angle_rad < NARROWEST || 1.0 / shine < NARROWEST * NARROWEST;
        if narrow { Self::Mirror } else { Self::Round(Round::cone(half_angle_rad, shine)) }
    }

    fn diffused(t: f64) -> Self {
        if t < NARROWEST { Self::Mirror } else { Self::Round(Round::Diffused { t }) }
    }

    pub(crate) fn is_delta(&self) -> bool {
        *self == Self::Mirror
    }

    /// Reflected share per steradian, with the cosine, and density of [`Self::sample`]; both 0 for
    /// a mirror and where a direction is not above the horizon.
    pub(crate) fn evaluate(&self, outgoing: DVec3, incoming: DVec3) -> [f64; 2] {
        if !(outgoing.z > 0.0 && incoming.z > 0.0) {
            return [0.0; 2];
        }
        match self {
            Self::Lambert => [incoming.z / PI; 2],
            Self::Mirror => [0.0; 2],
            Self::Ggx(lobe) => lobe.evaluate(outgoing, incoming),
            Self::Blinn(lobe) => lobe.evaluate(outgoing, incoming),
            Self::Round(lobe) => lobe.evaluate(outgoing, incoming),
        }
    }

    /// A direction for two numbers of 0..1; may be below the horizon, where nothing is reflected.
    pub(crate) fn sample(&self, outgoing: DVec3, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Lambert => azimuthal(u[1].sqrt(), (1.0 - u[1]).sqrt(), u[0]),
            Self::Mirror => mirrored(outgoing),
            Self::Ggx(lobe) => lobe.sample(outgoing, u),
            Self::Blinn(lobe) => lobe.sample(outgoing, u),
            Self::Round(lobe) => lobe.sample(outgoing, u),
        }
    }
}

/// n = 2 / alpha^2 - 2 with alpha = roughness^2.
fn exponent(roughness: f64) -> f64 {
    2.0 / roughness.powi(4) - 2.0
}
