//! The lights of a scene that are no surface and no environment.
//!
//! Points and spots follow `KHR_lights_punctual`: inverse square, a range beyond which there is
//! nothing (without the window that the extension leaves open), and a cone whose brightness is the
//! square of a ramp in the cosine. A distant disc has the same radiance everywhere; the camera does
//! not see it, surfaces do.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use scene::Light;

use crate::{frame::Frame, geometry::Space};

/// Below this angular radius in radians a disc counts as a point.
const POINT_RADIUS_RAD: f64 = 1e-5;

/// A light, in the tracer's space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lamp {
    Distant { direction: DVec3, irradiance: [f64; 3] },
    Disc(Disc),
    Point(Point),
}

/// A disc at infinity of constant radiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    frame: Frame,
    /// 1 - cos of the angular radius.
    height: f64,
    pub(crate) radiance: [f64; 3],
}

/// A point, which may shine into a cone only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    position: DVec3,
    intensity: [f64; 3],
    metres_per_unit: f64,
    range_m: f64,
    cone: Option<Cone>,
}

#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: DVec3,
    cos_inner: f64,
    cos_outer: f64,
}

/// Light that arrives at a point from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arriving {
    /// Unit, towards the light.
    pub(crate) direction: DVec3,
    /// In units of the tracer's space, infinite for distant lights.
    pub(crate) distance: f64,
    /// Radiance, or irradiance on a surface that faces the light where there is no density.
    pub(crate) light: [f64; 3],
    /// Density per steradian with which the direction was drawn; `None` for points.
    pub(crate) pdf: Option<f64>,
}

impl Lamp {
    /// The light, if it sends anything.
    pub(crate) fn new(light: &Light, space: &Space) -> Option<Self> {
        let metres_per_unit = 1.0 / space.units_per_metre;
        let lamp = match *light {
            Light::Directional { direction_world, irradiance, angular_diameter_rad } => {
                let direction = direction_world.as_dvec3().try_normalize()?;
                let irradiance = rgb(irradiance)?;
                let radius_rad = 0.5 * f64::from(angular_diameter_rad);
                if radius_rad < POINT_RADIUS_RAD {
                    Self::Distant { direction, irradiance }
                } else {
                    Self::Disc(Disc::new(direction, irradiance, radius_rad))
                }
            }
            Light::Point { position_world, intensity, range } => Self::Point(Point {
                position: space.tracer_from_world(position_world.as_dvec3()),
                intensity: rgb(intensity)?,
                metres_per_unit,
                range_m: f64::from(range),
                cone: None,
            }),
            Light::Spot {
                position_world,
                direction_world,
                intensity,
                range,
                inner_angle_rad,
                outer_angle_rad,
            } => Self::Point(Point {
                position: space.tracer_from_world(position_world.as_dvec3()),
                intensity: rgb(intensity)?,
                metres_per_unit,
                range_m: f64::from(range),
                cone: Some(Cone {
                    axis: direction_world.as_dvec3().try_normalize()?,
                    cos_inner: f64::from(inner_angle_rad).cos(),
                    cos_outer: f64::from(outer_angle_rad).cos(),
                }),
            }),
        };
        Some(lamp)
    }

    /// What arrives at a position, from a direction drawn by two numbers of 0..1; `None` where
    /// nothing does.
    pub(crate) fn sample(&self, position: DVec3, u: [f64; 2]) -> Option<Arriving> {
        match self {
            &Self::Distant { direction, irradiance } => {
                Some(Arriving { direction, distance: f64::INFINITY, light: irradiance, pdf: None })
            }
            Self::Disc(disc) => Some(Arriving {
                direction: disc.sample(u),
                distance: f64::INFINITY,
                light: disc.radiance,
                pdf: Some(disc.pdf()),
            }),
            Self::Point(point) => point.arriving(position),
        }
    }

    /// The disc that this light is, if it is one.
    pub(crate) fn disc(&self) -> Option<&Disc> {
        if let Self::Disc(disc) = self { Some(disc) } else { None }
    }
}

impl Disc {
    fn new(direction: DVec3, irradiance: [f64; 3], radius_rad: f64) -> Self {
        let half_sine = (0.5 * radius_rad).sin();
        let sine = radius_rad.sin();
        // The integral of the cosine over the disc is pi sin^2.
        let radiance = irradiance.map(|value| value / (PI * sine * sine));
        Self { frame: Frame::new(direction), height: 2.0 * half_sine * half_sine, radiance }
    }

    /// A direction, uniform over the disc's solid angle.
    fn sample(&self, [u, turn]: [f64; 2]) -> DVec3 {
        let below = u * self.height;
        let radius = (below * (2.0 - below)).max(0.0).sqrt();
        let (sine, cosine) = (TAU * turn).sin_cos();
        self.frame.world_from_local(DVec3::new(radius * cosine, radius * sine, 1.0 - below)).normalize()
    }

    /// The density of every direction of the disc, per steradian.
    pub(crate) fn pdf(&self) -> f64 {
        1.0 / (TAU * self.height)
    }

    /// Whether a unit direction points at the disc.
    pub(crate) fn contains(&self, direction: DVec3) -> bool {
        // 1 - cos = |difference|^2 / 2 keeps its digits for small discs.
        0.5 * (direction - self.frame.z).length_squared() <= self.height
    }
}

impl Point {
    fn arriving(&self, position: DVec3) -> Option<Arriving> {
        let to_light = self.position - position;
        let distance = to_light.length();
        let direction = to_light.try_normalize()?;
        let distance_m = distance * self.metres_per_unit;
        let in_cone = self.cone.map_or(1.0, |cone| cone.falloff(-direction));
        if distance_m > self.range_m || in_cone <= 0.0 {
            return None;
        }
        // Nearer than a tenth of a millimetre a point is no model of any light.
        let falloff = in_cone / (distance_m * distance_m).max(1e-8);
        Some(Arriving { direction, distance, light: self.intensity.map(|value| value * falloff), pdf: None })
    }
}

impl Cone {
    fn falloff(&self, direction: DVec3) -> f64 {
        let ramp = (direction.dot(self.axis) - self.cos_outer) / (self.cos_inner - self.cos_outer).max(0.001);
        ramp.clamp(0.0, 1.0).powi(2)
    }
}

/// Finite, not negative and not black, or nothing.
fn rgb(color: glam::Vec3) -> Option<[f64; 3]> {
    let color = color.to_array().map(f64::from);
    let is_light = color.iter().all(|value| (0.0..f64::INFINITY).contains(value));
    (is_light && color.iter().any(|&value| value > 0.0)).then_some(color)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        chi_squared::{Bins, Outcome, significance, test},
        random::Random,
    };

    #[test]
    fn directions_of_a_disc_are_uniform_over_it() {
        let axis = DVec3::new(0.3, -0.8, 0.5).normalize();
        let radii = [2e-5, 0.004_65, 0.1, 1.0, 1.57];
        for (run, radius) in radii.into_iter().enumerate() {
            let disc = Disc::new(axis, [1.0; 3], radius);
            let density = |direction: DVec3| if disc.contains(direction) { disc.pdf() } else { 0.0 };
            let mut random = Random::new(run as u32, 0, 1);
            let mut sample = || Some(disc.sample(random.pair()));
            // The circles are those of equal parts of the disc, and then the rest of the sphere.
            let bins = Bins::within(axis, radius, 16, 12);
            let Outcome { p_value, total } = test(&bins, &density, &mut sample, 100_000);
            println!("radius {radius}: p {p_value:.3}, total {total:.6}");
            assert!(p_value > significance(radii.len()), "{radius}: {p_value}");
            assert!((total - 1.0).abs() < 1e-3, "{radius}: {total}");
            // The integral of the cosine is the irradiance that was asked for.
            let mean = (0..20_000).map(|_| disc.sample(random.pair()).dot(axis)).sum::<f64>() / 20_000.0;
            let irradiance = disc.radiance[0] * mean / disc.pdf();
            assert!((irradiance - 1.0).abs() < 0.02, "{radius}: {irradiance}");
        }
    }
}
