//! `sheen render`: one picture to a file.

use super::{Failure, print, print_warnings};
use crate::{
    cli::RenderArguments,
    inputs::Inputs,
    output::{self, Format},
    settings,
};
use compositor::{Settings, headless};
use gpu_context::{Gpu, HeadlessDesc};
use scene::{Camera, Scene};
use std::path::Path;

pub(crate) fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let format = Format::of_path(&arguments.out)?;
    let mut inputs = Inputs::of_files(&arguments.files).map_err(Failure::Usage)?;
    if let Some(source) = &arguments.environment
        && inputs.environment.replace(source.clone()).is_some()
    {
        return Err(Failure::Usage(
            "found two environments: a file beside the scene, and --environment".into(),
        ));
    }
    let mut changes =
        Settings { exposure_ev: arguments.exposure, tone_curve: arguments.tone_curve, ..Settings::FULL };
    let mut scene = inputs.load_lit()?;
    if let (Some(environment), Some(degrees)) = (&mut scene.environment, arguments.rotation) {
        environment.rotation_rad = degrees.to_radians();
    }
    let notes = settings::apply_scene(&mut changes, &scene)?;
    scene.warnings.extend(notes);
    settings::apply(&mut changes, "--set", &arguments.assignments)
        .map_err(|error| Failure::Usage(error.to_string()))?;
    settings::keep_only(&mut changes, &arguments.techniques);

    let camera = camera(arguments, &scene);
    picture(&scene, &camera, arguments.size, &changes, format, &arguments.out)
}

/// The scene's camera or one that sees everything, moved where the arguments say so.
fn camera(arguments: &RenderArguments, scene: &Scene) -> Camera {
    let camera = of_scene(scene, arguments.size);
    Camera {
        eye: arguments.eye.unwrap_or(camera.eye),
        target: arguments.target.unwrap_or(camera.target),
        ..camera
    }
}

/// The scene's camera or one that sees everything.
pub(super) fn of_scene(scene: &Scene, [width, height]: [u32; 2]) -> Camera {
    scene.camera.unwrap_or_else(|| scene.framing_camera(width as f32 / height as f32))
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
    output::write_whole(out, &bytes)?;
    let [width, height] = size;
    print(&format!("{}: {width} x {height}, {}\n", out.display(), gpu.adapter_label()));
    Ok(())
}
