//! `sheen info`: what a file holds, its counts, and every warning.

use super::{Failure, print};
use crate::{cli::InfoArguments, pictures, settings};
use compositor::Settings;
use glam::Vec3;
use path_tracer::Film;
use scene::{AlphaMode, Environment, HeightMap, Limits, Scene, Warning, load};
use std::fmt::Write;
use std::path::Path;

pub(crate) fn run(arguments: &InfoArguments) -> Result<(), Failure> {
    let path = arguments.file.as_path();
    let (mut lines, warnings) = describe(path)?;
    match warnings.len() {
        0 => lines.push("no warnings".to_owned()),
        count => lines.push(format!("{count} {}:", if count == 1 { "warning" } else { "warnings" })),
    }
    lines.extend(warnings.iter().map(|warning| format!("  {warning}")));
    print(&(lines.join("\n") + "\n"));
    Ok(())
}

fn describe(path: &Path) -> Result<(Vec<String>, Vec<Warning>), Failure> {
    let limits = Limits::default();
    let is_height_map = path.extension().is_some_and(|extension| {
        ["png", "jpg", "jpeg"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    });
    if let Some(film) = pictures::film_if_it_is_one(path)? {
        return Ok((film_lines(path, &film), Vec::new()));
    }
    if load::is_environment(path) {
        let (environment, warnings) = load::environment(path, &limits)?;
        return Ok((environment_lines(path, &environment), warnings));
    }
    if is_height_map {
        let (map, warnings) = load::height_map(path, &limits)?;
        return Ok((height_map_lines(path, &map), warnings));
    }
    if !load::is_scene(path) && path.is_file() {
        let found =
            path.extension().map_or_else(|| "none".into(), |extension| format!(".{}", extension.display()));
        let expected = "a scene (.toml, .gltf, .glb, .obj), an environment (.hdr, .exr) or a height map (.png, .jpg, .exr)";
        return Err(scene::Error::new(path.display().to_string(), "extension", found, expected).into());
    }
    let mut scene = load::load_scene(path, &limits)?;
    let notes = settings::apply_scene(&mut Settings::FULL.clone(), &scene)?;
    scene.warnings.extend(notes);
    Ok((scene_lines(path, &scene), scene.warnings))
}

fn scene_lines(path: &Path, scene: &Scene) -> Vec<String> {
    let mut lines = vec![format!("{}: a scene", path.display())];
    lines.extend(counts(scene).into_iter().map(|(name, text)| row(name, &text)));
    if let Some(camera) = &scene.camera {
        let fov_deg = camera.fov_y_rad.to_degrees();
        let text = format!(
            "at {}, looks at {}, {fov_deg:.1} degrees high",
            vector(camera.eye),
            vector(camera.target)
        );
        lines.push(row("camera", &text));
    }
    if let Some(environment) = &scene.environment {
        lines.push(row("environment", &format!("{}, {}", environment.name, radiance(environment))));
    }
    for technique in scene.technique_settings.keys() {
        lines.push(row("settings", technique));
    }
    lines
}

/// What a scene has how many of; also what the window's panel shows.
pub(crate) fn counts(scene: &Scene) -> Vec<(&'static str, String)> {
    let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
    let texture_bytes: usize = scene.textures.iter().map(|texture| texture.rgba.len()).sum();
    let mut rows = vec![
        ("instances", scene.instances.len().to_string()),
        ("meshes", scene.meshes.len().to_string()),
        ("triangles", format!("{} as placed", scene.triangle_count())),
        ("vertices", vertices.to_string()),
        ("materials", materials(scene)),
        ("textures", format!("{} ({:.1} MiB)", scene.textures.len(), texture_bytes as f64 / 1048576.0)),
        ("lights", scene.lights.len().to_string()),
    ];
    if !scene.height_maps.is_empty() {
        rows.push(("height maps", scene.height_maps.len().to_string()));
    }
    if let Some((least, greatest)) = scene.bounds() {
        let size = greatest - least;
        rows.push(("size", format!("{:.4} x {:.4} x {:.4} m", size.x, size.y, size.z)));
    }
    rows
}

fn materials(scene: &Scene) -> String {
    let count = |mode: fn(&AlphaMode) -> bool| scene.materials.iter().filter(|m| mode(&m.alpha_mode)).count();
    let mut text = scene.materials.len().to_string();
    for (count, what) in [
        (count(|mode| matches!(mode, AlphaMode::Blend)), "blended"),
        (count(|mode| matches!(mode, AlphaMode::Mask { .. })), "with a cutoff"),
        (scene.materials.iter().filter(|material| material.clearcoat.factor > 0.0).count(), "coated"),
    ] {
        if count > 0 {
            // Writing to a string cannot fail.
            write!(text, ", {count} {what}").ok();
        }
    }
    text
}

fn environment_lines(path: &Path, environment: &Environment) -> Vec<String> {
    vec![
        format!("{}: an environment, latitude-longitude", path.display()),
        row("radiance", &radiance(environment)),
    ]
}

fn film_lines(path: &Path, film: &Film) -> Vec<String> {
    let [width, height] = film.size();
    let identity = film.identity();
    let mut lines = vec![
        format!("{}: a path-traced reference", path.display()),
        row("size", &format!("{width} x {height}")),
        row("scene", &identity.scene),
        row("samples", &film.samples().to_string()),
        row("seed", &identity.seed.to_string()),
        row("settings", &identity.settings),
        row("version", &identity.version),
        row("fingerprint", &identity.fingerprint_text()),
    ];
    if film.invalid() + film.clamped() > 0 {
        let text = format!("{} no radiance, {} beyond 2^30", film.invalid(), film.clamped());
        lines.push(row("odd samples", &text));
    }
    lines
}

/// Size, mean and greatest radiance.
fn radiance(environment: &Environment) -> String {
    let peak = environment.pixels.as_flattened().iter().copied().fold(0.0_f32, f32::max);
    let mean = environment.mean_radiance();
    format!("{} x {}, mean {}, peak {peak}", environment.width, environment.height, vector(mean))
}

fn height_map_lines(path: &Path, map: &HeightMap) -> Vec<String> {
    let (low, high) = map
        .heights
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &height| (low.min(height), high.max(height)));
    vec![
        format!("{}: an image, read as a height map", path.display()),
        row("pixels", &format!("{} x {}", map.width, map.height)),
        row("heights", &format!("{low} to {high}")),
    ]
}

fn row(name: &str, text: &str) -> String {
    format!("  {name:<12} {text}")
}

fn vector(vector: Vec3) -> String {
    format!("({:.4}, {:.4}, {:.4})", vector.x, vector.y, vector.z)
}
