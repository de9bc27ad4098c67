//! The normalised Blinn lobe of the glare technique (Kakimoto et al., eqs. 2, 4 and 5).
//!
//! Light of radiance L from a solid angle dw adds C(n) (N.H)^n L dw, without a cosine, with
//! C(n) = (n + 2) / (8 pi (1 - 2^(-(n + 2) / 2))): the total over the hemisphere's *solid angle*
//! (not over flux) is exactly 1 where one of the directions is the normal, for every n. Away from
//! it the lobe loses what falls below the horizon and, because H moves half as far, tends to n.v
//! for large n; at n = 0 it is 1 for all directions.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{azimuthal, half_vector};

/// A lobe of exponent n, at least 0 and finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blinn {
    pub(crate) exponent: f64,
}

impl Blinn {
    /// Reflected share per steradian, and density of [`Self::sample`], between two directions
    /// above the horizon.
    pub(crate) fn evaluate(self, outgoing: DVec3, incoming: DVec3) -> [f64; 2] {
        let half = half_vector(outgoing, incoming);
        // ln cos from the sine keeps its digits where n is large.
        let log_cosine = 0.5 * (-(half.x * half.x + half.y * half.y)).max(-1.0).ln_1p();
        let power = if self.exponent == 0.0 { 1.0 } else { (self.exponent * log_cosine).exp() };
        let value = self.peak() * power;
        let facing = outgoing.dot(half);
        let pdf = if facing > 0.0 { (self.exponent + 1.0) / (4.0 * TAU) * power / facing } else { 0.0 };
        [value, pdf]
    }

    /// Reflects about a half vector whose density is (n + 1) / 2 pi cos^n. May point below the
    /// horizon.
    pub(crate) fn sample(self, outgoing: DVec3, u: [f64; 2]) -> DVec3 {
        // cos = (1 - u)^(1 / (n + 1)).
        let log_cosine = (-u[1]).ln_1p() / (self.exponent + 1.0);
        let half = azimuthal((-(2.0 * log_cosine).exp_m1()).sqrt(), log_cosine.exp(), u[0]);
        2.0 * outgoing.dot(half) * half - outgoing
    }

    /// C(n): eq. 4 with the factor of eq. 5.
    fn peak(self) -> f64 {
        let n = self.exponent + 2.0;
        n / (8.0 * PI * (1.0 - (-0.5 * n).exp2()))
    }
}
