//! What a person tunes.

/// Settings of diffuse-envmap. Changing them never rebuilds a pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Which of the two methods lights the surface.
    pub method: Method,
    /// How the lobe's axis goes from the mirror direction to the normal.
    pub base: Base,
    /// What happens to the part of a lobe that dips below the surface.
    pub horizon: Horizon,
    /// Added to every roughness, -1..1. 0 leaves the materials as they are; 1 makes all diffuse.
    pub roughness_offset: f32,
    /// Factor on the environment's radiance, 0 (dark) upwards without unit.
    pub intensity: f32,
    /// Relative contrast inside a lobe below which one tap stands for all, 0..1. At 0 every
    /// lobe takes all taps; at 1 nearly every lobe takes one, and edges in the reflection of
    /// rough surfaces lose some of their shape. Only [`Method::Sheen`].
    pub one_tap_contrast: f32,
    /// The environment as the walls of a box instead of infinitely far away.
    pub parallax: Option<ParallaxBox>,
}

/// The two faces of the technique.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// As published: rays by eqs. 1 to 4 into the unfiltered map.
    Paper {
        /// Rays a pixel, 1..=4096. Few are noisy, many are slow.
        rays: u32,
        /// How the angle from the axis is distributed.
        distribution: Distribution,
        /// Whether each pixel turns the pattern (noise) or all share it (ghost images).
        rotate: bool,
    },
    /// A filtered chain, at most seven fitted taps, bright sources in closed form, harmonics.
    Sheen,
}

/// How the paper's method spreads rays over the hemisphere before eq. 4 narrows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// theta = acos sqrt(1 - xi): the ideal diffuse surface at t = 1.
    Cosine,
    /// theta uniform in 0 .. pi/2.
    UniformAngle,
}

/// How eq. 3 blends mirror direction and normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// Linearly, then normalised: the paper's.
    Lerp,
    /// By equal angles; no lobe dips below the horizon.
    Slerp,
}

/// What happens to directions below the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Horizon {
    /// They count as any other.
    Keep,
    /// They are left out, and the rest is renormalised.
    Discard,
}

/// An axis-aligned box in world space, as which the environment is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxBox {
    /// Least corner in metres.
    pub min_world: [f32; 3],
    /// Greatest corner in metres.
    pub max_world: [f32; 3],
    /// Where the environment was captured, inside the box, in metres.
    pub centre_world: [f32; 3],
}

impl Settings {
    /// The published method with 64 rays.
    pub const PAPER: Self = Self {
        method: Method::Paper { rays: 64, distribution: Distribution::Cosine, rotate: false },
        base: Base::Lerp,
        horizon: Horizon::Discard,
        roughness_offset: 0.0,
        intensity: 1.0,
        one_tap_contrast: 0.0,
        parallax: None,
    };
    /// The better method, for real-time use.
    pub const SHEEN: Self = Self { method: Method::Sheen, one_tap_contrast: 0.04, ..Self::PAPER };
    /// The better method with every tap for every lobe.
    pub const SHEEN_FULL: Self = Self { method: Method::Sheen, one_tap_contrast: 0.0, ..Self::PAPER };
}

impl Default for Settings {
    fn default() -> Self {
        Self::SHEEN
    }
}
