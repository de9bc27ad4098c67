//! What diffuse-envmap converges to, in f64.

use crate::Pixel;
use diffuse_envmap::{
    Base, Horizon,
    model::{self, Map, Vec3},
};
use half::f16;
use scene::Environment;

/// The largest finite half float.
const HALF_MAX: f32 = 65504.0;

/// Lobes narrower than this are summed along their own samples, wider ones over texels.
const WIDE_FROM: f64 = 0.35;

/// An environment as the technique's own integral sees it.
#[derive(Clone, Debug)]
pub struct Reference {
    map: Map,
    intensity: f64,
    rotation_rad: f64,
    fineness: usize,
}

impl Reference {
    /// An environment with its texels as half floats, as they lie on the GPU, and its rotation and
    /// intensity.
    pub fn new(environment: &Environment) -> Self {
        let half = |value: f32| f16::from_f32(value.clamp(0.0, HALF_MAX)).to_f64();
        Self {
            map: Map {
                width: environment.width as usize,
                height: environment.height as usize,
                texels: environment.pixels.iter().map(|texel| texel.map(half)).collect(),
            },
            intensity: f64::from(environment.intensity),
            rotation_rad: f64::from(environment.rotation_rad),
            fineness: 1,
        }
    }

    /// The same with four times as many samples a lobe, to learn how far the integral is off.
    pub fn finer(&self) -> Self {
        Self { fineness: 2 * self.fineness, ..self.clone() }
    }

    /// The environment's own direction of a world direction: a turn by -rotation about +Y.
    fn own(&self, [x, y, z]: Vec3) -> Vec3 {
        let (sine, cosine) = self.rotation_rad.sin_cos();
        [cosine * x - sine * z, y, sine * x + cosine * z]
    }

    /// Radiance that arrives from a unit direction of the world.
    pub fn arriving(&self, direction_world: Vec3) -> Vec3 {
        self.map.sample(self.own(direction_world)).map(|value| value * self.intensity)
    }

    /// Radiance that a pixel's surface of roughness `t` (0..=1) reflects at a reflectance of one:
    /// eqs. 1 to 4 with the linear base, without what is below the horizon.
    pub fn reflected(&self, pixel: &Pixel, t: f64) -> Vec3 {
        let normal_world = model::normalize_or(pixel.normal_world, [0.0, 1.0, 0.0]);
        let mirror = model::mirror(pixel.view_world, normal_world);
        if t <= 0.0 {
            return self.arriving(mirror);
        }
        let axis = self.own(model::base(mirror, normal_world, t, Base::Lerp));
        let normal = self.own(normal_world);
        let mean = if t < WIDE_FROM {
            // Rings and spokes in proportion to the lobe's width in texels.
            let rings = (300.0 * t).clamp(24.0, 96.0) as usize * self.fineness;
            model::integrate_over_lobe(&self.map, axis, normal, t, Horizon::Discard, rings, 2 * rings)
        } else {
            model::integrate_over_texels(&self.map, axis, normal, t, Horizon::Discard, 2 * self.fineness)
        };
        mean.map(|value| value * self.intensity)
    }
}

/// The share of light that a specular surface of reflectance `ks` at normal incidence reflects in
/// all (Karis 2014, "Physically based shading on mobile"), for ks above 0.02.
pub fn specular_reflectance(ks: f64, roughness: f64, n_dot_v: f64) -> f64 {
    let along = |slope: f64, start: f64| slope * roughness + start;
    let (rx, ry) = (along(-1.0, 1.0), along(-0.0275, 0.0425));
    let (rz, rw) = (along(-0.572, 1.04), along(0.022, -0.04));
    let a = (rx * rx).min((-9.28 * n_dot_v).exp2()) * rx + ry;
    (ks * (rz - 1.04 * a) + rw + 1.04 * a).clamp(0.0, 1.0)
}
