//! How height maps cast shadows.

use super::work;
use crate::state::State;
use compositor::ShadowMapSettings;
use eframe::egui::{ComboBox, Label, ProgressBar, RichText, Slider, Ui};
use horizon_shadow::{Method, Precision, Progress, Search, Settings, Tables};

/// From none to the most exact.
const METHODS: [(Method, &str); 7] = [
    (Method::None, "none"),
    (Method::Flat, "flat horizon map"),
    (Method::Paper, "paper"),
    (Method::Exact, "exact, one candidate"),
    (Method::Sheen, "Sheen"),
    (Method::Certified, "Sheen, certified"),
    (Method::Marched, "marched"),
];

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    ui.checkbox(&mut state.horizon_shadow.on, "Height maps cast shadows");
    let settings = &mut state.horizon_shadow.settings;
    ui.add_enabled_ui(state.horizon_shadow.on, |ui| {
        method(ui, settings);
        match settings.method {
            Method::None => {}
            Method::Marched => {
                let steps = Slider::new(&mut settings.march_steps, 1..=1024).logarithmic(true).text("steps");
                ui.add(steps);
            }
            Method::Flat => common_tables(ui, settings),
            Method::Paper | Method::Exact => {
                common_tables(ui, settings);
                published(ui, settings);
            }
            Method::Sheen | Method::Certified => {
                common_tables(ui, settings);
                candidates(ui, settings);
            }
        }
    });
    tables(ui, state);
    work(ui, state, "horizon-shadow");
    let mut casts = state.shadow_map.is_some();
    if ui.checkbox(&mut casts, "Surfaces cast shadows on each other").changed() {
        state.shadow_map = casts.then_some(ShadowMapSettings::FINE);
    }
    work(ui, state, "shadow-map");
}

fn method(ui: &mut Ui, settings: &mut Settings) {
    let name_of = |method| METHODS.iter().find(|(known, _)| *known == method).map_or("", |(_, name)| name);
    ComboBox::from_label("method").selected_text(name_of(settings.method)).show_ui(ui, |ui| {
        for (method, name) in METHODS {
            ui.selectable_value(&mut settings.method, method, name);
        }
    });
}

/// What all tables have.
fn common_tables(ui: &mut Ui, settings: &mut Settings) {
    ui.add(Slider::new(&mut settings.azimuths, 4..=64).text("azimuths"));
    ui.add(Slider::new(&mut settings.radius_texels, 2.0..=4096.0).logarithmic(true).text("radius, texels"));
    ui.horizontal(|ui| {
        ui.label("search");
        ui.selectable_value(&mut settings.search, Search::Sweep, "sweep");
        ui.selectable_value(&mut settings.search, Search::BruteForce, "brute force");
    });
    ui.add(Slider::new(&mut settings.azimuths_per_prepare, 1..=64).text("azimuths baked a frame"));
}

/// The bake while it lasts, and the memory of its tables.
fn tables(ui: &mut Ui, state: &State) {
    let Progress { done, total } = state.horizon_progress;
    if total == 0 {
        return;
    }
    if done < total {
        let text = format!("baking azimuth {done} of {total}");
        ui.add(ProgressBar::new(done as f32 / total as f32).text(text));
    }
    let megabytes = state.horizon_memory_bytes as f64 / 1e6;
    ui.add(Label::new(RichText::new(format!("tables of {total} azimuths: {megabytes:.1} MB")).weak()));
}

/// What only the paper's tables have.
fn published(ui: &mut Ui, settings: &mut Settings) {
    ui.horizontal(|ui| {
        ui.label("tables");
        ui.selectable_value(&mut settings.tables, Tables::BetaAndDistance, "angle, distance");
        ui.selectable_value(&mut settings.tables, Tables::DistanceAndHeight, "distance");
    });
}

/// What only Sheen's tables have.
fn candidates(ui: &mut Ui, settings: &mut Settings) {
    ui.add(Slider::new(&mut settings.candidates, 1..=4).text("candidates"));
    ui.horizontal(|ui| {
        ui.label("precision");
        ui.selectable_value(&mut settings.precision, Precision::Compact, "16 bits");
        ui.selectable_value(&mut settings.precision, Precision::Full, "32 bits");
    });
    ui.checkbox(&mut settings.prefilter, "Prefilter distant bumps");
    ui.checkbox(&mut settings.tiles, "Tiles decide first");
    ui.checkbox(&mut settings.ambient, "Ambient occlusion and bent normals");
}
