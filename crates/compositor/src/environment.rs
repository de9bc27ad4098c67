//! The environment as a texture.

use crate::{Error, textures::all_of};
use gpu_context::{Gpu, upload};
use scene::{Environment, Warning};
use std::sync::atomic::{AtomicU64, Ordering};

/// The largest finite half float.
const HALF_MAX: f32 = 65504.0;
/// The largest radiance that is taken in full floats, with room for sums.
const FULL_MAX: f32 = 1e9;

/// An environment on the GPU.
#[derive(Debug)]
pub struct EnvironmentGpu {
    /// Radiance without the intensity, latitude-longitude, one level: `Rgba16Float`, or
    /// `Rgba32Float` for values above 65504.
    pub view: wgpu::TextureView,
    /// Texels per row, and rows.
    pub size: [u32; 2],
    /// Differs between any two uploads of the process.
    pub revision: u64,
    /// Factor on every texel, 0 or above.
    pub intensity: f32,
    /// Turn about +Y in radians: world = rotate(rotation) * own.
    pub rotation_rad: f32,
}

impl EnvironmentGpu {
    /// Uploads an environment, and says what had to be changed. Half floats hold it where they can;
    /// a brighter one takes full floats where the device filters them, and is clamped elsewhere.
    pub(crate) fn new(gpu: &Gpu, environment: &Environment) -> Result<(Self, Option<Warning>), Error> {
        let (name, size) = (&environment.name, [environment.width, environment.height]);
        let is_brighter = environment.pixels.iter().flatten().any(|&value| value > HALF_MAX);
        let filters_full = gpu.device().features().contains(wgpu::Features::FLOAT32_FILTERABLE);
        let largest = if is_brighter && filters_full { FULL_MAX } else { HALF_MAX };
        let mut changed = 0_usize;
        let mut radiance = |value: f32| {
            changed += usize::from(!(0.0..=largest).contains(&value));
            if value > 0.0 { value.min(largest) } else { 0.0 }
        };
        let texels: Vec<[f32; 4]> = environment
            .pixels
            .iter()
            .map(|&[r, g, b]| [radiance(r), radiance(g), radiance(b), 1.0])
            .collect();
        let texture = if is_brighter && filters_full {
            let bytes = bytemuck::cast_slice(&texels);
            upload::texture_2d(gpu, name, size[0], size[1], wgpu::TextureFormat::Rgba32Float, bytes, None)?
        } else {
            upload::rgba16_float(gpu, name, size[0], size[1], &texels, None)?
        };
        let warning = (changed > 0).then(|| Warning {
            file: name.clone(),
            place: "pixels".into(),
            message: format!("{changed} values outside 0 .. {largest} were clamped to it on the GPU"),
        });
        let mut environment_gpu = Self {
            view: all_of(&texture),
            size,
            revision: next_revision(),
            intensity: 0.0,
            rotation_rad: 0.0,
        };
        environment_gpu.place(environment.intensity, environment.rotation_rad);
        Ok((environment_gpu, warning))
    }

    /// Changes the intensity and the turn; values that are not finite become 0.
    pub(crate) fn place(&mut self, intensity: f32, rotation_rad: f32) {
        self.intensity = if intensity > 0.0 { intensity.min(HALF_MAX) } else { 0.0 };
        self.rotation_rad = if rotation_rad.is_finite() { rotation_rad } else { 0.0 };
    }
}

/// A number that differs between any two calls of the process.
pub(crate) fn next_revision() -> u64 {
    static REVISION: AtomicU64 = AtomicU64::new(1);
    REVISION.fetch_add(1, Ordering::Relaxed)
}
