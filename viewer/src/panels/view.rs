//! From where and how brightly the scene is seen.

use crate::{orbit::Orbit, state::State};
use compositor::ToneCurve;
use eframe::egui::{ComboBox, Label, RichText, Slider, Ui};

pub(super) fn show(ui: &mut Ui, state: &mut State) {
    ui.add(Slider::new(&mut state.exposure_ev, -10.0..=10.0).suffix(" EV").text("exposure"));
    ComboBox::from_label("tone curve").selected_text(state.tone_curve.name()).show_ui(ui, |ui| {
        for curve in ToneCurve::ALL {
            ui.selectable_value(&mut state.tone_curve, curve, curve.name());
        }
    });
    ui.horizontal(|ui| {
        if ui.button("Frame (F)").clicked() {
            state.frame_scene();
        }
        if ui.button("Reset camera (Home)").clicked() {
            state.camera = Orbit::of_camera(&state.home_camera());
        }
    });
    let help = "Drag to turn, right-drag to move, wheel to come nearer; or arrows, shift and arrows, plus and minus.";
    ui.add(Label::new(RichText::new(help).weak()).wrap());
    ui.add(Label::new(RichText::new(&state.adapter).weak()).wrap());
}
