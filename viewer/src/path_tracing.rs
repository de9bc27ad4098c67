//! The reference picture: the view, path traced on a thread of its own while it stands still.

use crate::{pictures, state::State};
use compositor::{ToneCurve, tone_map};
use eframe::egui::{self, ColorImage, TextureHandle, TextureOptions};
use image_error::{Image, noise_relative_mse};
use path_tracer::{Film, Lobe, PathTracer, PixelFilter, Settings};
use scene::{Camera, Scene};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How long a view has to stand still before it is traced.
const SETTLING: Duration = Duration::from_millis(250);

/// What the user chose about the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reference {
    pub(crate) on: bool,
    pub(crate) light: Light,
    /// Samples a pixel, at least 1.
    pub(crate) samples: u32,
    /// The reference covers the picture right of this share of its width, 0..=1.
    pub(crate) split: f32,
}

impl Default for Reference {
    fn default() -> Self {
        Self { on: false, light: Light::Transport, samples: 256, split: 0.5 }
    }
}

/// What the reference is the truth of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Light {
    /// All of it: what differs is the error of model and approximation together.
    Transport,
    /// The far field under diffuse-envmap's own lobe: what differs is its approximation error.
    FarField,
}

/// How far the reference is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Status {
    /// Samples a pixel so far.
    pub(crate) samples: u32,
    /// The relative root mean square error that the picture's own noise amounts to, once known.
    pub(crate) noise: Option<f64>,
    /// An estimate of what is left; zero when it is done.
    pub(crate) remaining: Duration,
}

/// What decides the traced picture.
#[derive(Clone, Copy, PartialEq)]
struct View {
    scene: SceneKey,
    camera: Camera,
    size: [u32; 2],
    light: Light,
    samples: u32,
}

/// What decides the traced scene: its version, and intensity and turn of its environment.
#[derive(Clone, Copy, PartialEq)]
struct SceneKey {
    version: u64,
    environment: Option<(f32, f32)>,
}

/// A view to trace, and its scene where it is another than before.
struct Request {
    ticket: u64,
    view: View,
    scene: Option<Scene>,
}

/// The traced picture so far.
struct Traced {
    ticket: u64,
    /// Linear radiance.
    mean: Image,
    status: Status,
}

/// What both threads share.
#[derive(Default)]
struct Shared {
    /// The request that counts. Whoever works for an older one gives up.
    ticket: AtomicU64,
    /// The newest picture that the window has not taken, or why there is none.
    newest: Mutex<Option<Result<Traced, String>>>,
}

/// The thread's other end, and the texture of its picture.
pub(crate) struct PathTracing {
    requests: Sender<Request>,
    shared: Arc<Shared>,
    wanted: Option<(View, Instant)>,
    requested: Option<View>,
    /// The scene that the thread has.
    sent: Option<SceneKey>,
    traced: Option<Traced>,
    texture: Option<(TextureHandle, f32, ToneCurve)>,
}

impl PathTracing {
    /// Starts the thread. It wakes the window whenever the picture is better, and ends with it.
    pub(crate) fn new(context: egui::Context) -> std::io::Result<Self> {
        let (requests, asked) = mpsc::channel();
        let shared = Arc::new(Shared::default());
        let of_thread = Arc::clone(&shared);
        thread::Builder::new()
            .name("path tracer".into())
            .spawn(move || work(&asked, &of_thread, &|| context.request_repaint()))?;
        let (wanted, requested, sent) = (None, None, None);
        Ok(Self { requests, shared, wanted, requested, sent, traced: None, texture: None })
    }

    /// The texture of the reference as far as it is traced, asked for anew where the view has
    /// changed and settled. Also how long to wait until it has settled.
    pub(crate) fn show(
        &mut self,
        context: &egui::Context,
        state: &mut State,
        size: [u32; 2],
    ) -> (Option<egui::TextureId>, Option<Duration>) {
        if !state.reference.on {
            self.stop();
            return (None, None);
        }
        let view = View::of_state(state, size);
        let rest = self.request_settled(view, state);
        self.take_newest(state);
        state.reference_status = self.traced.as_ref().map(|traced| traced.status);
        let texture = self.texture(context, state.exposure_ev, state.tone_curve);
        (texture.filter(|_| self.requested == Some(view)), rest)
    }

    /// Gives up what is being traced, and frees the picture.
    fn stop(&mut self) {
        if self.requested.take().is_some() {
            self.shared.ticket.fetch_add(1, Ordering::Relaxed);
        }
        (self.wanted, self.traced, self.texture) = (None, None, None);
    }

    /// Asks for a view once it has stood still; in how long that is, where it has not yet.
    fn request_settled(&mut self, view: View, state: &State) -> Option<Duration> {
        if self.requested == Some(view) {
            return None;
        }
        let since = match self.wanted {
            Some((wanted, since)) if wanted == view => since,
            _ => Instant::now(),
        };
        self.wanted = Some((view, since));
        let rest = SETTLING.saturating_sub(since.elapsed());
        if !rest.is_zero() {
            return Some(rest);
        }
        let ticket = self.shared.ticket.fetch_add(1, Ordering::Relaxed) + 1;
        let scene = (self.sent != Some(view.scene)).then(|| state.scene.clone());
        if self.requests.send(Request { ticket, view, scene }).is_ok() {
            self.sent = Some(view.scene);
        }
        (self.requested, self.traced, self.texture) = (Some(view), None, None);
        None
    }

    fn take_newest(&mut self, state: &mut State) {
        let ticket = self.shared.ticket.load(Ordering::Relaxed);
        match self.shared.newest().take() {
            Some(Ok(traced)) if traced.ticket == ticket => {
                self.traced = Some(traced);
                self.texture = None;
            }
            Some(Err(message)) => {
                state.reference.on = false;
                state.fail(&message);
            }
            _ => (),
        }
    }

    /// The picture's texture, made again where its pixels or their exposure have changed.
    fn texture(
        &mut self,
        context: &egui::Context,
        exposure_ev: f32,
        curve: ToneCurve,
    ) -> Option<egui::TextureId> {
        let traced = self.traced.as_ref()?;
        if let Some((texture, ev, tone)) = &self.texture
            && (*ev, *tone) == (exposure_ev, curve)
        {
            return Some(texture.id());
        }
        let color = |&radiance: &[f32; 3]| {
            let [red, green, blue] = tone_map::display_srgb8(radiance, exposure_ev, curve);
            egui::Color32::from_rgb(red, green, blue)
        };
        let size = [traced.mean.width(), traced.mean.height()];
        let image = ColorImage::new(size, traced.mean.pixels().iter().map(color).collect());
        let texture = context.load_texture("reference", image, TextureOptions::LINEAR);
        let id = texture.id();
        self.texture = Some((texture, exposure_ev, curve));
        Some(id)
    }
}

impl View {
    fn of_state(state: &State, size: [u32; 2]) -> Self {
        let environment = state.scene.environment.as_ref();
        let environment = environment.map(|environment| (environment.intensity, environment.rotation_rad));
        let Reference { light, samples, .. } = state.reference;
        let scene = SceneKey { version: state.scene_version, environment };
        Self { scene, camera: state.camera.camera(), size, light, samples }
    }

    fn settings(&self) -> Settings {
        let settings =
            Settings { pixel_filter: PixelFilter::Box, ..Settings::new(self.size, self.samples.max(1)) };
        match self.light {
            Light::Transport => settings,
            Light::FarField => Settings { lobe: Lobe::DiffusedEnvironment, occlusion: false, ..settings },
        }
    }
}

impl Shared {
    fn newest(&self) -> MutexGuard<'_, Option<Result<Traced, String>>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_stale(&self, ticket: u64) -> bool {
        self.ticket.load(Ordering::Relaxed) != ticket
    }
}

/// The thread: traces what is asked for last, until the window is gone.
fn work(asked: &Receiver<Request>, shared: &Shared, wake: &(dyn Fn() + Sync)) {
    let mut tracer = Err("nothing to trace".to_owned());
    for Request { ticket, view, scene } in asked {
        if let Some(scene) = scene {
            tracer = PathTracer::new(&scene).map_err(|error| error.to_string());
        }
        if shared.is_stale(ticket) {
            continue;
        }
        let result = tracer
            .as_ref()
            .map_err(String::clone)
            .and_then(|tracer| trace(tracer, ticket, &view, shared, wake).map_err(|error| error.to_string()));
        if let Err(message) = result {
            *shared.newest() = Some(Err(message));
            wake();
        }
    }
}

/// Traces one view; every better picture goes to the window.
fn trace(
    tracer: &PathTracer,
    ticket: u64,
    view: &View,
    shared: &Shared,
    wake: &(dyn Fn() + Sync),
) -> Result<(), path_tracer::Error> {
    let begin = Instant::now();
    let go_on = |_| if shared.is_stale(ticket) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    tracer.render_progressive(&view.camera, &view.settings(), &go_on, &mut |film| {
        let traced = pictures::mean(film).map(|mean| {
            let status = status(film, &mean, view.samples.max(1), begin.elapsed());
            Traced { ticket, mean, status }
        });
        *shared.newest() = Some(traced.map_err(|error| error.to_string()));
        wake();
    })?;
    Ok(())
}

fn status(film: &Film, mean: &Image, wanted: u32, elapsed: Duration) -> Status {
    let samples = film.samples_per_pixel();
    let noise = noise_relative_mse(mean, &film.variance_of_mean());
    let remaining = elapsed.mul_f64(f64::from(wanted.saturating_sub(samples)) / f64::from(samples.max(1)));
    let noise = noise.ok().map(f64::sqrt).filter(|noise| noise.is_finite());
    Status { samples, noise, remaining }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square in the light of the built-in studio.
    fn square() -> Scene {
        let instance = scene::Instance {
            name: "square".into(),
            mesh: 0,
            material: 0,
            world_from_local: glam::Mat4::IDENTITY,
        };
        Scene {
            meshes: scene::shapes::by_name("plane").into_iter().collect(),
            materials: vec![scene::Material::default()],
            instances: vec![instance],
            environment: scene::builtin::environment_sized("studio", 16),
            ..Scene::default()
        }
    }

    fn request(ticket: u64, version: u64, scene: Option<Scene>) -> Request {
        let camera = square().framing_camera(1.0);
        let scene_key = SceneKey { version, environment: None };
        let view = View { scene: scene_key, camera, size: [8, 8], light: Light::Transport, samples: 3 };
        Request { ticket, view, scene }
    }

    /// Runs the thread's work on some requests, of which the one with `ticket` counts.
    fn traced(requests: Vec<Request>, ticket: u64) -> Option<Result<Traced, String>> {
        let (sender, asked) = mpsc::channel();
        for request in requests {
            sender.send(request).unwrap();
        }
        drop(sender);
        let shared = Shared { ticket: AtomicU64::new(ticket), newest: Mutex::default() };
        work(&asked, &shared, &|| ());
        shared.newest.into_inner().unwrap()
    }

    #[test]
    fn the_last_view_is_traced_with_the_scene_that_was_sent_before() {
        let requests = vec![request(1, 0, Some(square())), request(2, 0, None)];
        let traced = traced(requests, 2).unwrap().unwrap();
        let size = [traced.mean.width(), traced.mean.height()];
        assert_eq!((traced.ticket, size, traced.status.samples), (2, [8, 8], 3));
        assert_eq!(traced.status.remaining, Duration::ZERO);
        assert!(traced.status.noise.is_some_and(|noise| noise > 0.0));
        assert!(traced.mean.pixels().iter().flatten().any(|value| *value > 0.0));
    }

    #[test]
    fn what_is_out_of_date_is_not_traced() {
        assert!(traced(vec![request(1, 0, Some(square()))], 2).is_none());
    }

    #[test]
    fn a_scene_that_cannot_be_traced_says_why() {
        let mut scene = square();
        scene.instances[0].mesh = usize::MAX;
        let message = traced(vec![request(1, 0, Some(scene))], 1).unwrap().err().unwrap();
        assert!(message.contains("mesh"), "{message}");
    }
}
