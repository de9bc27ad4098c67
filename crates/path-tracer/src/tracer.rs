//! Pictures of a scene, sample by sample.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicBool, AtomicU64, Ordering},
    time::{Duration, Instant},
};

use glam::DVec3;
use rayon::prelude::*;
use scene::{Camera, Scene};

use crate::{
    Error, Film, Identity, Settings, camera_rays::CameraRays, film::SceneHash, geometry::Ray,
    integrator::Integrator, random::Random, world::World,
};

/// Samples between two reports of progress.
const CHUNK: usize = 1024;

/// Samples that are held apart from the film until every pixel has its own; more where the pixels
/// are more.
const PASS: usize = 1 << 16;

/// A scene that can be traced, from any camera and by any number of threads at once. It owns what
/// it needs of the scene.
pub struct PathTracer {
    world: World,
    name: String,
    hash: SceneHash,
}

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Samples that are traced, over all pixels.
    pub done_samples: u64,
    /// Samples of the whole picture.
    pub total_samples: u64,
    /// Time since the picture was begun.
    pub elapsed: Duration,
}

impl Progress {
    /// An estimate of the time that is left, from the samples so far; `None` before the first.
    pub fn remaining(&self) -> Option<Duration> {
        let left = self.total_samples.saturating_sub(self.done_samples) as f64;
        (self.done_samples > 0).then(|| {
            Duration::try_from_secs_f64(self.elapsed.as_secs_f64() * left / self.done_samples as f64).ok()
        })?
    }
}

impl PathTracer {
    /// Prepares a scene: places its triangles and builds their hierarchy. An error where
    /// [`Scene::check`] has one, where there are more than [`crate::MAX_TRIANGLES`] triangles as
    /// placed and displaced, or where too many of them overlap.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Ok(Self { world: World::new(scene)?, name: scene.name.clone(), hash: SceneHash::new(scene) })
    }

    /// What was left out or made coarser while the scene was prepared.
    pub fn warnings(&self) -> &[String] {
        &self.world.geometry.warnings
    }

    /// Traces a picture, on the threads of the current rayon pool.
    ///
    /// `observe` is called from those threads after every thousand samples or so. When it breaks,
    /// the picture ends soon, and the film has only those samples that every pixel has: they are
    /// [`Film::samples`], and may be none.
    ///
    /// Every bit of the film follows from scene, camera and settings: neither the number of threads
    /// nor their order counts, and films of disjoint ranges of samples merge ([`Film::merge`]) to
    /// the film of all of them. An error where the camera or a setting is out of range, or where
    /// there is no memory for the film.
    pub fn render(
        &self,
        camera: &Camera,
        settings: &Settings,
        observe: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<Film, Error> {
        self.render_progressive(camera, settings, observe, &mut |_| ())
    }

    /// The same, and calls `on_film` on this thread whenever all pixels have one or more samples
    /// more; the last call has the film that is returned. For a view that becomes clearer, call it
    /// from a background thread.
    pub fn render_progressive(
        &self,
        camera: &Camera,
        settings: &Settings,
        observe: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
        on_film: &mut dyn FnMut(&Film),
    ) -> Result<Film, Error> {
        settings.check()?;
        let rays = CameraRays::new(camera, settings)?;
        let mut film = Film::new(settings.size, Identity::of_hash(&self.name, self.hash, camera, settings))?;
        let pixels = film.pixels().len();
        let per_pass = (PASS / pixels).max(1) as u32;
        let watch = Watch::new(pixels as u64 * settings.samples.len() as u64, observe);
        let mut first = settings.samples.start;
        while first < settings.samples.end {
            let samples = first..settings.samples.end.min(first.saturating_add(per_pass));
            let Some(radiance) = self.pass(&rays, settings, samples.clone(), pixels, &watch)? else { break };
            let of_pixels = radiance.par_chunks_exact(samples.len());
            film.pixels_mut().par_iter_mut().zip(of_pixels).with_min_len(256).for_each(|(sums, radiance)| {
                for &radiance in radiance {
                    sums.add(radiance);
                }
            });
            film.finish_samples(samples.clone())?;
            on_film(&film);
            if watch.is_cancelled() {
                break;
            }
            first = samples.end;
        }
        Ok(film)
    }

    /// The distance in metres at which a ray meets the first surface, if it meets one. The
    /// direction must be of unit length.
    pub fn trace_distance(&self, origin_world: DVec3, direction_world: DVec3) -> Option<f64> {
        let space = &self.world.geometry.space;
        let origin = space.tracer_from_world(origin_world);
        if !(origin.is_finite() && direction_world.is_normalized()) {
            return None;
        }
        let ray = Ray { origin, direction: direction_world, length: f64::INFINITY, key: 0 };
        let hit = self.world.geometry.closest_hit(&ray, &self.world)?;
        Some(hit.distance / space.units_per_metre)
    }

    /// The radiance of some samples of all pixels, in the order of the pixels; `None` where it was
    /// cancelled before all were traced.
    fn pass(
        &self,
        rays: &CameraRays,
        settings: &Settings,
        samples: std::ops::Range<u32>,
        pixels: usize,
        watch: &Watch<'_>,
    ) -> Result<Option<Vec<[f64; 3]>>, Error> {
        let integrator = Integrator::new(&self.world, settings);
        let origin = self.world.geometry.space.tracer_from_world(rays.eye_world);
        let trace = |index: usize| {
            let pixel = (index / samples.len()) as u32;
            let sample = samples.start + (index % samples.len()) as u32;
            let mut random = Random::new(pixel, sample, settings.seed);
            let [width, _] = settings.size;
            let direction = rays.direction_world([pixel % width, pixel / width], &mut random);
            integrator.radiance(origin, direction, &mut random)
        };
        let mut radiance = Vec::new();
        radiance.try_reserve_exact(pixels * samples.len()).map_err(|error| {
            Error::new(
                &self.name,
                "film size",
                format!("no memory for a pass ({error})"),
                "a smaller picture",
            )
        })?;
        radiance.resize(pixels * samples.len(), [0.0; 3]);
        let is_complete = AtomicBool::new(true);
        radiance.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, values)| {
            if watch.is_cancelled() {
                is_complete.store(false, Ordering::Relaxed);
                return;
            }
            for (offset, value) in values.iter_mut().enumerate() {
                *value = trace(chunk * CHUNK + offset);
            }
            watch.advance(values.len() as u64);
        });
        Ok(is_complete.into_inner().then_some(radiance))
    }
}

/// Counts samples, reports them, and remembers whether to stop.
struct Watch<'a> {
    observe: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    begin: Instant,
    done: AtomicU64,
    total: u64,
    cancelled: AtomicBool,
}

impl<'a> Watch<'a> {
    fn new(total: u64, observe: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync)) -> Self {
        let (done, cancelled) = (AtomicU64::new(0), AtomicBool::new(false));
        Self { observe, begin: Instant::now(), done, total, cancelled }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    fn advance(&self, samples: u64) {
        let done_samples = self.done.fetch_add(samples, Ordering::Relaxed) + samples;
        let progress = Progress { done_samples, total_samples: self.total, elapsed: self.begin.elapsed() };
        if (self.observe)(progress).is_break() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
    }
}
