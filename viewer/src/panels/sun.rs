//! The first light at infinity: where it stands, and how large it looks.

use crate::state::State;
use eframe::egui::{Label, RichText, Slider, Ui};
use glam::Vec3;
use scene::Light;

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    let sun = state.scene.lights.iter_mut().find_map(|light| match light {
        Light::Directional { direction_world, angular_diameter_rad, .. } => {
            Some((direction_world, angular_diameter_rad))
        }
        Light::Point { .. } | Light::Spot { .. } => None,
    });
    let Some((direction_world, angular_diameter_rad)) = sun else {
        ui.add(Label::new(RichText::new("the scene has no light at infinity").weak()));
        return;
    };
    let mut azimuth_deg = direction_world.z.atan2(direction_world.x).to_degrees();
    let mut elevation_deg = direction_world.y.clamp(-1.0, 1.0).asin().to_degrees();
    let mut diameter_deg = angular_diameter_rad.to_degrees();
    let turned = ui.add(Slider::new(&mut azimuth_deg, -180.0..=180.0).suffix("°").text("azimuth")).changed()
        // At the zenith the azimuth would be lost.
        | ui.add(Slider::new(&mut elevation_deg, -89.0..=89.0).suffix("°").text("elevation")).changed();
    let diameter = Slider::new(&mut diameter_deg, 0.0..=20.0).suffix("°").text("diameter (soft shadows)");
    let resized = ui.add(diameter).changed();
    if turned {
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let (sine, cosine) = elevation.sin_cos();
        *direction_world = Vec3::new(cosine * azimuth.cos(), sine, cosine * azimuth.sin());
    }
    if resized {
        *angular_diameter_rad = diameter_deg.to_radians();
    }
    state.lights_changed |= turned || resized;
}
