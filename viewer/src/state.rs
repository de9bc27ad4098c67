//! Everything that the window shows and that its panels change.

use crate::{
    inputs::Inputs,
    orbit::Orbit,
    path_tracing::{Reference, Status},
};
use compositor::{FrameWork, Settings, ShadowMapSettings, ToneCurve};
use gpu_context::Timing;
use scene::{Camera, Scene, Warning};

/// Width over height of the pictures that scene files are made for.
const USUAL_ASPECT: f32 = 16.0 / 9.0;

/// The window's state. Panels read and change it; the picture follows.
pub(crate) struct State {
    /// What is shown; `scene.environment` is the one that lights it, whatever it came from.
    pub(crate) scene: Scene,
    /// Counts the scenes and environments that were shown.
    pub(crate) scene_version: u64,
    /// What was noticed when the scene, and when its environment was loaded and uploaded.
    pub(crate) scene_warnings: Vec<Warning>,
    pub(crate) environment_warnings: Vec<Warning>,
    /// The scene's lights were changed and are not uploaded yet.
    pub(crate) lights_changed: bool,
    pub(crate) camera: Orbit,
    /// Width over height of the picture.
    pub(crate) aspect: f32,
    pub(crate) exposure_ev: f32,
    pub(crate) tone_curve: ToneCurve,
    pub(crate) background: bool,
    pub(crate) direct_light: bool,
    pub(crate) diffuse_envmap: Switched<diffuse_envmap::Settings>,
    pub(crate) horizon_shadow: Switched<horizon_shadow::Settings>,
    pub(crate) shadow_map: Option<ShadowMapSettings>,
    pub(crate) reference: Reference,
    pub(crate) reference_status: Option<Status>,
    /// What the passes of the last picture did, and how long they took on the GPU.
    pub(crate) work: FrameWork,
    pub(crate) timings: Vec<Timing>,
    /// How far the tables of height maps are baked, and what they take.
    pub(crate) horizon_progress: horizon_shadow::Progress,
    pub(crate) horizon_memory_bytes: u64,
    /// The device, in words.
    pub(crate) adapter: String,
    /// Failures that the user has not dismissed.
    pub(crate) errors: Vec<String>,
    /// What the user asked to load, for the loader to take.
    pub(crate) requests: Vec<Inputs>,
    /// Paths as typed.
    pub(crate) typed_scene: String,
    pub(crate) typed_environment: String,
}

/// A technique that can be turned off without forgetting its settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Switched<T> {
    pub(crate) on: bool,
    pub(crate) settings: T,
}

impl<T: Copy + Default> Switched<T> {
    fn new(settings: Option<T>) -> Self {
        Self { on: settings.is_some(), settings: settings.unwrap_or_default() }
    }

    fn get(self) -> Option<T> {
        self.on.then_some(self.settings)
    }
}

impl State {
    /// Nothing loaded yet.
    pub(crate) fn new(adapter: String) -> Self {
        let Settings {
            exposure_ev,
            tone_curve,
            diffuse_envmap,
            background,
            direct_light,
            horizon_shadow,
            shadow_map,
        } = Settings::FULL;
        let scene = Scene::default();
        Self {
            camera: Orbit::of_camera(&scene.framing_camera(1.0)),
            scene,
            scene_version: 0,
            lights_changed: false,
            scene_warnings: Vec::new(),
            environment_warnings: Vec::new(),
            aspect: 1.0,
            exposure_ev,
            tone_curve,
            background,
            direct_light,
            diffuse_envmap: Switched::new(diffuse_envmap),
            horizon_shadow: Switched::new(horizon_shadow),
            shadow_map,
            reference: Reference::default(),
            reference_status: None,
            work: FrameWork::default(),
            timings: Vec::new(),
            horizon_progress: horizon_shadow::Progress::default(),
            horizon_memory_bytes: 0,
            adapter,
            errors: Vec::new(),
            requests: Vec::new(),
            typed_scene: String::new(),
            typed_environment: String::new(),
        }
    }

    /// What the compositor is to do.
    pub(crate) fn settings(&self) -> Settings {
        Settings {
            exposure_ev: self.exposure_ev,
            tone_curve: self.tone_curve,
            diffuse_envmap: self.diffuse_envmap.get(),
            horizon_shadow: self.horizon_shadow.get(),
            shadow_map: self.shadow_map,
            background: self.background,
            direct_light: self.direct_light,
        }
    }

    /// Takes over the settings of techniques that a scene file gives.
    pub(crate) fn set_techniques(&mut self, settings: &Settings) {
        self.diffuse_envmap = Switched::new(settings.diffuse_envmap);
        self.horizon_shadow = Switched::new(settings.horizon_shadow);
    }

    /// Where the scene wants to be seen from. A scene's own camera opens wider where the picture is
    /// narrower than usual, so that nothing at its sides is lost.
    pub(crate) fn home_camera(&self) -> Camera {
        let Some(camera) = self.scene.camera else { return self.scene.framing_camera(self.aspect) };
        let widening = (USUAL_ASPECT / self.aspect).max(1.0);
        Camera { fov_y_rad: 2.0 * (widening * (0.5 * camera.fov_y_rad).tan()).atan(), ..camera }
    }

    /// Half the diagonal of the scene in metres; 1 where it is empty.
    pub(crate) fn radius_m(&self) -> f32 {
        self.scene.bounds().map_or(1.0, |(least, greatest)| 0.5 * least.distance(greatest))
    }

    /// Moves the camera so that it sees the whole scene from its present side.
    pub(crate) fn frame_scene(&mut self) {
        let framing = self.scene.framing_camera(self.aspect);
        self.camera.approach(&framing);
    }

    /// Shows a failure until the user dismisses it.
    pub(crate) fn fail(&mut self, message: &impl ToString) {
        let message = message.to_string();
        if !self.errors.contains(&message) {
            self.errors.push(message);
        }
    }
}
