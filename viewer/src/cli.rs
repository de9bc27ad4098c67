//! The command line. Scripts depend on it, so it only grows.

use crate::{inputs::EnvironmentSource, settings, settings::Assignment};
use clap::{Args, Parser, Subcommand, builder::PossibleValuesParser};
use compositor::ToneCurve;
use glam::Vec3;
use std::path::PathBuf;

/// Views and renders scenes with Sheen's techniques.
///
/// Without a command it opens a window. FILE is a scene (.toml, .gltf, .glb, .obj), an
/// environment map that lights it (.hdr, .exr), or one of each.
#[derive(Debug, Parser)]
#[command(name = "sheen", version, args_conflicts_with_subcommands = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// What to show; a built-in scene when there is none
    #[arg(value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render one picture to a file
    Render(RenderArguments),
    /// Say what a file holds: counts, and every warning
    Info(InfoArguments),
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// A scene (.toml, .gltf, .glb, .obj, or the built-in "showroom"), and an .hdr or .exr to light it
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Where the picture goes: F.exr (linear) or F.png (tone mapped)
    #[arg(long, short, value_name = "F.exr|F.png")]
    pub(crate) out: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(crate) size: [u32; 2],
    /// Run only the techniques named; all that the scene needs when none is
    #[arg(long = "technique", value_name = "T", value_parser = PossibleValuesParser::new(settings::names()))]
    pub(crate) techniques: Vec<String>,
    /// Change a setting of a technique
    #[arg(long = "set", value_name = "technique.field=value", value_parser = Assignment::parse)]
    pub(crate) assignments: Vec<Assignment>,
    /// What lights the scene: a built-in environment, a file, or "none"
    #[arg(long, value_name = "NAME|FILE", value_parser = EnvironmentSource::parse)]
    pub(crate) environment: Option<EnvironmentSource>,
    /// Turn of the environment about +Y in degrees, counter-clockwise seen from above
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
    pub(crate) rotation: Option<f32>,
    /// Exposure of a PNG in stops
    #[arg(long, value_name = "EV", default_value = "0", allow_negative_numbers = true, value_parser = number)]
    pub(crate) exposure: f32,
    /// Tone curve of a PNG: linear, pbr-neutral or aces
    #[arg(long, value_name = "CURVE", default_value = "pbr-neutral", value_parser = tone_curve)]
    pub(crate) tone_curve: ToneCurve,
    /// Where the camera stands, in metres
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    pub(crate) eye: Option<Vec3>,
    /// What the camera looks at, in metres
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    pub(crate) target: Option<Vec3>,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// A scene, an environment map, or a height map (.png, .jpg, .exr)
    pub(crate) file: PathBuf,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text
        .split_once(['x', 'X'])
        .and_then(|(width, height)| Some([width.trim().parse().ok()?, height.trim().parse().ok()?]));
    let Some([width, height]) = sides else {
        return Err("expected width and height, such as 1280x720".into());
    };
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) > compositor::MAX_PIXELS {
        return Err(format!("expected 1 to {} pixels in all", compositor::MAX_PIXELS));
    }
    Ok([width, height])
}

fn number(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|number: &f32| number.is_finite()).ok_or_else(|| "expected a number".into())
}

fn vector(text: &str) -> Result<Vec3, String> {
    match settings::numbers(text).as_deref() {
        Some(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err("expected three numbers, such as 0,1.5,4".into()),
    }
}

fn tone_curve(text: &str) -> Result<ToneCurve, String> {
    ToneCurve::ALL
        .into_iter()
        .find(|curve| curve.name() == text)
        .ok_or_else(|| format!("expected one of: {}", ToneCurve::ALL.map(ToneCurve::name).join(", ")))
}
