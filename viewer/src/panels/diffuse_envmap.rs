//! How the environment is reflected.

use super::work;
use crate::state::State;
use diffuse_envmap::{Base, Distribution, Horizon, Method, Settings};
use eframe::egui::{Slider, Ui};

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    ui.checkbox(&mut state.diffuse_envmap.on, "Environment lights the scene");
    let settings = &mut state.diffuse_envmap.settings;
    ui.add_enabled_ui(state.diffuse_envmap.on, |ui| {
        method(ui, settings);
        ui.add(Slider::new(&mut settings.roughness_offset, -1.0..=1.0).text("roughness offset"));
        ui.horizontal(|ui| {
            ui.label("base");
            ui.selectable_value(&mut settings.base, Base::Lerp, "lerp");
            ui.selectable_value(&mut settings.base, Base::Slerp, "slerp");
        });
        ui.horizontal(|ui| {
            ui.label("below the horizon");
            ui.selectable_value(&mut settings.horizon, Horizon::Keep, "keep");
            ui.selectable_value(&mut settings.horizon, Horizon::Discard, "discard");
        });
    });
    work(ui, state, "diffuse-envmap");
}

/// Which face of the technique, and what only that face has.
fn method(ui: &mut Ui, settings: &mut Settings) {
    ui.horizontal(|ui| {
        ui.label("method");
        let is_paper = matches!(settings.method, Method::Paper { .. });
        if ui.selectable_label(!is_paper, "Sheen").clicked() {
            settings.method = Method::Sheen;
        }
        if ui.selectable_label(is_paper, "paper").clicked() && !is_paper {
            settings.method = Settings::PAPER.method;
        }
    });
    match &mut settings.method {
        Method::Sheen => {
            ui.add(Slider::new(&mut settings.one_tap_contrast, 0.0..=1.0).text("one-tap contrast"));
        }
        Method::Paper { rays, distribution, rotate } => {
            ui.add(Slider::new(rays, 1..=4096).logarithmic(true).text("rays"));
            ui.horizontal(|ui| {
                ui.label("rays spread by");
                ui.selectable_value(distribution, Distribution::Cosine, "cosine");
                ui.selectable_value(distribution, Distribution::UniformAngle, "uniform angle");
            });
            ui.checkbox(rotate, "Turn the pattern at each pixel");
        }
    }
}
