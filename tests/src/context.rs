//! What every closure of a registration gets: the device, a compositor, the scope of the run.

use crate::{Shot, technique::Failure};
use compositor::{Compositor, Desc, SceneGpu, Settings, wgpu};
use gpu_context::{Gpu, HeadlessDesc};
use image_error::Image;
use scene::{Camera, Scene};
use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

/// How much is asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scope {
    /// Smaller sizes, fewer samples, fewer scenes: for every change, not for figures that are quoted.
    pub quick: bool,
    /// Only scenes of this name.
    pub scene: Option<String>,
    /// Truths that earlier runs kept are made anew.
    pub fresh: bool,
}

/// Shows one line of progress, from any thread.
#[derive(Clone)]
pub struct StatusLine(Arc<dyn Fn(&str) + Send + Sync>);

impl StatusLine {
    /// Shows a line in place of the one before.
    pub fn show(&self, line: &str) {
        (self.0)(line);
    }
}

/// The state of a run. One device serves the whole run, and one compositor, because drivers take
/// longer to compile its shaders than to draw a small picture.
pub struct Context {
    gpu: Gpu,
    compositor: Option<Compositor>,
    scope: Scope,
    references: PathBuf,
    stop: Arc<AtomicBool>,
    status: StatusLine,
}

impl Context {
    /// A device, and a folder in which truths are kept. Fails where there is no adapter.
    pub fn new(scope: Scope, references: PathBuf) -> Result<Self, Failure> {
        let gpu = Gpu::headless(&HeadlessDesc::default())?;
        Ok(Self {
            gpu,
            compositor: None,
            scope,
            references,
            stop: Arc::default(),
            status: StatusLine(Arc::new(|_| {})),
        })
    }

    /// Replaces the flag that asks the run to stop, and what shows a line of progress.
    pub fn with_progress(self, stop: Arc<AtomicBool>, status: impl Fn(&str) + Send + Sync + 'static) -> Self {
        Self { stop, status: StatusLine(Arc::new(status)), ..self }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// How much is asked for.
    pub fn scope(&self) -> &Scope {
        &self.scope
    }

    /// The folder in which truths are kept between runs.
    pub fn references(&self) -> &std::path::Path {
        &self.references
    }

    /// Whether the run was asked to stop: what takes minutes looks at it every second, and fails.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The flag behind [`is_stopped`](Self::is_stopped), for other threads.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Shows what is being done, on the progress bar.
    pub fn status(&self, line: &str) {
        self.status.show(line);
    }

    /// What shows it, for other threads.
    pub fn status_line(&self) -> StatusLine {
        self.status.clone()
    }

    /// The device and the run's compositor, made on first use.
    pub fn compositor(&mut self) -> Result<(&Gpu, &mut Compositor), Failure> {
        let compositor = match self.compositor.take() {
            Some(compositor) => compositor,
            None => {
                Compositor::new(&self.gpu, &Desc { display_format: wgpu::TextureFormat::Rgba8UnormSrgb })?
            }
        };
        Ok((&self.gpu, self.compositor.insert(compositor)))
    }

    /// Uploads a scene and renders one frame of it.
    pub fn shot(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        size: [u32; 2],
        settings: &Settings,
    ) -> Result<Shot, Failure> {
        let uploaded = SceneGpu::upload(&self.gpu, scene)?;
        let (gpu, compositor) = self.compositor()?;
        Shot::try_next(gpu, compositor, &uploaded, camera, size, settings)
    }

    /// The HDR image of one frame of a scene.
    pub fn picture(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        size: [u32; 2],
        settings: &Settings,
    ) -> Result<Image, Failure> {
        self.shot(scene, camera, size, settings)?.image()
    }
}
