//! The path-traced truth beside the picture.

use crate::path_tracing::{Light, Status};
use crate::state::State;
use eframe::egui::{ComboBox, Label, RichText, Slider, Ui};

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    let reference = &mut state.reference;
    ui.checkbox(&mut reference.on, "Path trace this view");
    if !reference.on {
        return;
    }
    ui.add(Slider::new(&mut reference.split, 0.0..=1.0).show_value(false).text("split (truth on the right)"));
    ui.add(Slider::new(&mut reference.samples, 1..=65536).logarithmic(true).text("samples a pixel"));
    ComboBox::from_label("truth").selected_text(name(reference.light)).show_ui(ui, |ui| {
        for light in [Light::Transport, Light::FarField] {
            ui.selectable_value(&mut reference.light, light, name(light));
        }
    });
    let text = state.reference_status.map_or_else(|| "tracing ...".to_owned(), describe);
    ui.add(Label::new(RichText::new(text).weak()).wrap());
}

fn name(light: Light) -> &'static str {
    match light {
        Light::Transport => "all light transport",
        Light::FarField => "far field, diffuse-envmap's lobe",
    }
}

fn describe(Status { samples, noise, remaining }: Status) -> String {
    let noise = noise.map_or_else(String::new, |noise| format!(", noise {:.2} %", 100.0 * noise));
    let left = remaining.as_secs();
    let left = if left == 0 { String::new() } else { format!(", {}:{:02} left", left / 60, left % 60) };
    format!("{samples} samples a pixel{noise}{left}")
}
