//! Lobes that are round about an axis: the Phong cone of glossy-planes and the diffused
//! environment of diffuse-envmap.
//!
//! Both reflect all light: their density over the sphere is one, and what would leave below the
//! horizon is discarded and the rest scaled up by the share that is left.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::LazyLock;

use glam::DVec3;

use super::{azimuthal, mirrored};
use crate::frame::Frame;

/// How the density falls with the angle from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Round {
    /// Yamada et al.: weights cos^shine inside a cone about the mirror direction.
    Cone {
        /// Half the cone's angle, above 0, at most pi / 2.
        half_angle_rad: f64,
        /// Exponent of the weights, at least 0.
        shine: f64,
        /// 1 - cos^(shine + 1) at the rim: the weights' integral times (shine + 1) / 2 pi.
        mass: f64,
    },
    /// Hirokawa and Ikedo: the cosine-weighted hemisphere with all angles scaled by t, about an
    /// axis that moves from the mirror direction to the normal (eqs. 3 and 4).
    Diffused {
        /// Roughness t, above 0, at most 1.
        t: f64,
    },
}

impl Round {
    /// A cone of a half-angle above 0 and at most pi / 2, with weights cos^shine.
    pub(crate) fn cone(half_angle_rad: f64, shine: f64) -> Self {
        let mass = -((shine + 1.0) * log_cosine(half_angle_rad)).exp_m1();
        Self::Cone { half_angle_rad, shine, mass }
    }

    /// Reflected share per steradian, and density of [`Self::sample`], between two directions
    /// above the horizon.
    pub(crate) fn evaluate(self, outgoing: DVec3, incoming: DVec3) -> [f64; 2] {
        let axis = self.axis(outgoing);
        // The chord keeps the digits of small angles.
        let angle = 2.0 * (0.5 * axis.distance(incoming)).min(1.0).asin();
        let pdf = self.density(angle);
        let value = if pdf > 0.0 { pdf / self.share_above(axis) } else { 0.0 };
        [value, pdf]
    }

    /// A direction of the whole lobe; may point below the horizon.
    pub(crate) fn sample(self, outgoing: DVec3, u: [f64; 2]) -> DVec3 {
        let (sine, cosine) = self.angle_of(u[1]).sin_cos();
        Frame::new(self.axis(outgoing)).world_from_local(azimuthal(sine, cosine, u[0]))
    }

    /// Eq. 3 of diffuse-envmap, or the mirror direction.
    fn axis(self, outgoing: DVec3) -> DVec3 {
        let mirror = mirrored(outgoing);
        match self {
            Self::Cone { .. } => mirror,
            Self::Diffused { t } => mirror.lerp(DVec3::Z, t).try_normalize().unwrap_or(DVec3::Z),
        }
    }

    fn largest_angle(self) -> f64 {
        match self {
            Self::Cone { half_angle_rad, .. } => half_angle_rad,
            Self::Diffused { t } => FRAC_PI_2 * t,
        }
    }

    /// Density per steradian at an angle from the axis; integrates to one over the sphere.
    pub(crate) fn density(self, angle: f64) -> f64 {
        if angle > self.largest_angle() {
            return 0.0;
        }
        match self {
            Self::Cone { shine, mass, .. } => {
                let power = if shine == 0.0 { 1.0 } else { (shine * log_cosine(angle)).exp() };
                (shine + 1.0) / (TAU * mass) * power
            }
            // Below 1e-6 t both sines are their angles to the last digit.
            Self::Diffused { t } if angle < 1e-6 * t => 1.0 / (PI * t * t),
            Self::Diffused { t } => (2.0 * angle / t).sin().max(0.0) / (TAU * t * angle.sin()),
        }
    }

    /// The angle within which a share (0..=1) of the lobe lies.
    pub(crate) fn angle_of(self, share: f64) -> f64 {
        match self {
            Self::Cone { half_angle_rad, .. } => self.tangent_of(share).atan().min(half_angle_rad),
            Self::Diffused { t } => t * share.sqrt().min(1.0).asin(),
        }
    }

    /// The tangent of that angle.
    fn tangent_of(self, share: f64) -> f64 {
        match self {
            Self::Cone { shine, mass, .. } => {
                let log_cosine = (-share * mass).ln_1p() / (shine + 1.0);
                (-2.0 * log_cosine).exp_m1().max(0.0).sqrt()
            }
            Self::Diffused { .. } => self.angle_of(share).tan(),
        }
    }

    /// The share of the lobe within an angle.
    fn share_within(self, angle: f64) -> f64 {
        match self {
            Self::Cone { shine, mass, .. } => (-((shine + 1.0) * log_cosine(angle)).exp_m1() / mass).min(1.0),
            Self::Diffused { t } => (angle / t).min(FRAC_PI_2).sin().powi(2),
        }
    }

    /// The share of the lobe above the horizon, 1/2 to 1, for an axis above it.
    ///
    /// The part of each circle about the axis that is above is known; it is summed over the lobe's
    /// shares by a Gauss rule whose points crowd where the circles begin to dip (there the integrand
    /// has a root) and at the rim. The error is below 3e-6.
    pub(crate) fn share_above(self, axis: DVec3) -> f64 {
        let lift = axis.z.min(1.0).asin();
        if lift >= self.largest_angle() {
            return 1.0;
        }
        let level = self.share_within(lift);
        let slope = lift.tan();
        let above: f64 = GAUSS
            .iter()
            .map(|&(x, weight)| {
                let share = level + (1.0 - level) * x * x * (3.0 - 2.0 * x);
                let below = slope / self.tangent_of(share);
                weight * 6.0 * x * (1.0 - x) * (0.5 + below.clamp(-1.0, 1.0).asin() / PI)
            })
            .sum();
        level + (1.0 - level) * above
    }
}

/// ln cos of an angle of at most pi / 2, exact where it is small.
fn log_cosine(angle: f64) -> f64 {
    let sine = angle.sin();
    0.5 * (-sine * sine).max(-1.0).ln_1p()
}

const GAUSS_POINTS: usize = 20;

/// Points and weights of the Gauss-Legendre rule on 0..1.
static GAUSS: LazyLock<[(f64, f64); GAUSS_POINTS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = GAUSS_POINTS as f64;
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for l in 1..GAUSS_POINTS {
                let l = l as f64;
                (before, value) = (value, ((2.0 * l + 1.0) * x * value - l * before) / (l + 1.0));
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    })
});
