//! The panels at the side, one file each. A technique adds its file and one line here.

mod diffuse_envmap;
mod environment;
mod horizon_shadow;
mod reference;
mod scene;
mod sun;
mod view;

use crate::state::State;
use eframe::egui::{self, Ui};

/// A titled part of the side panel.
struct Panel {
    title: &'static str,
    show: fn(&mut Ui, &mut State),
}

/// From top to bottom.
const PANELS: [Panel; 7] = [
    Panel { title: "Scene", show: scene::show },
    Panel { title: "Environment", show: environment::show },
    Panel { title: "Sun", show: sun::show },
    Panel { title: "diffuse-envmap", show: diffuse_envmap::show },
    Panel { title: "horizon-shadow", show: horizon_shadow::show },
    Panel { title: "View", show: view::show },
    Panel { title: "Reference", show: reference::show },
];

/// All panels.
pub(crate) fn show_all(ui: &mut Ui, state: &mut State) {
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        for panel in &PANELS {
            egui::CollapsingHeader::new(panel.title)
                .default_open(true)
                .show(ui, |ui| (panel.show)(ui, state));
            ui.separator();
        }
    });
}

/// What a pass of the last picture did, or why it did nothing, and its time on the GPU.
fn work(ui: &mut Ui, state: &State, pass: &str) {
    let Some(work) = state.work.get(pass) else { return };
    let time_ms = state.timings.iter().find(|timing| timing.label == pass).and_then(|timing| timing.time_ms);
    let passes = if work.passes == 1 { "1 pass".to_owned() } else { format!("{} passes", work.passes) };
    let text = match (work.passes, work.skipped, time_ms) {
        (0, Some(skip), _) => format!("skipped: {skip}"),
        (_, Some(skip), Some(time_ms)) => format!("{passes}, {time_ms:.2} ms; skipped: {skip}"),
        (_, Some(skip), None) => format!("{passes}; skipped: {skip}"),
        (_, None, Some(time_ms)) => format!("{passes}, {time_ms:.2} ms"),
        (_, None, None) => passes,
    };
    ui.add(egui::Label::new(egui::RichText::new(text).weak()).wrap());
}

/// A field for a path; the path when it is entered.
fn path_field(ui: &mut Ui, text: &mut String, hint: &str) -> Option<std::path::PathBuf> {
    let entered = ui.horizontal(|ui| {
        let is_clicked = ui.button("Open").clicked();
        let field = ui.add(egui::TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY));
        is_clicked || (field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)))
    });
    let path = text.trim();
    (entered.inner && !path.is_empty()).then(|| path.into())
}

/// Warnings of a file, folded away.
fn warnings(ui: &mut Ui, id: &str, warnings: &[::scene::Warning]) {
    if warnings.is_empty() {
        return;
    }
    let title = format!("{} {}", warnings.len(), if warnings.len() == 1 { "warning" } else { "warnings" });
    let title = egui::RichText::new(title).color(ui.visuals().warn_fg_color);
    egui::CollapsingHeader::new(title).id_salt(id).show(ui, |ui| {
        for warning in warnings {
            ui.add(egui::Label::new(warning.to_string()).wrap());
        }
    });
}
