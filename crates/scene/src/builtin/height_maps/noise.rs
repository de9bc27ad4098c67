//! Periodic noise from hashed lattice points.

use std::f64::consts::TAU;

/// Rough ground: each octave has 0.6 of the height of the one before.
pub(super) fn rough(x: f64, y: f64, texels: u32) -> f64 {
    fractal(x, y, texels, 0.6)
}

/// Rolling ground: each octave has 0.35 of the height of the one before.
pub(super) fn smooth(x: f64, y: f64, texels: u32) -> f64 {
    fractal(x, y, texels, 0.35)
}

/// The sum of octaves of noise from 4 cells a side to cells of two texels.
fn fractal(x: f64, y: f64, texels: u32, gain: f64) -> f64 {
    let octaves = std::iter::successors(Some(4), |cells| Some(cells * 2));
    octaves
        .take_while(|&cells| cells == 4 || 2 * cells <= texels)
        .enumerate()
        .map(|(octave, cells)| gain.powi(octave as i32) * gradient_noise(x, y, cells, octave as u32))
        .sum()
}

/// Gradient noise (Perlin) of `cells` x `cells` over 0..1, in about -0.7..0.7, 0 in the mean.
pub(super) fn gradient_noise(x: f64, y: f64, cells: u32, seed: u32) -> f64 {
    let (x, y) = (x * f64::from(cells), y * f64::from(cells));
    let (column, row) = (x.floor(), y.floor());
    let (x, y) = (x - column, y - row);
    let corner = |right: u32, down: u32| {
        let at = [(column as u32 + right) % cells, (row as u32 + down) % cells];
        let (sin, cos) = (TAU * random(at, seed, 0)).sin_cos();
        cos * (x - f64::from(right)) + sin * (y - f64::from(down))
    };
    let [across, down] = [x, y].map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let along_row = |row: u32| corner(0, row) * (1.0 - across) + corner(1, row) * across;
    along_row(0) * (1.0 - down) + along_row(1) * down
}

/// A number in 0..1 for a lattice point: of each seed and `which` another.
pub(super) fn random([column, row]: [u32; 2], seed: u32, which: u32) -> f64 {
    let mixed = hash(column ^ hash(row ^ hash(seed ^ hash(which))));
    f64::from(mixed) / 4_294_967_296.0
}

/// An integer hash of low bias (Wellons, "Prospecting for Hash Functions").
fn hash(key: u32) -> u32 {
    let key = key.wrapping_add(0x9e37_79b9);
    let key = (key ^ (key >> 16)).wrapping_mul(0x7feb_352d);
    let key = (key ^ (key >> 15)).wrapping_mul(0x846c_a68b);
    key ^ (key >> 16)
}
