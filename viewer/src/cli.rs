//! The command line. Scripts depend on it, so it only grows.

mod values;

use crate::{inputs::EnvironmentSource, settings, settings::Assignment};
use clap::{Args, Parser, Subcommand, builder::PossibleValuesParser};
use compositor::ToneCurve;
use glam::Vec3;
use path_tracer::{Lobe, PixelFilter};
use std::ops::Range;
use std::path::PathBuf;
use values::{lobe, number, pixel_filter, sample_count, samples, size, tone_curve, vector};

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
    /// Path trace the picture that all others are measured against
    Reference(ReferenceArguments),
    /// Put references of different samples of one picture together, exactly
    Merge(MergeArguments),
    /// Say how far a picture is from its reference
    Diff(DiffArguments),
    /// Say what a file holds: counts, and every warning
    Info(InfoArguments),
}

/// What is shown, and from where.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// A scene (.toml, .gltf, .glb, .obj, or the built-in "showroom"), and an .hdr or .exr to light it
    #[arg(value_name = "SCENE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(crate) size: [u32; 2],
    /// What lights the scene: a built-in environment, a file, or "none"
    #[arg(long, value_name = "NAME|FILE", value_parser = EnvironmentSource::parse)]
    pub(crate) environment: Option<EnvironmentSource>,
    /// Turn of the environment about +Y in degrees, counter-clockwise seen from above
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
    pub(crate) rotation: Option<f32>,
    /// Where the camera stands, in metres
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    pub(crate) eye: Option<Vec3>,
    /// What the camera looks at, in metres
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    pub(crate) target: Option<Vec3>,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Where the picture goes: F.exr (linear) or F.png (tone mapped)
    #[arg(long, short, value_name = "F.exr|F.png")]
    pub(crate) out: PathBuf,
    /// Run only the techniques named; all that the scene needs when none is
    #[arg(long = "technique", value_name = "T", value_parser = PossibleValuesParser::new(settings::names()))]
    pub(crate) techniques: Vec<String>,
    /// Change a setting of a technique
    #[arg(long = "set", value_name = "technique.field=value", value_parser = Assignment::parse)]
    pub(crate) assignments: Vec<Assignment>,
    /// Exposure of a PNG in stops
    #[arg(long, value_name = "EV", default_value = "0", allow_negative_numbers = true, value_parser = number)]
    pub(crate) exposure: f32,
    /// Tone curve of a PNG: linear, pbr-neutral or aces
    #[arg(long, value_name = "CURVE", default_value = "pbr-neutral", value_parser = tone_curve)]
    pub(crate) tone_curve: ToneCurve,
}

#[derive(Debug, Args)]
pub(crate) struct ReferenceArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Where the picture goes, with its variance and its exact sums
    #[arg(long, short, value_name = "F.exr")]
    pub(crate) out: PathBuf,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value = "64", value_parser = sample_count, conflicts_with = "samples")]
    pub(crate) spp: u32,
    /// Only these samples of every pixel, the last one excluded; disjoint ranges can be merged
    #[arg(long, value_name = "A..B", value_parser = samples)]
    pub(crate) samples: Option<Range<u32>>,
    /// How often light is reflected at most: 0 shows what emits, 1 adds direct light
    #[arg(long, value_name = "N", default_value = "16")]
    pub(crate) max_bounces: u32,
    /// Other seeds give independent pictures
    #[arg(long, value_name = "S", default_value = "0")]
    pub(crate) seed: u64,
    /// The specular part of materials: ggx, blinn, phong-cone or diffused-environment
    #[arg(long, value_name = "LOBE", default_value = "ggx", value_parser = lobe)]
    pub(crate) lobe: Lobe,
    /// Leave out all occlusion and interreflection, as environment-map techniques do
    #[arg(long)]
    pub(crate) far_field: bool,
    /// How samples lie in a pixel: box, gaussian, or point (at its centre, as `sheen render` does)
    #[arg(long, value_name = "FILTER", default_value = "box", value_parser = pixel_filter)]
    pub(crate) pixel_filter: PixelFilter,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// References of different samples of one picture
    #[arg(value_name = "F.exr", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Where the reference of all samples goes
    #[arg(long, short, value_name = "F.exr")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct DiffArguments {
    /// The picture to judge (.exr, .hdr, .png)
    #[arg(value_name = "A")]
    pub(crate) found: PathBuf,
    /// What it should look like; a picture of the same kind and size
    #[arg(value_name = "B")]
    pub(crate) reference: PathBuf,
    /// Print only these; all that fit when none is named
    #[arg(long = "metric", value_name = "METRIC", value_parser = PossibleValuesParser::new(METRICS))]
    pub(crate) metrics: Vec<String>,
    /// A picture of where the difference is seen, from black (nowhere) to light yellow
    #[arg(long, value_name = "F.png")]
    pub(crate) heatmap: Option<PathBuf>,
}

/// What `sheen diff` prints.
pub(crate) const METRICS: [&str; 5] = ["relmse", "mae", "bias", "flip", "hdr-flip"];

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// A scene, an environment map, or a height map (.png, .jpg, .exr)
    pub(crate) file: PathBuf,
}
