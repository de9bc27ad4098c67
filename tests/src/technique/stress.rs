//! What `stress` runs: library functions against f64 models, and scenes that try to break frames.

use super::{Failure, Make};
use compositor::wgpu;
use scene::{Camera, Scene};

/// One WGSL function (or the whole of several), run in a compute shader over extremes and random
/// inputs and compared with a model.
///
/// The harness makes a list of input vectors from [`inputs`](Self::inputs), puts
/// [`body`](Self::body) into a compute shader after the library, and compares what it writes with
/// [`model`](Self::model).
pub struct StressCase {
    /// The WGSL name of the function; a suffix in brackets tells several cases of one function
    /// apart: `sheen_angle [small]`.
    pub function: &'static str,
    /// The module whose source stands before the body.
    pub library: &'static shaders::Module,
    /// What is put in. Together they are `x`, an array of f32, in this order; a vector takes
    /// several places.
    pub inputs: Vec<Input>,
    /// WGSL statements that call the function on `x: array<f32, N>` (or on its bits, `u:
    /// array<u32, N>`) and write `y: array<f32, M>`: `y[0] = sheen_acos(x[0]);`
    pub body: &'static str,
    /// Names of the values in `y`; there are as many as names.
    pub outputs: &'static [&'static str],
    /// The same in f64: gets `x` as the shader sees it (integers as their value) and returns as
    /// many values as `outputs` has. NaN stands for "anything": outside of what the function
    /// promises. An infinity is compared as such.
    pub model: Model,
    /// How far apart the two may be.
    pub tolerance: Tolerance,
    /// Textures and buffers that the body reads: declarations for `@group(1)`, and their bindings.
    pub bindings: Option<Make<Bound>>,
    /// How many random inputs: `None` for the usual number (a million, or 32,768 when quick); fewer
    /// where the model takes milliseconds.
    pub samples: Option<usize>,
}

/// A function in f64.
pub type Model = Box<dyn Fn(&[f64]) -> Vec<f64> + Sync>;

/// How far a function may be from its model: |found - model| <= absolute + relative |model| +
/// slack(x), for every output.
pub struct Tolerance {
    /// In the output's unit.
    pub absolute: f64,
    /// As a fraction of the model's value.
    pub relative: f64,
    /// What is allowed besides, for an input on which rounding of the arguments alone moves the
    /// result.
    pub slack: Option<fn(&[f64]) -> f64>,
    /// Where these numbers come from.
    pub reason: &'static str,
}

/// What is put into one argument. `least` and `greatest` are what the function promises to take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Input {
    /// One f32 in a range. Extremes are log-spaced towards 0 and towards the ends; 0, -0, the
    /// smallest normal number, one half unit in the last place around 1 and the ends are put in
    /// where the range has them. Random ones are half uniform, half log-uniform.
    Real {
        /// Least value.
        least: f32,
        /// Greatest value.
        greatest: f32,
    },
    /// As [`Real`](Self::Real), and besides NaN, both infinities and the largest numbers, because
    /// the function promises something about them.
    Any {
        /// Least of the ordinary values.
        least: f32,
        /// Greatest of the ordinary values.
        greatest: f32,
    },
    /// A unit vector, three places: all axes, near misses of axes, both sides of every plane, and
    /// random ones uniform on the sphere; rounded to f32.
    UnitVector,
    /// A vector of any length, three places, each component log-uniform with either sign up to
    /// `greatest`, zero included.
    Vector {
        /// Largest absolute value of a component.
        greatest: f32,
    },
    /// A whole number in 0..`below`, to be read from `u`.
    Integer {
        /// One more than the greatest.
        below: u32,
    },
}

impl Input {
    /// Places in `x`.
    pub const fn width(self) -> usize {
        match self {
            Self::UnitVector | Self::Vector { .. } => 3,
            Self::Real { .. } | Self::Any { .. } | Self::Integer { .. } => 1,
        }
    }
}

/// What the body of a stress case reads besides its arguments.
pub struct Bound {
    /// WGSL declarations in `@group(1)`.
    pub declarations: String,
    /// The layout of group 1, visible to compute shaders.
    pub layout: wgpu::BindGroupLayout,
    /// The bindings.
    pub group: wgpu::BindGroup,
}

/// A library function that has no case of its own, and why.
#[derive(Clone, Copy, Debug)]
pub struct Exemption {
    /// The WGSL name.
    pub function: &'static str,
    /// What covers it instead.
    pub reason: &'static str,
}

/// A scene that tries to break whole frames.
pub struct HostileScene {
    /// Its name.
    pub name: String,
    /// What is nasty about it.
    pub why: &'static str,
    /// Makes it.
    pub scene: Box<dyn Fn() -> Result<Scene, Failure>>,
    /// From where it is seen; `None` frames the whole scene.
    pub camera: Option<Camera>,
    /// Pixels per row, and rows.
    pub size: [u32; 2],
    /// Which methods light it; every one is rendered.
    pub settings: Vec<(String, compositor::Settings)>,
    /// What should happen.
    pub expectation: Expectation,
}

/// What a hostile scene should lead to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// A picture whose every value is finite and not negative, and no error on the device.
    Picture,
    /// An error whose text contains this.
    Refusal(&'static str),
}
