//! The environments that the methods are judged under.

use diffuse_envmap::model::Map;
use half::f16;
use scene::{Environment, Limits, builtin, load};

/// The largest finite half float.
const HALF_MAX: f32 = 65504.0;

/// An environment, and what the GPU holds of it.
#[derive(Clone, Debug)]
pub(super) struct TestMap {
    /// Short name for tables.
    pub(super) name: &'static str,
    /// The environment, of intensity 1 and not turned.
    pub(super) environment: Environment,
    /// Its texels as they lie on the GPU.
    pub(super) held: Map,
}

impl TestMap {
    fn new(name: &'static str, environment: Environment) -> Self {
        let is_brighter = environment.pixels.iter().flatten().any(|&value| value > HALF_MAX);
        // Half floats hold a map where they can, full floats one that is brighter.
        let held = |x: f32| if is_brighter { f64::from(x) } else { f16::from_f32(x).to_f64() };
        let texels = environment.pixels.iter().map(|texel| texel.map(held)).collect();
        let (width, height) = (environment.width as usize, environment.height as usize);
        Self { name, environment, held: Map { width, height, texels } }
    }

    fn of(name: &'static str, width: u32, f: impl Fn(u32, u32) -> [f32; 3]) -> Self {
        let height = width / 2;
        let pixels = (0..width * height).map(|i| f(i % width, i / width)).collect();
        Self::new(name, Environment::new(name, width, height, pixels).expect("the pixels fit the size"))
    }

    /// Whether half floats hold it.
    pub(super) fn fits_half(&self) -> bool {
        self.environment.pixels.iter().flatten().all(|&value| value <= HALF_MAX)
    }
}

/// The same coloured radiance everywhere but for one texel that is a thousandth brighter, so that
/// the short cut for constant maps does not hide the sum of the weights.
pub(super) fn furnace(width: u32) -> TestMap {
    TestMap::of("furnace", width, |x, y| {
        [0.75, 0.5, 0.25].map(|value| if (x, y) == (3, 9) { value * 1.001 } else { value })
    })
}

/// One radiance everywhere.
pub(super) fn constant(width: u32) -> TestMap {
    TestMap::of("constant", width, |_, _| [0.75, 0.5, 0.25])
}

/// Edges in every direction: bright above, dark below; a bright half turn; and a white bar.
pub(super) fn step(width: u32) -> TestMap {
    TestMap::of("step edge", width, |x, y| {
        let bar = (3 * width / 8..width / 2).contains(&x) && (width / 8..width / 4).contains(&y);
        [
            if y < width / 4 { 2.0 } else { 0.25 },
            if x < width / 2 { 1.0 } else { 0.1 },
            if bar { 3.0 } else { 0.3 },
        ]
    })
}

/// One texel of 1e5 in a dim sky.
pub(super) fn sun(width: u32) -> TestMap {
    let at = (5 * width / 16, 5 * width / 32);
    TestMap::of("sun of one texel", width, move |x, y| {
        let sky = [0.3, 0.4, 0.6 - 0.5 * y as f32 / width as f32];
        if (x, y) == at { [1e5, 9e4, 8e4] } else { sky }
    })
}

/// An overcast sky: a smooth change from below to above, and no edge.
pub(super) fn calm(width: u32) -> TestMap {
    TestMap::of("overcast", width, |_, y| {
        let height = (std::f32::consts::TAU * (y as f32 + 0.5) / width as f32).cos();
        [0.4 + 0.2 * height, 0.45 + 0.2 * height, 0.5 + 0.25 * height]
    })
}

/// A built-in environment, `sky` or `studio`.
pub(super) fn built_in(name: &'static str, width: u32) -> TestMap {
    TestMap::new(name, builtin::environment_sized(name, width).expect("a built-in name"))
}

/// The real environments and their short names.
pub(super) const REAL: [(&str, &str); 5] = [
    ("park, low sun", "hdri/rooitou_park_1k.hdr"),
    ("even square", "hdri/potsdamer_platz_1k.hdr"),
    ("dark studio", "hdri/studio_small_03_1k.hdr"),
    ("hotel room", "hdri/hotel_room_1k.exr"),
    ("film stage", "hdri/stage_env_latlong.exr"),
];

/// A real environment; nothing where the test data is absent.
pub(super) fn real((name, file): (&'static str, &str)) -> Option<TestMap> {
    let (environment, _) = load::environment(&crate::test_data(file)?, &Limits::default()).ok()?;
    Some(TestMap::new(name, environment))
}
