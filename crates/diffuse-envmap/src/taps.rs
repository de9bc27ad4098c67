//! The fitted taps of `Method::Sheen`: a ring of six, or one tap on the lobe's axis, each
//! completed by spherical harmonics.
//!
//! The environment's chain holds it convolved with Gaussians whose width doubles per level. A
//! lobe of roughness t is matched, band by band of its Legendre series, by the mean of six
//! directions at `ring_angle` from the axis, each read at `ring_level`. Where the lobe sees
//! little contrast, one tap along the axis at `axis_level` stands for it. What either lacks in
//! bands 1 and 2 is added exactly from the environment's harmonics.

use crate::model;

/// Taps on the ring.
pub const RING_TAPS: usize = 6;
/// Nodes of the table per halving of t.
pub const NODES_PER_OCTAVE: usize = 8;
/// Halvings of t that the table covers: t from 2^-OCTAVES to 1.
pub const OCTAVES: usize = 10;
/// Nodes of the table.
pub const NODES: usize = NODES_PER_OCTAVE * OCTAVES + 1;
/// Standard deviation of a chain level's Gaussian, in texels at the middle of a cube face.
pub const SIGMA_TEXELS: f64 = 1.0;

/// How one lobe is assembled from the chain. Levels are exponents: level e has the standard
/// deviation `SIGMA_TEXELS * 2^e` radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    /// Chain level of the single tap on the axis.
    pub axis_level: f64,
    /// Angle of the ring from the axis, radians.
    pub ring_angle: f64,
    /// Chain level of the ring.
    pub ring_level: f64,
}

/// The t of a node of the table.
pub fn node_roughness(node: usize) -> f64 {
    (node as f64 / NODES_PER_OCTAVE as f64 - OCTAVES as f64).exp2()
}

/// The Legendre coefficient of band l of the chain at a fractional level: the trilinear mix of
/// two Gaussians.
pub fn chain_coefficient(level: f64, l: usize) -> f64 {
    let band = (l * (l + 1)) as f64;
    let gaussian = |level: f64| (-0.5 * band * (SIGMA_TEXELS * level.exp2()).powi(2)).exp();
    let fraction = level - level.floor();
    (1.0 - fraction) * gaussian(level.floor()) + fraction * gaussian(level.floor() + 1.0)
}

impl Taps {
    /// The Legendre coefficient of band l of the axis tap.
    pub fn axis_coefficient(&self, l: usize) -> f64 {
        chain_coefficient(self.axis_level, l)
    }

    /// The Legendre coefficient of band l of the ring, averaged over its azimuth.
    pub fn ring_coefficient(&self, l: usize) -> f64 {
        model::legendre(self.ring_angle.cos(), l)[l] * chain_coefficient(self.ring_level, l)
    }
}

/// The table as the shaders read it: two rows of [`NODES`] texels. The first row holds
/// (axis level, ring angle, ring level, 0); the second what bands 1 and 2 of the axis tap lack,
/// then what those of the ring lack.
pub fn table_texels(table: &[Taps; NODES]) -> [Vec<[f32; 4]>; 2] {
    let mut rows = [Vec::with_capacity(NODES), Vec::with_capacity(NODES)];
    for (node, taps) in table.iter().enumerate() {
        let t = node_roughness(node);
        // Narrow lobes keep their low bands by themselves; there the shader skips harmonics.
        let wide = ((t - 0.15) / 0.15).clamp(0.0, 1.0);
        let lobe = model::legendre_coefficients(t, 2);
        let lack = |l: usize, coefficient: f64| (wide * (lobe[l] - coefficient)) as f32;
        rows[0].push([taps.axis_level as f32, taps.ring_angle as f32, taps.ring_level as f32, 0.0]);
        rows[1].push([
            lack(1, taps.axis_coefficient(1)),
            lack(2, taps.axis_coefficient(2)),
            lack(1, taps.ring_coefficient(1)),
            lack(2, taps.ring_coefficient(2)),
        ]);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tap_table::TAP_TABLE;

    #[test]
    fn the_table_keeps_the_width_of_every_lobe() {
        for (node, taps) in TAP_TABLE.iter().enumerate() {
            let t = node_roughness(node);
            // 1 - A_1 is the mean of 1 - cos(theta): half the mean squared angle.
            let width = 1.0 - model::legendre_coefficients(t, 1)[1];
            let ring = (1.0 - taps.ring_coefficient(1)) / width;
            assert!((ring - 1.0).abs() < 0.15, "ring at t {t}: {ring}");
        }
    }
}
