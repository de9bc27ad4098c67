//! `sheen reference`: the path-traced picture of a scene, with its variance and exact sums.

use super::{Failure, INTERRUPTED, print, print_warnings};
use crate::{cli::ReferenceArguments, output::Format, pictures::mean, progress::Reporter};
use path_tracer::{Film, PathTracer, Settings};
use scene::output::write_whole;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn run(arguments: &ReferenceArguments) -> Result<(), Failure> {
    Format::of_path(&arguments.out, &[Format::Exr])?;
    let scene = arguments.scene.load()?;
    print_warnings(&scene.warnings);
    let camera = arguments.scene.camera(&scene);
    let tracer = PathTracer::new(&scene)?;
    // The tracer has what it needs.
    drop(scene);
    for warning in tracer.warnings() {
        eprintln!("warning: {warning}");
    }

    let settings = settings(arguments);
    let [width, height] = settings.size;
    let is_interrupted = on_interrupt()?;
    let reporter = Reporter::new(&format!(
        "{width} x {height} pixels, samples {}..{}",
        settings.samples.start, settings.samples.end
    ));
    let film = tracer.render(&camera, &settings, &|progress| {
        reporter.report(progress);
        if is_interrupted.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    reporter.finish();
    keep(arguments, &settings, &film)
}

fn settings(arguments: &ReferenceArguments) -> Settings {
    Settings {
        samples: arguments.samples.clone().unwrap_or(0..arguments.spp),
        seed: arguments.seed,
        max_bounces: arguments.max_bounces,
        lobe: arguments.lobe,
        occlusion: !arguments.far_field,
        pixel_filter: arguments.pixel_filter,
        ..Settings::new(arguments.scene.size, arguments.spp)
    }
}

/// Writes the film of all samples, or of those before an interruption, and says which.
fn keep(arguments: &ReferenceArguments, settings: &Settings, film: &Film) -> Result<(), Failure> {
    let out = arguments.out.display();
    if film.samples_per_pixel() == 0 {
        let message = format!("no sample of every pixel was finished; {out} was not written");
        return Err(Failure::Interrupted(message));
    }
    print_counts(film);
    write_whole(&arguments.out, &film.to_exr()?)?;
    print(&format!("{out}: {}\n", describe(film)?));
    match film.samples().ranges().last() {
        Some(done) if done.end < settings.samples.end => Err(Failure::Interrupted(format!(
            "{out} holds samples {} alone; --samples {}..{} renders the rest, and sheen merge adds it",
            film.samples(),
            done.end,
            settings.samples.end
        ))),
        _ => Ok(()),
    }
}

/// Warns of samples that are not what the path tracer is meant to give.
pub(super) fn print_counts(film: &Film) {
    for (count, what) in
        [(film.invalid(), "NaN, infinite or negative and taken for black"), (film.clamped(), "beyond 2^30")]
    {
        if count > 0 {
            eprintln!("warning: {count} samples were {what}");
        }
    }
}

/// A film in one line.
pub(super) fn describe(film: &Film) -> Result<String, Failure> {
    let [width, height] = film.size();
    let identity = film.identity();
    Ok(format!(
        "{width} x {height}, samples {} of {}, noise (relmse) {:.3e}, fingerprint {}",
        film.samples(),
        identity.scene,
        image_error::noise_relative_mse(&mean(film)?, &film.variance_of_mean())?,
        identity.fingerprint_text()
    ))
}

/// Becomes true at the first Ctrl-C (or termination signal); a second one ends the program.
fn on_interrupt() -> Result<Arc<AtomicBool>, Failure> {
    let is_interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&is_interrupted);
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    };
    ctrlc::set_handler(handler).map_err(|error| Failure::Other(format!("Ctrl-C: {error}")))?;
    Ok(is_interrupted)
}
