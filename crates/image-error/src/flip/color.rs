//! Colour spaces of FLIP. XYZ is relative to the white of linear RGB throughout: RGB (1, 1, 1) is
//! XYZ (1, 1, 1), so that no white point appears in the formulas.

pub(super) type Rgb = [f32; 3];

/// XYZ of linear RGB with the primaries of Rec. 709 and the white D65, from their chromaticities.
const XYZ_FROM_RGB: [[f32; 3]; 3] = [
    [0.433_887_35, 0.376_224_0, 0.189_888_65],
    [0.212_639_01, 0.715_168_7, 0.072_192_32],
    [0.017_750_04, 0.109_447_62, 0.872_802_34],
];

/// The inverse of [`XYZ_FROM_RGB`].
const RGB_FROM_XYZ: [[f32; 3]; 3] = [
    [3.080_399_1, -1.537_383_2, -0.543_015_9],
    [-0.921_223_36, 1.875_967_5, 0.045_255_857],
    [0.052_873_94, -0.203_976_96, 1.151_103],
];

/// What YCxCz holds (2020, section 4.1) without its scales and offset, which a filter of unit sum
/// does not see: luminance, red against green, yellow against blue.
pub(super) fn opponent(rgb: Rgb) -> [f32; 3] {
    let [x, y, z] = transform(&XYZ_FROM_RGB, rgb);
    [y, x - y, y - z]
}

/// The displayable colour nearest to an opponent colour, channel by channel.
pub(super) fn rgb_from_opponent([luminance, red_green, yellow_blue]: [f32; 3]) -> Rgb {
    let xyz = [luminance + red_green, luminance, luminance - yellow_blue];
    transform(&RGB_FROM_XYZ, xyz).map(|value| value.clamp(0.0, 1.0))
}

/// Rec. 709 luminance.
pub(super) fn luminance(rgb: Rgb) -> f32 {
    dot(XYZ_FROM_RGB[1], rgb)
}

/// CIELAB with chroma that fades with lightness, as the Hunt effect has it (2020, equation 3).
pub(super) fn hunt_lab(rgb: Rgb) -> [f32; 3] {
    let [x, y, z] = transform(&XYZ_FROM_RGB, rgb).map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let chroma = 0.01 * lightness;
    [lightness, chroma * 500.0 * (x - y), chroma * 200.0 * (y - z)]
}

/// The HyAB distance of two colours in a space like CIELAB (2020, equation 4).
pub(super) fn hyab(one: [f32; 3], other: [f32; 3]) -> f32 {
    let [lightness, a, b] = [0, 1, 2].map(|i| one[i] - other[i]);
    lightness.abs() + (a * a + b * b).sqrt()
}

/// The nonlinearity of CIELAB.
fn lab_curve(value: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if value > DELTA * DELTA * DELTA { value.cbrt() } else { value / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

fn transform(matrix: &[[f32; 3]; 3], vector: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| dot(row, vector))
}

fn dot(one: [f32; 3], other: [f32; 3]) -> f32 {
    one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}
