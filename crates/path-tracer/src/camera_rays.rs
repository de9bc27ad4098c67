//! Rays from the eye through the pixels.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};
use scene::Camera;

use crate::{Error, PixelFilter, Settings, random::Random};

/// The rays of one picture.
#[derive(Clone, Debug)]
pub(crate) struct CameraRays {
    pub(crate) eye_world: DVec3,
    world_from_view: DMat3,
    size: DVec2,
    tan_half_fov_y: f64,
    filter: PixelFilter,
}

impl CameraRays {
    /// An error where the camera has numbers that are not finite or no field of view.
    pub(crate) fn new(camera: &Camera, settings: &Settings) -> Result<Self, Error> {
        let world_from_view = camera.world_from_view().as_dmat4();
        let fov_y_rad = f64::from(camera.fov_y_rad);
        let is_finite = camera.eye.is_finite() && camera.target.is_finite() && world_from_view.is_finite();
        if !(is_finite && fov_y_rad > 0.0 && fov_y_rad < std::f64::consts::PI) {
            let expected = "finite vectors and a field of view between 0 and pi";
            return Err(Error::new("camera", "camera", format!("{camera:?}"), expected));
        }
        Ok(Self {
            eye_world: camera.eye.as_dvec3(),
            world_from_view: DMat3::from_mat4(world_from_view),
            size: DVec2::from_array(settings.size.map(f64::from)),
            tan_half_fov_y: (0.5 * fov_y_rad).tan(),
            filter: settings.pixel_filter,
        })
    }

    /// A unit direction in world space through a pixel (column, row), chosen by the pixel filter.
    pub(crate) fn direction_world(&self, pixel: [u32; 2], random: &mut Random) -> DVec3 {
        let center = DVec2::from_array(pixel.map(|index| f64::from(index) + 0.5));
        let ndc = (center + self.filter.offset(random)) / self.size * 2.0 - 1.0;
        let view = DVec3::new(
            ndc.x * self.tan_half_fov_y * self.size.x / self.size.y,
            -ndc.y * self.tan_half_fov_y,
            -1.0,
        );
        (self.world_from_view * view).normalize()
    }
}

impl PixelFilter {
    /// A distance from the pixel's centre in pixels, drawn in proportion to the filter.
    fn offset(self, random: &mut Random) -> DVec2 {
        match self {
            Self::Point => DVec2::ZERO,
            Self::Box => DVec2::from_array(random.pair()) - 0.5,
            Self::Gaussian { sigma_pixels } => {
                // Box and Muller 1958; 1 - u is never 0.
                let [u, turn] = random.pair();
                let radius = f64::from(sigma_pixels) * (-2.0 * (1.0 - u).ln()).sqrt();
                DVec2::from_angle(TAU * turn) * radius
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_squared::{p_value, significance};
    use glam::Vec3;

    /// Where a direction meets the picture, in pixels.
    fn place(rays: &CameraRays, direction: DVec3) -> DVec2 {
        let view = rays.world_from_view.transpose() * direction;
        let tan = DVec2::new(view.x, -view.y) / -view.z;
        let half = DVec2::new(rays.size.x / rays.size.y, 1.0) * rays.tan_half_fov_y;
        (tan / half + 1.0) * 0.5 * rays.size
    }

    fn rays(filter: PixelFilter) -> CameraRays {
        let camera =
            Camera { eye: Vec3::new(1.0, 2.0, 3.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.9 };
        let settings = Settings { pixel_filter: filter, ..Settings::new([32, 16], 1) };
        CameraRays::new(&camera, &settings).unwrap()
    }

    /// The chance that a normal number is below x, by Simpson's rule.
    fn normal_below(x: f64) -> f64 {
        const STEPS: u32 = 2000;
        let density = |x: f64| (-0.5 * x * x).exp() / TAU.sqrt();
        let step = (x + 10.0) / f64::from(STEPS);
        let weight = |index: u32| match index {
            0 | STEPS => 1.0,
            index if index % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=STEPS).map(|index| weight(index) * density(f64::from(index) * step - 10.0)).sum::<f64>() * step
            / 3.0
    }

    #[test]
    fn samples_lie_in_a_pixel_as_its_filter_says() {
        const COUNT: u32 = 100_000;
        const SIDE: usize = 20;
        let uniform = |x: f64| (x + 0.5).clamp(0.0, 1.0);
        let normal = |x: f64| normal_below(x / 0.5);
        let wide = PixelFilter::Gaussian { sigma_pixels: 0.5 };
        let filters: [(PixelFilter, &dyn Fn(f64) -> f64); 2] =
            [(PixelFilter::Box, &uniform), (wide, &normal)];
        for (filter, below) in filters {
            let rays = rays(filter);
            let pixel = [5, 11];
            let mut found = vec![0.0; SIDE * SIDE];
            // Tenths of a pixel; those outside are counted at the border.
            let bin = |x: f64| ((x * 10.0 + 10.0).clamp(0.0, SIDE as f64 - 1.0)) as usize;
            for sample in 0..COUNT {
                let direction = rays.direction_world(pixel, &mut Random::new(0, sample, 0));
                let offset = place(&rays, direction) - DVec2::new(5.5, 11.5);
                found[bin(offset.y) * SIDE + bin(offset.x)] += 1.0;
            }
            let edge = |index: usize| match index {
                0 => 0.0,
                SIDE => 1.0,
                index => below(index as f64 / 10.0 - 1.0),
            };
            let mass = |index: usize| edge(index + 1) - edge(index);
            let expected: Vec<f64> = (0..SIDE * SIDE)
                .map(|index| f64::from(COUNT) * mass(index / SIDE) * mass(index % SIDE))
                .collect();
            let p = p_value(&found, &expected);
            println!("{filter:?}: p {p:.3}");
            assert!(p > significance(2), "{filter:?}: {p}");
        }
    }

    #[test]
    fn points_of_a_picture_lie_at_the_pixels_centres() {
        let rays = rays(PixelFilter::Point);
        for pixel in [[0, 0], [31, 15], [16, 8]] {
            let direction = rays.direction_world(pixel, &mut Random::new(0, 0, 0));
            let expected = DVec2::from_array(pixel.map(|index| f64::from(index) + 0.5));
            // The camera's axes are f32.
            assert!((place(&rays, direction) - expected).length() < 1e-5, "{pixel:?}");
        }
    }
}
