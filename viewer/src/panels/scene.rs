//! What is loaded.

use super::{path_field, warnings, work};
use crate::{commands::info, inputs::Inputs, state::State};
use eframe::egui::{Grid, Ui};

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    ui.strong(if state.scene.name.is_empty() { "nothing yet" } else { &state.scene.name });
    Grid::new("counts").num_columns(2).show(ui, |ui| {
        for (name, text) in info::counts(&state.scene) {
            ui.weak(name);
            ui.label(text);
            ui.end_row();
        }
    });
    warnings(ui, "scene warnings", &state.scene_warnings);
    work(ui, state, "geometry");
    if let Some(path) = path_field(ui, &mut state.typed_scene, "model or scene file, or drop one") {
        match Inputs::of_files(&[path]) {
            Ok(inputs) => state.requests.push(inputs),
            Err(message) => state.fail(&message),
        }
    }
    if ui.button("Built-in scene").clicked() {
        state.requests.push(Inputs::default());
    }
    if !state.scene.lights.is_empty() {
        ui.checkbox(&mut state.direct_light, "Lights");
        work(ui, state, "direct-light");
    }
}
