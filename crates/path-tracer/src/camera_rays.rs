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
