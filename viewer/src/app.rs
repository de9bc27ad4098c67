//! The window: panels at the side, the picture in the middle.

use crate::{
    drawing::Drawing,
    inputs::{self, EnvironmentSource, Inputs},
    loader::{Loaded, Loader},
    orbit::Orbit,
    panels,
    path_tracing::PathTracing,
    state::State,
};
use compositor::{SceneGpu, Settings};
use eframe::egui::{
    self, Color32, Event, EventFilter, Key, PointerButton, Rect, Response, Sense, Stroke, Ui,
};
use scene::{Environment, Scene, Warning};
use std::time::Duration;

/// Radians by which the camera turns per point that the pointer moves.
const TURN_RAD_PER_POINT: f32 = 0.007;
/// Radians by which the camera turns, share of the height by which it moves, and share of the
/// distance by which it comes nearer, per key press.
const KEY_STEP: f32 = 0.08;
/// How often finished GPU times are asked for, while some are missing.
const TIMES_INTERVAL: Duration = Duration::from_millis(50);
/// The line between the picture and its reference.
const SPLIT_STROKE: Stroke = Stroke { width: 1.0, color: Color32::WHITE };

/// What the window consists of.
pub(crate) struct App {
    state: State,
    drawing: Drawing,
    loader: Loader,
    path_tracing: PathTracing,
    /// Whether a scene was ever shown.
    has_scene: bool,
}

impl App {
    /// Starts to load the inputs.
    pub(crate) fn new(
        context: &eframe::CreationContext<'_>,
        inputs: Inputs,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let host = context.wgpu_render_state.as_ref().ok_or("the window has no graphics device")?;
        context.egui_ctx.set_theme(egui::Theme::Dark);
        // The faint text of the standard style is hard to read on its dark ground.
        context
            .egui_ctx
            .all_styles_mut(|style| style.visuals.weak_text_color = Some(Color32::from_gray(170)));
        let drawing = Drawing::new(host)?;
        let loader = Loader::new(drawing.gpu().clone(), context.egui_ctx.clone())?;
        let path_tracing = PathTracing::new(context.egui_ctx.clone())?;
        let mut state = State::new(drawing.gpu().adapter_label());
        let scene = inputs.scene.or_else(|| Some(inputs::BUILT_IN_SCENE.into()));
        state.requests.push(Inputs { scene, ..inputs });
        Ok(Self { state, drawing, loader, path_tracing, has_scene: false })
    }

    /// Takes over what the loader has finished.
    fn take_loaded(&mut self) {
        while let Some(loaded) = self.loader.finished() {
            match loaded {
                Loaded::Scene { scene, uploaded, settings } => self.set_scene(*scene, *uploaded, settings),
                Loaded::Environment { environment, warnings } => self.set_environment(environment, warnings),
                Loaded::Failure(message) => {
                    self.state.fail(&message);
                    if !self.has_scene {
                        self.has_scene = true;
                        self.state.requests.push(Inputs::default());
                    }
                }
            }
        }
    }

    /// Shows another scene, under the present environment where it has none of its own.
    fn set_scene(&mut self, mut scene: Scene, uploaded: SceneGpu, settings: Option<Settings>) {
        self.state.scene_warnings = [&scene.warnings, uploaded.warnings()].concat();
        self.drawing.set_scene(uploaded);
        if scene.environment.is_some() {
            self.state.environment_warnings.clear();
        } else {
            scene.environment = self.state.scene.environment.take();
            if let Err(error) = self.drawing.set_environment(scene.environment.as_ref()) {
                self.state.fail(&error);
            }
        }
        if !self.has_scene && inputs::is_unlit(&scene) {
            let environment = Some(EnvironmentSource::BuiltIn(inputs::DEFAULT_ENVIRONMENT));
            self.state.requests.push(Inputs { scene: None, environment });
        }
        self.has_scene = true;
        self.state.scene = scene;
        self.state.scene_version += 1;
        self.state.camera = Orbit::of_camera(&self.state.home_camera());
        if let Some(settings) = settings {
            self.state.set_techniques(&settings);
        }
    }

    fn set_environment(&mut self, environment: Option<Environment>, warnings: Vec<Warning>) {
        let known = self.drawing.scene().warnings().len();
        match self.drawing.set_environment(environment.as_ref()) {
            Ok(()) => {
                self.state.scene.environment = environment;
                self.state.scene_version += 1;
                self.state.environment_warnings = warnings;
                let new = self.drawing.scene().warnings().iter().skip(known).cloned();
                self.state.environment_warnings.extend(new);
            }
            Err(error) => self.state.fail(&error),
        }
    }

    /// Uploads lights that a panel has changed.
    fn take_lights(&mut self) {
        if std::mem::take(&mut self.state.lights_changed) {
            self.state.scene_version += 1;
            if let Err(error) = self.drawing.set_lights(&self.state.scene.lights) {
                self.state.fail(&error);
            }
        }
    }

    /// Asks for the files that were dropped onto the window.
    fn take_dropped_files(&mut self, context: &egui::Context) {
        let files: Vec<_> = context
            .input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect());
        if files.is_empty() {
            return;
        }
        match Inputs::of_files(&files) {
            Ok(inputs) => self.state.requests.push(inputs),
            Err(message) => self.state.fail(&message),
        }
    }

    /// The picture, and the camera's controls on it.
    fn picture(&mut self, ui: &mut Ui) {
        let pixels_per_point = ui.ctx().pixels_per_point();
        let rect = ui.max_rect();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
        let limit = self.drawing.gpu().device().limits().max_texture_dimension_2d;
        let size = [rect.width(), rect.height()]
            .map(|points| ((points * pixels_per_point).round() as u32).clamp(1, limit));
        self.state.aspect = size[0] as f32 / size[1] as f32;
        point_camera(&mut self.state, ui, &response);
        press_camera(&mut self.state, ui, &response);

        match self.drawing.show(&mut self.state, size) {
            Ok((id, rest)) => {
                if let Some(rest) = rest {
                    ui.ctx().request_repaint_after(rest);
                }
                let Some(id) = id else { return };
                let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
                let pixels = egui::vec2(size[0] as f32, size[1] as f32) / pixels_per_point;
                ui.painter().image(id, Rect::from_min_size(rect.min, pixels), whole, Color32::WHITE);
            }
            Err(error) => self.state.fail(&error),
        }
        self.reference(ui, rect, size);
        if response.has_focus() {
            let stroke = ui.visuals().selection.stroke;
            ui.painter().rect_stroke(rect, 0.0, stroke, egui::StrokeKind::Inside);
        }
        let is_dropping = ui.input(|input| !input.raw.hovered_files.is_empty());
        let message = match self.loader.current() {
            _ if is_dropping => Some("Drop a scene or an environment map".to_owned()),
            current => current.map(|name| format!("Loading {name} ...")),
        };
        if let Some(message) = message {
            banner(ui, rect, &message);
        }
    }

    /// The reference over the right part of the picture, where there is one.
    fn reference(&mut self, ui: &Ui, rect: Rect, size: [u32; 2]) {
        let (id, rest) = self.path_tracing.show(ui.ctx(), &mut self.state, size);
        if let Some(rest) = rest {
            ui.ctx().request_repaint_after(rest);
        }
        let Some(id) = id else { return };
        let split = self.state.reference.split.clamp(0.0, 1.0);
        let x = rect.left() + split * rect.width();
        let part = Rect::from_min_max(egui::pos2(x, rect.top()), rect.max);
        let texture_part = Rect::from_min_max(egui::pos2(split, 0.0), egui::pos2(1.0, 1.0));
        ui.painter().image(id, part, texture_part, Color32::WHITE);
        ui.painter().vline(x, rect.y_range(), SPLIT_STROKE);
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.take_dropped_files(ui.ctx());
        self.take_loaded();
        egui::Panel::right("panels").default_size(300.0).show(ui, |ui| panels::show_all(ui, &mut self.state));
        self.take_lights();
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.picture(ui));
        for error in self.drawing.gpu().take_errors() {
            self.state.fail(&error);
        }
        show_errors(ui.ctx(), &mut self.state.errors);
        for request in self.state.requests.drain(..) {
            self.loader.request(request);
            ui.ctx().request_repaint();
        }
        if self.drawing.collect_times(&mut self.state) {
            ui.ctx().request_repaint_after(TIMES_INTERVAL);
        }
    }
}

/// Left button turns, right or middle button moves, wheel or pinch comes nearer, double-click shows
/// everything.
fn point_camera(state: &mut State, ui: &Ui, response: &Response) {
    let delta = response.drag_delta();
    let (is_shifted, scroll, pinch) =
        ui.input(|input| (input.modifiers.shift, input.smooth_scroll_delta().y, input.zoom_delta()));
    if response.dragged_by(PointerButton::Primary) && !is_shifted {
        state.camera.turn(-delta.x * TURN_RAD_PER_POINT, delta.y * TURN_RAD_PER_POINT);
    } else if response.dragged() {
        let height = response.rect.height().max(1.0);
        state.camera.pan(-delta.x / height, delta.y / height);
    }
    if response.hovered() {
        state.camera.zoom((-0.003 * scroll).exp() / pinch, state.radius_m());
    }
    if response.double_clicked() {
        state.frame_scene();
    }
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
}

/// Arrows turn, with shift they move, plus and minus come nearer, F shows everything, Home goes
/// back; while the picture has the focus or nothing has.
fn press_camera(state: &mut State, ui: &Ui, response: &Response) {
    if response.has_focus() {
        let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    } else if ui.memory(|memory| memory.focused().is_some()) {
        return;
    }
    let presses: Vec<_> = ui.input(|input| {
        let press = |event: &Event| match *event {
            Event::Key { key, pressed: true, modifiers, .. } if !modifiers.command => {
                Some((key, modifiers.shift))
            }
            _ => None,
        };
        input.events.iter().filter_map(press).collect()
    });
    for (key, is_shifted) in presses {
        let (right, up) = match key {
            Key::ArrowLeft => (-KEY_STEP, 0.0),
            Key::ArrowRight => (KEY_STEP, 0.0),
            Key::ArrowUp => (0.0, KEY_STEP),
            Key::ArrowDown => (0.0, -KEY_STEP),
            _ => (0.0, 0.0),
        };
        match key {
            Key::Plus | Key::Equals => state.camera.zoom(1.0 - KEY_STEP, state.radius_m()),
            Key::Minus => state.camera.zoom(1.0 / (1.0 - KEY_STEP), state.radius_m()),
            Key::F => state.frame_scene(),
            Key::Home => state.camera = Orbit::of_camera(&state.home_camera()),
            _ if is_shifted => state.camera.pan(right, up),
            _ => state.camera.turn(right, up),
        }
    }
}

/// A line of text over the picture.
fn banner(ui: &Ui, rect: Rect, message: &str) {
    let font = egui::TextStyle::Heading.resolve(ui.style());
    let text = ui.painter().layout(message.to_owned(), font, Color32::WHITE, rect.width() - 40.0);
    let box_rect = Rect::from_center_size(rect.center(), text.size() + egui::vec2(24.0, 16.0));
    ui.painter().rect_filled(box_rect, 6.0, Color32::from_black_alpha(200));
    ui.painter().galley(box_rect.min + egui::vec2(12.0, 8.0), text, Color32::WHITE);
}

/// The failures, until they are dismissed.
fn show_errors(context: &egui::Context, errors: &mut Vec<String>) {
    if errors.is_empty() {
        return;
    }
    let mut is_open = true;
    let mut dismissed = context.input(|input| input.key_pressed(Key::Escape));
    egui::Window::new("This did not work")
        .open(&mut is_open)
        .collapsible(false)
        .default_width(520.0)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(context.content_rect().center())
        .show(context, |ui| {
            egui::ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
                for error in errors.iter() {
                    ui.add(egui::Label::new(error).selectable(true).wrap());
                    ui.add_space(6.0);
                }
            });
            dismissed |= ui.button("Dismiss").clicked();
        });
    if dismissed || !is_open {
        errors.clear();
    }
}
