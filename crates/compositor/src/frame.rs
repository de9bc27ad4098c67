//! The frame on one page: a scene through the surface buffer and the techniques to an HDR image.

use crate::{
    Error, SceneGpu, Settings, View,
    background::{BACKGROUND_OFF, Background, NO_ENVIRONMENT},
    coat::{Coats, Incident, NO_COATS},
    direct_light::{DIRECT_LIGHT_OFF, DirectLight, NO_LIGHTS, NO_SURFACE},
    far_field::{self, DIFFUSE_ENVMAP_OFF},
    geometry::Geometry,
    horizon::Horizons,
    shadows::Shadows,
    surface::{SurfaceBuffer, Target},
    tone_map::ToneMap,
};
use diffuse_envmap::DiffuseEnvmap;
use gpu_context::{Gpu, Timer, Work};
use scene::Camera;

/// What decides pipelines.
#[derive(Clone, Copy, Debug)]
pub struct Desc {
    /// Format of the views that [`Compositor::tone_map`] draws into, 8 bits a channel. A format
    /// without the sRGB curve gets it from the shader.
    pub display_format: wgpu::TextureFormat,
}

/// What the host lends for one frame.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The scene.
    pub scene: &'a SceneGpu,
    /// Where it is seen from.
    pub camera: &'a Camera,
    /// Pixels per row, and rows.
    pub size: [u32; 2],
    /// Times each pass under its name in [`FrameWork`]; the host resolves it.
    pub timer: &'a Timer,
}

/// What each pass of a frame did, in order, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameWork {
    /// `geometry`, `horizon-shadow`, `shadow-map`, `diffuse-envmap`, `background`, `direct-light`, `clear-coat`.
    pub entries: Vec<(&'static str, Work)>,
}

impl FrameWork {
    /// What the pass of this name did.
    pub fn get(&self, name: &str) -> Option<Work> {
        self.entries.iter().find(|(entry, _)| *entry == name).map(|(_, work)| work.clone())
    }
}

/// The passes, and the images of the picture size that was last rendered. All are made on first
/// use; the images are remade when the size changes.
pub struct Compositor {
    geometry: Geometry,
    diffuse_envmap: Option<DiffuseEnvmap>,
    background: Option<Background>,
    shadows: Shadows,
    direct_light: Option<DirectLight>,
    coats: Option<Coats>,
    tone_map: ToneMap,
    surface: Option<SurfaceBuffer>,
}

impl Compositor {
    /// A compositor on this device. [`Error::Gpu`] where its shaders do not compile.
    pub fn new(gpu: &Gpu, desc: &Desc) -> Result<Self, Error> {
        Ok(Self {
            geometry: Geometry::new(gpu)?,
            diffuse_envmap: None,
            background: None,
            shadows: Shadows::default(),
            direct_light: None,
            coats: None,
            tone_map: ToneMap::new(gpu, desc.display_format),
            surface: None,
        })
    }

    /// Records one frame; the picture is in [`hdr`](Self::hdr) once the encoder is submitted.
    ///
    /// One frame per submission: uniforms are written through the queue. [`Error::Size`] and
    /// [`Error::Camera`] leave the encoder as it was.
    pub fn render(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        frame: &Frame<'_>,
    ) -> Result<FrameWork, Error> {
        let Frame { scene, camera, size, timer } = *frame;
        let view = View::new(camera, size, scene.bounds())?;
        let surface = match self.surface.take().filter(|surface| surface.size == size) {
            Some(surface) => surface,
            None => SurfaceBuffer::new(gpu, size)?,
        };
        let surface = self.surface.insert(surface);

        let mut scope = timer.scope("geometry", encoder);
        let geometry = self.geometry.draw(gpu, &mut scope, scene, &view, surface)?;
        drop(scope);

        let unlit = match &scene.lights {
            _ if !settings.direct_light => Some(DIRECT_LIGHT_OFF),
            _ if scene.draws.is_empty() => Some(NO_SURFACE),
            None => Some(NO_LIGHTS),
            Some(_) => None,
        };
        let [horizon_shadow, shadow_map] =
            self.shadows.draw(gpu, encoder, settings, (frame, &view), surface, unlit)?;
        let visibility = self.shadows.visibility.target();

        let mut scope = timer.scope("diffuse-envmap", encoder);
        let diffuse_envmap = match &settings.diffuse_envmap {
            None => Work::skipped(DIFFUSE_ENVMAP_OFF),
            _ if scene.environment().is_none() => Work::skipped(NO_ENVIRONMENT),
            _ if scene.draws.is_empty() => Work::skipped(NO_SURFACE),
            Some(settings) => {
                let technique = made(&mut self.diffuse_envmap, || far_field::new(gpu))?;
                far_field::draw(technique, gpu, &mut scope, settings, scene, &view, surface)?
            }
        };
        drop(scope);

        let mut scope = timer.scope("background", encoder);
        let background = match scene.environment() {
            _ if !settings.background => Work::skipped(BACKGROUND_OFF),
            None => Work::skipped(NO_ENVIRONMENT),
            Some(environment) => {
                let pass = made(&mut self.background, || Background::new(gpu))?;
                pass.draw(gpu, &mut scope, environment, &view, surface)
            }
        };
        drop(scope);

        let mut scope = timer.scope("direct-light", encoder);
        let direct_light = match (&scene.lights, unlit) {
            (Some(lights), None) => {
                let pass = self.direct_light.get_or_insert_with(|| DirectLight::new(gpu));
                pass.draw(gpu, &mut scope, lights, &view, surface, visibility)?
            }
            (_, reason) => Work::skipped(reason.unwrap_or(NO_LIGHTS)),
        };
        drop(scope);

        let mut scope = timer.scope("clear-coat", encoder);
        let clear_coat = if scene.coats.is_empty() {
            Work::skipped(NO_COATS)
        } else {
            let coats = made(&mut self.coats, || Coats::new(gpu))?;
            let is_lit = settings.diffuse_envmap.is_some() && scene.environment().is_some();
            let incident = Incident {
                lights: scene.lights.as_ref().filter(|_| settings.direct_light),
                environment: self.diffuse_envmap.as_ref().filter(|_| is_lit),
                visibility,
            };
            coats.draw(gpu, &mut scope, scene, &view, surface, &incident)?
        };
        drop(scope);

        Ok(FrameWork {
            entries: vec![
                ("geometry", geometry),
                ("horizon-shadow", horizon_shadow),
                ("shadow-map", shadow_map),
                ("diffuse-envmap", diffuse_envmap),
                ("background", background),
                ("direct-light", direct_light),
                ("clear-coat", clear_coat),
            ],
        })
    }

    /// Records exposure, tone curve and encoding of the last frame into a view of
    /// [`Desc::display_format`] of the same size. No effect before the first frame.
    pub fn tone_map(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        target: &wgpu::TextureView,
    ) -> Result<(), Error> {
        let Some(surface) = &self.surface else { return Ok(()) };
        let hdr = &surface.hdr.view;
        self.tone_map.draw(gpu, encoder, hdr, target, settings.exposure_ev, settings.tone_curve)
    }

    /// The surface buffer of the last frame.
    pub fn surface(&self) -> Option<&SurfaceBuffer> {
        self.surface.as_ref()
    }

    /// Bytes of GPU memory that the tables of height maps take.
    pub fn horizon_memory_bytes(&self) -> u64 {
        self.shadows.horizons.as_ref().map_or(0, Horizons::memory_bytes)
    }

    /// How far the tables of height maps are baked; nothing of nothing where none are needed.
    pub fn horizon_progress(&self) -> horizon_shadow::Progress {
        self.shadows.horizons.as_ref().map(Horizons::progress).unwrap_or_default()
    }

    /// Which share of each of the first [`MAX_SHADOWED_LIGHTS`](crate::MAX_SHADOWED_LIGHTS) lights
    /// reached each pixel of the last frame; `None` where it had no shadows. See
    /// [`VISIBILITY_FORMAT`](crate::VISIBILITY_FORMAT).
    pub fn visibility(&self) -> Option<&Target> {
        self.shadows.visibility.target()
    }

    /// The HDR image of the last frame.
    pub fn hdr(&self) -> Option<&Target> {
        self.surface.as_ref().map(|surface| &surface.hdr)
    }
}

/// What is in the slot, made now if it is empty.
fn made<T>(slot: &mut Option<T>, make: impl FnOnce() -> Result<T, Error>) -> Result<&mut T, Error> {
    let value = match slot.take() {
        Some(value) => value,
        None => make()?,
    };
    Ok(slot.insert(value))
}
