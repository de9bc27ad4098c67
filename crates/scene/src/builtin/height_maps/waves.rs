//! Sand: rows of asymmetric waves that join and part.

use std::f64::consts::{PI, TAU};

use super::noise::gradient_noise;

/// Twelve ripples or so, of an amplitude that fades where rows join.
pub(super) fn ripples(x: f64, y: f64, _texels: u32) -> f64 {
    let (phase, amplitude) = rows(x, y, [11.0, 13.0], 0.07);
    // The longer half of a wave is the windward one.
    let wave = 0.5 - 0.5 * (phase - 0.45 * phase.sin()).cos();
    amplitude.sqrt() * wave * (1.0 + 0.35 * gradient_noise(x, y, 6, 21)) + 0.3 * gradient_noise(x, y, 3, 22)
}

/// Three rows of dunes: a long rise, a sharp crest, and a straight slip face.
pub(super) fn dunes(x: f64, y: f64, _texels: u32) -> f64 {
    const LEE: f64 = 0.22;
    let (phase, amplitude) = rows(x, y, [3.0, 3.0], 0.11);
    let share = phase / TAU;
    let wave = if share < 1.0 - LEE {
        0.5 - 0.5 * (PI * (share / (1.0 - LEE)).powf(1.2)).cos()
    } else {
        (1.0 - share) / LEE
    };
    amplitude * wave * (1.0 + 0.9 * gradient_noise(x, y, 3, 31)) + 0.15 * gradient_noise(x, y, 2, 32)
}

/// Phase in 0..2 pi and amplitude in 0..=1 of the sum of two wave trains along y with so many waves,
/// one of them stronger here and the other there: where they cancel, rows begin or end, as ripples
/// do. `bend` is how far noise shifts the rows.
fn rows(x: f64, y: f64, waves: [f64; 2], bend: f64) -> (f64, f64) {
    let shift = bend * (gradient_noise(x, y, 2, 11) + 0.4 * gradient_noise(x, y, 5, 12));
    let share = super::smooth_step(-0.35, 0.35, gradient_noise(x, y, 3, 13));
    let [first, second] = waves.map(|waves| (TAU * waves * (y + shift)).sin_cos());
    let sin = share * first.0 + (1.0 - share) * second.0;
    let cos = share * first.1 + (1.0 - share) * second.1;
    (sin.atan2(cos).rem_euclid(TAU), sin.hypot(cos).min(1.0))
}
