//! Files are read, and scenes uploaded, on a thread of their own, in the order asked for.

use crate::{inputs::Inputs, settings};
use compositor::{SceneGpu, Settings};
use eframe::egui;
use gpu_context::Gpu;
use scene::{Environment, Scene, Warning};
use std::collections::VecDeque;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;

/// What came of a request.
pub(crate) enum Loaded {
    /// Another scene, and its settings of techniques where its file gives any.
    Scene { scene: Box<Scene>, uploaded: Box<SceneGpu>, settings: Option<Settings> },
    /// Another environment for the present scene; `None` for darkness.
    Environment { environment: Option<Environment>, warnings: Vec<Warning> },
    /// Neither, for this reason.
    Failure(String),
}

/// The thread's other end.
pub(crate) struct Loader {
    requests: Sender<Inputs>,
    results: Receiver<Loaded>,
    /// What is not answered yet, in words, oldest first.
    pending: VecDeque<String>,
}

impl Loader {
    /// Starts the thread. It wakes the window whenever something is loaded, and ends with it.
    pub(crate) fn new(gpu: Gpu, context: egui::Context) -> std::io::Result<Self> {
        let (requests, asked) = mpsc::channel::<Inputs>();
        let (answer, results) = mpsc::channel();
        thread::Builder::new().name("loader".into()).spawn(move || {
            for inputs in asked {
                let loaded = load(&gpu, &inputs).unwrap_or_else(Loaded::Failure);
                if answer.send(loaded).is_err() {
                    break;
                }
                context.request_repaint();
            }
        })?;
        Ok(Self { requests, results, pending: VecDeque::new() })
    }

    /// Asks for a scene, or for an environment where no scene is named.
    pub(crate) fn request(&mut self, inputs: Inputs) {
        let name = inputs.to_string();
        if self.requests.send(inputs).is_ok() {
            self.pending.push_back(name);
        }
    }

    /// The oldest answer that has not been taken.
    pub(crate) fn finished(&mut self) -> Option<Loaded> {
        match self.results.try_recv() {
            Ok(loaded) => {
                self.pending.pop_front();
                Some(loaded)
            }
            Err(mpsc::TryRecvError::Empty) => None,
            Err(mpsc::TryRecvError::Disconnected) => {
                let name = self.pending.drain(..).next()?;
                Some(Loaded::Failure(format!("{name}: the loader broke off; restart to load more files")))
            }
        }
    }

    /// What is being loaded.
    pub(crate) fn current(&self) -> Option<&str> {
        self.pending.front().map(String::as_str)
    }
}

fn load(gpu: &Gpu, inputs: &Inputs) -> Result<Loaded, String> {
    let text = |error: scene::Error| error.to_string();
    if let (None, Some(source)) = (&inputs.scene, &inputs.environment) {
        let (environment, warnings) = source.load().map_err(text)?;
        return Ok(Loaded::Environment { environment, warnings });
    }
    let mut scene = inputs.load_named().map_err(text)?;
    let mut settings = Settings::FULL;
    let notes = settings::apply_scene(&mut settings, &scene).map_err(text)?;
    scene.warnings.extend(notes);
    let settings = (!scene.technique_settings.is_empty()).then_some(settings);
    let uploaded = SceneGpu::upload(gpu, &scene).map_err(|error| error.to_string())?;
    Ok(Loaded::Scene { scene: Box::new(scene), uploaded: Box::new(uploaded), settings })
}
