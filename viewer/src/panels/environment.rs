//! What lights the scene from all around.

use super::{path_field, warnings, work};
use crate::{
    inputs::{EnvironmentSource, Inputs},
    state::State,
};
use eframe::egui::{Slider, Ui};
use scene::builtin;

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    let mut chosen = None;
    match &state.scene.environment {
        Some(environment) => {
            ui.strong(&environment.name);
            ui.weak(format!("{} x {} texels", environment.width, environment.height));
        }
        None => {
            ui.weak("none");
        }
    }
    ui.horizontal_wrapped(|ui| {
        for name in builtin::ENVIRONMENT_NAMES {
            if ui.button(name).clicked() {
                chosen = Some(EnvironmentSource::BuiltIn(name));
            }
        }
        if ui.button("none").clicked() {
            chosen = Some(EnvironmentSource::None);
        }
    });
    if let Some(path) = path_field(ui, &mut state.typed_environment, ".hdr or .exr file, or drop one") {
        chosen = Some(EnvironmentSource::File(path));
    }
    if let Some(environment) = &mut state.scene.environment {
        let mut degrees = environment.rotation_rad.to_degrees();
        if ui.add(Slider::new(&mut degrees, -180.0..=180.0).suffix("°").text("rotation")).changed() {
            environment.rotation_rad = degrees.to_radians();
        }
        ui.add(Slider::new(&mut environment.intensity, 0.0..=100.0).logarithmic(true).text("intensity"));
    }
    ui.checkbox(&mut state.background, "Show behind the scene");
    warnings(ui, "environment warnings", &state.environment_warnings);
    work(ui, state, "background");
    if let Some(source) = chosen {
        state.requests.push(Inputs { scene: None, environment: Some(source) });
    }
}
