//! Height maps whose shadows are known.

use horizon_shadow::{Method, Settings};

use super::{Map, Picture, SIDE};

/// All that cast shadows.
pub const SHADOWED: [Method; 6] =
    [Method::Flat, Method::Paper, Method::Exact, Method::Sheen, Method::Certified, Method::Marched];
/// Those that know the curvature exactly.
pub const CURVED: [Method; 3] = [Method::Sheen, Method::Certified, Method::Marched];

/// Metres of a texel of a map of 64 texels on the plane.
pub const TEXEL_M: f32 = 2.0 / 64.0;

pub fn with(method: Method) -> Settings {
    Settings { method, march_steps: 256, prefilter: false, ..Settings::SHEEN }
}

/// Two texels across u that are 8 texels high.
pub fn ridge(size: [u32; 2]) -> Map {
    Map::new(size, |i, _| if (30..32).contains(&i) { 8.0 * TEXEL_M } else { 0.0 })
}

/// The ridge's shadow where the light stands at 45 degrees over +x: what is in `dark` must be dark,
/// what is neither in it nor beside it must be lit. Pixels are texels.
pub fn check_shadow(
    what: &str,
    picture: &Picture,
    dark: std::ops::Range<i32>,
    column: impl Fn(usize) -> i32,
) {
    for (i, pixel) in picture.iter().enumerate() {
        let x = column(i);
        let found = pixel.expect("the plane covers the picture")[0];
        if dark.contains(&x) {
            assert!(found < 0.01, "{what}: {found} at {x}, pixel {i}");
        } else if !(dark.start - 1..=dark.end).contains(&x) {
            assert!(found > 0.99, "{what}: {found} at {x}, pixel {i}");
        }
    }
}

pub fn column(pixel: usize) -> i32 {
    pixel as i32 % SIDE as i32
}

pub fn row(pixel: usize) -> i32 {
    pixel as i32 / SIDE as i32
}

/// Fraction of pixels whose first channels differ by more than a quarter.
pub fn difference(a: &Picture, b: &Picture) -> f32 {
    let differ = |(a, b): &(&Option<[f32; 4]>, &Option<[f32; 4]>)| match (a, b) {
        (Some(a), Some(b)) => (a[0] - b[0]).abs() > 0.25,
        (None, None) => false,
        _ => true,
    };
    a.iter().zip(b).filter(differ).count() as f32 / a.len() as f32
}

/// Bumps that repeat after 64 texels, 0..0.1 metres.
pub fn bumps(i: u32, j: u32) -> f32 {
    ((i * 7 % 64 + j * 3 % 64) as f32 * 0.19).sin().max(0.0) * 0.1
}

/// A map of them.
pub fn bumps_map(size: [u32; 2]) -> Map {
    Map::new(size, bumps)
}
