//! `sheen render`: one picture to a file.

use super::{Failure, print, print_warnings};
use crate::{cli::RenderArguments, output::Format, settings};
use compositor::{Settings, headless};
use gpu_context::{Gpu, HeadlessDesc};
use scene::{Camera, Scene, output::write_whole};
use std::path::Path;

pub(crate) fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let format = Format::of_path(&arguments.out, &Format::ALL)?;
    let mut changes =
        Settings { exposure_ev: arguments.exposure, tone_curve: arguments.tone_curve, ..Settings::FULL };
    let mut scene = arguments.scene.load()?;
    let notes = settings::apply_scene(&mut changes, &scene)?;
    scene.warnings.extend(notes);
    settings::apply(&mut changes, "--set", &arguments.assignments)
        .map_err(|error| Failure::Usage(error.to_string()))?;
    settings::keep_only(&mut changes, &arguments.techniques);

    let camera = arguments.scene.camera(&scene);
    picture(&scene, &camera, arguments.scene.size, &changes, format, &arguments.out)
}

/// Renders a scene and writes the picture; says so, and prints the warnings.
pub(super) fn picture(
    scene: &Scene,
    camera: &Camera,
    size: [u32; 2],
    settings: &Settings,
    format: Format,
    out: &Path,
) -> Result<(), Failure> {
    print_warnings(&scene.warnings);
    let gpu = Gpu::headless(&HeadlessDesc::default())?;
    let picture = headless::render(&gpu, scene, camera, size, settings)?;
    if let Some(error) = gpu.take_errors().first() {
        return Err(Failure::Other(error.to_string()));
    }
    print_warnings(&picture.warnings);
    if picture.overflowed > 0 {
        eprintln!("warning: {} values were beyond 65504 and brought back to it", picture.overflowed);
    }
    let bytes = format.encode(&picture, settings).map_err(Failure::Other)?;
    write_whole(out, &bytes)?;
    let [width, height] = size;
    print(&format!("{}: {width} x {height}, {}\n", out.display(), gpu.adapter_label()));
    Ok(())
}
