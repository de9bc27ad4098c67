//! Path-traced truths: films that are kept, and added to when more samples are asked for.

use crate::{
    Context,
    technique::{Failure, TruthImage},
};
use image_error::Image;
use path_tracer::{Film, Identity, PathTracer, Progress, Settings};
use scene::{Camera, Scene};
use std::{fs, ops::ControlFlow, path::Path, sync::atomic::Ordering};

/// A path-traced truth: the samples `0..n` of `settings`, of which those that an earlier run kept
/// are not traced again. There may be more samples than asked for, never fewer: where the run is
/// stopped the samples so far are kept, and this fails.
pub fn path_traced(
    context: &mut Context,
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
) -> Result<TruthImage, Failure> {
    let identity = Identity::new(scene, camera, settings);
    let path = context.references().join(format!("{}.exr", identity.fingerprint_text()));
    let kept = if context.scope().fresh { None } else { kept(&path, &identity, settings.size) };
    let done = kept.as_ref().map_or(0, Film::samples_per_pixel);
    let film = match kept {
        Some(film) if done >= settings.samples.end => film,
        kept => {
            let rest = Settings { samples: done..settings.samples.end, ..settings.clone() };
            let film = match (kept, trace(context, scene, camera, &rest)?) {
                (Some(kept), more) => Film::merge(vec![kept, more])?,
                (None, film) => film,
            };
            if film.samples_per_pixel() > done {
                super::keep(&path, &film.to_exr()?)?;
            }
            film
        }
    };
    if film.samples_per_pixel() < settings.samples.end {
        return Err("stopped".into());
    }
    truth(&film)
}

/// The film of an earlier run, if it shows the same picture and its samples begin at 0.
fn kept(path: &Path, identity: &Identity, size: [u32; 2]) -> Option<Film> {
    let film = Film::from_exr(&fs::read(path).ok()?, &path.display().to_string()).ok()?;
    let fits = film.size() == size
        && film.identity().fingerprint == identity.fingerprint
        && film.identity().version == identity.version
        && matches!(film.samples().ranges(), [range] if range.start == 0);
    fits.then_some(film)
}

fn trace(context: &Context, scene: &Scene, camera: &Camera, settings: &Settings) -> Result<Film, Failure> {
    let tracer = PathTracer::new(scene)?;
    let (stop, shown) = (context.stop_flag(), context.status_line());
    let observe = |progress: Progress| {
        let left = progress.remaining().map_or(String::new(), |left| format!(", {} s left", left.as_secs()));
        let percent = 100 * progress.done_samples / progress.total_samples.max(1);
        shown.show(&format!("path tracer {percent} %{left}"));
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    Ok(tracer.render(camera, settings, &observe)?)
}

fn truth(film: &Film) -> Result<TruthImage, Failure> {
    let [width, height] = film.size().map(|side| side as usize);
    let (invalid, clamped) = (film.invalid(), film.clamped());
    if invalid > 0 {
        return Err(format!("the path tracer gave {invalid} samples that are no radiance").into());
    }
    let clamped = if clamped > 0 { format!(", {clamped} samples clamped") } else { String::new() };
    let Identity { version, settings, .. } = film.identity();
    Ok(TruthImage {
        image: Image::new(width, height, film.mean())?,
        variance_of_mean: Some(film.variance_of_mean()),
        mask: None,
        how: format!(
            "path tracer {version}, {} samples a pixel ({settings}){clamped}",
            film.samples_per_pixel()
        ),
    })
}
