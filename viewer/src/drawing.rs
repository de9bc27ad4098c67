//! The picture in the middle of the window: rendered when something about it has changed, and only
//! then. Where rendering is slow, it is rendered coarsely while it keeps changing.

use crate::state::State;
use compositor::{Compositor, Desc, Error, Frame, FrameWork, SceneGpu, Settings, wgpu};
use eframe::egui;
use egui_wgpu::RenderState;
use gpu_context::{Gpu, Timer};
use scene::{Camera, Environment, Light};
use std::time::{Duration, Instant};

/// The user interface blends encoded colours, and so reads its textures without decoding them.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// After how long without a change a coarse picture is rendered finely.
const SETTLING: Duration = Duration::from_millis(250);
/// The longest that a picture may take while it keeps changing, milliseconds. Each level of
/// coarseness takes a quarter of the time.
const SMOOTH_MS: f64 = 60.0;
const COARSEST: u32 = 4;

/// The picture and what draws it.
pub(crate) struct Drawing {
    gpu: Gpu,
    host: RenderState,
    compositor: Compositor,
    timer: Timer,
    scene: SceneGpu,
    target: Option<Target>,
    /// How the picture was last asked for, and since when.
    wanted: Option<(Look, Instant)>,
    drawn: Option<Look>,
    /// What a fine picture takes on the GPU, as far as it is known.
    fine_ms: f64,
    /// The times of the last picture have not arrived yet.
    awaits_times: bool,
}

/// The texture that the window shows.
struct Target {
    size: [u32; 2],
    view: wgpu::TextureView,
    id: egui::TextureId,
}

/// Everything that decides how the picture looks, except for what is uploaded.
#[derive(Clone, Copy, PartialEq)]
struct Look {
    size: [u32; 2],
    camera: Camera,
    settings: Settings,
    /// Intensity and turn.
    environment: Option<(f32, f32)>,
}

impl Drawing {
    /// On the window's own device.
    pub(crate) fn new(host: &RenderState) -> Result<Self, Error> {
        let gpu = Gpu::from_host(host.device.clone(), host.queue.clone(), host.adapter.get_info());
        gpu.collect_errors();
        Ok(Self {
            compositor: Compositor::new(&gpu, &Desc { display_format: FORMAT })?,
            timer: Timer::new(&gpu)?,
            gpu,
            host: host.clone(),
            scene: SceneGpu::default(),
            target: None,
            wanted: None,
            drawn: None,
            fine_ms: 0.0,
            awaits_times: false,
        })
    }

    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    pub(crate) fn scene(&self) -> &SceneGpu {
        &self.scene
    }

    /// Draws another scene from now on.
    pub(crate) fn set_scene(&mut self, scene: SceneGpu) {
        self.scene = scene;
        self.drawn = None;
    }

    /// Lights the scene by these from now on.
    pub(crate) fn set_lights(&mut self, lights: &[Light]) -> Result<(), Error> {
        self.drawn = None;
        self.scene.set_lights(&self.gpu, lights)
    }

    /// Lights the scene by another environment from now on.
    pub(crate) fn set_environment(&mut self, environment: Option<&Environment>) -> Result<(), Error> {
        self.drawn = None;
        self.scene.set_environment(&self.gpu, environment)
    }

    /// The texture of the picture as the state describes it, rendered now if it is not that yet, and
    /// in how long to ask again because the picture is still a coarse one.
    pub(crate) fn show(
        &mut self,
        state: &mut State,
        size: [u32; 2],
    ) -> Result<(Option<egui::TextureId>, Option<Duration>), Error> {
        let environment = state.scene.environment.as_ref();
        let mut look = Look {
            size,
            camera: state.camera.camera(),
            settings: state.settings(),
            environment: environment.map(|environment| (environment.intensity, environment.rotation_rad)),
        };
        let rest = self.rest(&look);
        if rest.is_some() {
            look.size = size.map(|side| (side / self.coarseness()).max(1));
        }
        if self.drawn != Some(look) && self.gpu.check_lost().is_ok() {
            // A look that fails is not tried again until it changes.
            self.drawn = Some(look);
            state.work = self.render(&look)?;
            state.horizon_memory_bytes = self.compositor.horizon_memory_bytes();
            state.horizon_progress = self.compositor.horizon_progress();
        }
        let id = self.target.as_ref().map(|target| target.id);
        if state.horizon_progress.done < state.horizon_progress.total {
            // The next picture bakes on.
            self.drawn = None;
            return Ok((id, Some(Duration::ZERO)));
        }
        Ok((id, rest))
    }

    /// How long the look has to stay as it is until it counts as settled; `None` where it has, or
    /// where that makes no difference.
    fn rest(&mut self, look: &Look) -> Option<Duration> {
        let since = match self.wanted {
            Some((wanted, since)) if wanted == *look => since,
            // The first picture of all is a fine one.
            None => Instant::now().checked_sub(SETTLING)?,
            Some(_) => Instant::now(),
        };
        self.wanted = Some((*look, since));
        SETTLING.checked_sub(since.elapsed()).filter(|rest| !rest.is_zero() && self.coarseness() > 1)
    }

    /// By what the sides of the picture are divided while it keeps changing.
    fn coarseness(&self) -> u32 {
        let mut coarseness = 1;
        while coarseness < COARSEST && self.fine_ms > SMOOTH_MS * f64::from(coarseness * coarseness) {
            coarseness *= 2;
        }
        coarseness
    }

    fn render(&mut self, look: &Look) -> Result<FrameWork, Error> {
        if let Some((intensity, rotation_rad)) = look.environment {
            self.scene.place_environment(intensity, rotation_rad);
        }
        let target = self.target(look.size)?;
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let frame = Frame { scene: &self.scene, camera: &look.camera, size: look.size, timer: &self.timer };
        let recorded =
            self.compositor.render(&self.gpu, &mut encoder, &look.settings, &frame).and_then(|work| {
                self.compositor.tone_map(&self.gpu, &mut encoder, &look.settings, &target)?;
                Ok(work)
            });
        self.timer.resolve(&mut encoder);
        self.gpu.queue().submit([encoder.finish()]);
        self.timer.end_frame()?;
        self.awaits_times = true;
        recorded
    }

    /// The view to render into, made anew for another size.
    fn target(&mut self, size: [u32; 2]) -> Result<wgpu::TextureView, Error> {
        if let Some(target) = self.target.as_ref().filter(|target| target.size == size) {
            return Ok(target.view.clone());
        }
        let [width, height] = size;
        let view = self.gpu.checked("picture", |device| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        })?;
        let mut renderer = self.host.renderer.write();
        let (device, filter) = (self.gpu.device(), wgpu::FilterMode::Linear);
        let id = match &self.target {
            Some(target) => {
                renderer.update_egui_texture_from_wgpu_texture(device, &view, filter, target.id);
                target.id
            }
            None => renderer.register_native_texture(device, &view, filter),
        };
        self.target = Some(Target { size, view: view.clone(), id });
        Ok(view)
    }

    /// Fetches the times of finished pictures; true while some are still missing.
    pub(crate) fn collect_times(&mut self, state: &mut State) -> bool {
        if !self.awaits_times {
            return false;
        }
        // A failed poll means a lost device, which arrives among the device's errors.
        self.gpu.device().poll(wgpu::PollType::Poll).ok();
        while let Some(timings) = self.timer.finished_frame() {
            let total_ms: f64 = timings.iter().filter_map(|timing| timing.time_ms).sum();
            if let (Some((wanted, _)), Some(drawn)) = (&self.wanted, &self.drawn) {
                self.fine_ms = total_ms * pixels(wanted) / pixels(drawn);
            }
            state.timings = timings;
            self.awaits_times = false;
        }
        self.awaits_times
    }
}

fn pixels(look: &Look) -> f64 {
    f64::from(look.size[0]) * f64::from(look.size[1])
}
