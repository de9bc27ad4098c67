//! Colour spaces of FLIP. XYZ is relative to the white of linear RGB throughout: RGB (1, 1, 1) is
//! XYZ (1, 1, 1), so that no white point appears in the formulas.

pub(super) type Rgb = [f32; 3];

/// Opponent colours of linear RGB with the primaries of Rec. 709 and the white D65 (x = 0.31271,
/// y = 0.32902): Y, X - Y and Y - Z of what red and blue have more than green. Grey is thus free of
/// rounding.
const OPPONENT_FROM_RED_BLUE: [[f32; 2]; 3] =
    [[0.21263683, 0.0721802], [0.22125857, 0.11768204], [0.1948844, -0.8006018]];

/// RGB minus Y of X - Y and Y - Z: the inverse.
const RGB_FROM_OPPONENT: [[f32; 2]; 3] =
    [[3.080342, 0.542943], [-0.9211784, -0.04524841], [0.052881293, -1.15113]];

/// What `YCxCz` holds (2020, spatial filtering) without its scales and offset, which a filter of unit sum
/// does not see: luminance, red against green, yellow against blue.
pub(super) fn opponent([red, green, blue]: Rgb) -> [f32; 3] {
    let more = [red - green, blue - green];
    let [luminance, red_green, yellow_blue] = OPPONENT_FROM_RED_BLUE.map(|row| dot(row, more));
    [green + luminance, red_green, yellow_blue]
}

/// The displayable colour nearest to an opponent colour, channel by channel.
pub(super) fn rgb_from_opponent([luminance, red_green, yellow_blue]: [f32; 3]) -> Rgb {
    RGB_FROM_OPPONENT.map(|row| (luminance + dot(row, [red_green, yellow_blue])).clamp(0.0, 1.0))
}

/// Luminance, 1 for white.
pub(super) fn luminance(rgb: Rgb) -> f32 {
    opponent(rgb)[0]
}

/// CIELAB with chroma that fades with lightness, as the Hunt effect has it (2020, perceptually uniform colour space).
pub(super) fn hunt_lab(rgb: Rgb) -> [f32; 3] {
    let [luminance, red_green, yellow_blue] = opponent(rgb);
    let [x, y, z] = [luminance + red_green, luminance, luminance - yellow_blue].map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let chroma = 0.01 * lightness;
    [lightness, chroma * 500.0 * (x - y), chroma * 200.0 * (y - z)]
}

/// The `HyAB` distance of two colours in a space like CIELAB (2020, colour difference).
pub(super) fn hyab(one: [f32; 3], other: [f32; 3]) -> f32 {
    let [lightness, a, b] = [0, 1, 2].map(|i| one[i] - other[i]);
    lightness.abs() + (a * a + b * b).sqrt()
}

/// The nonlinearity of CIELAB.
fn lab_curve(value: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if value > DELTA * DELTA * DELTA { value.cbrt() } else { value / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

fn dot(one: [f32; 2], other: [f32; 2]) -> f32 {
    one[0] * other[0] + one[1] * other[1]
}
