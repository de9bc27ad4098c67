//! Writes the environments and height maps of the `assets` folder.
//!
//! `cargo run --release -p scene --example generate_assets [FOLDER]`; without a folder it writes
//! where the repository keeps them.

use std::error::Error;
use std::f32::consts::{PI, TAU};
use std::fs::File;
use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
    WritableImage,
};
use glam::Vec2;
use half::f16;
use image::{ImageBuffer, Luma, Rgb};
use scene::{Environment, builtin};

/// Texels per side of the height maps.
const SIDE: u32 = 128;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os()
        .nth(1)
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets"), PathBuf::from);
    let environments = folder.join("environments");
    let height_maps = folder.join("height_maps");
    std::fs::create_dir_all(&environments)?;
    std::fs::create_dir_all(&height_maps)?;

    write_exr(&environments.join("studio_128.exr"), &built_in("studio")?)?;
    write_hdr(&environments.join("sky_128.hdr"), &built_in("sky")?)?;
    write_exr(&environments.join("lamp_64.exr"), &lamp()?)?;

    write_png(&height_maps.join("ripples_16.png"), ripples)?;
    write_png(&height_maps.join("domes_16.png"), domes)?;
    write_png(&height_maps.join("hills_16.png"), hills)?;
    Ok(())
}

fn built_in(name: &str) -> Result<Environment, Box<dyn Error>> {
    builtin::environment_sized(name, 128).ok_or_else(|| format!("no environment {name}").into())
}

/// One bright texel at +X, half way up, in a dim grey room: what any blur or lobe does to it shows.
fn lamp() -> Result<Environment, scene::Error> {
    let (width, height) = (64, 32);
    let mut pixels = vec![[0.02; 3]; (width * height) as usize];
    let [u, v] = Environment::uv_of(glam::Vec3::new(1.0, 1.0, 0.0).normalize());
    let (column, row) = ((u * width as f32) as u32, (v * height as f32) as u32);
    pixels[(row * width + column) as usize] = [2000.0, 1600.0, 1000.0];
    Environment::new("lamp", width, height, pixels)
}

/// Rings around the middle that fade out before the border, so that the map repeats.
fn ripples(place: Vec2) -> f32 {
    let from_middle = (place - 0.5).length();
    let fade = (1.0 - from_middle / 0.5).clamp(0.0, 1.0);
    0.5 + 0.5 * fade * fade * (3.0 - 2.0 * fade) * (TAU * 7.0 * from_middle).cos()
}

/// Four by four hemispheres on a plane; every second row is shifted by half a step.
fn domes(place: Vec2) -> f32 {
    let row = (place.y * 4.0).floor();
    let shifted = Vec2::new(place.x * 4.0 + 0.5 * (row % 2.0), place.y * 4.0);
    let from_middle = (shifted - shifted.floor() - 0.5).length() / 0.45;
    (1.0 - from_middle * from_middle).max(0.0).sqrt()
}

/// Waves of growing frequency and sinking height in turning directions, all of whole periods.
fn hills(place: Vec2) -> f32 {
    let waves =
        [(1, 1, 0.0), (-2, 1, 1.3), (2, 3, 2.9), (-3, 4, 0.4), (5, 3, 5.1), (-6, 5, 3.7), (9, 4, 1.9)];
    let sum: f32 = waves
        .iter()
        .map(|&(x, y, phase): &(i32, i32, f32)| {
            let frequency = Vec2::new(x as f32, y as f32);
            // Sharp ridges: the absolute value folds the wave's valleys up.
            (1.0 - (PI * frequency.dot(place) + phase).sin().abs()) / frequency.length()
        })
        .sum();
    (sum / 1.9).clamp(0.0, 1.0)
}

/// A 16-bit grey PNG of a height over 0..1 x 0..1, sampled at texel centres.
fn write_png(path: &Path, height: fn(Vec2) -> f32) -> Result<(), Box<dyn Error>> {
    let image = ImageBuffer::<Luma<u16>, _>::from_fn(SIDE, SIDE, |x, y| {
        let place = (Vec2::new(x as f32, y as f32) + 0.5) / SIDE as f32;
        Luma([(height(place) * 65535.0).round() as u16])
    });
    image.save(path)?;
    Ok(())
}

/// A Radiance file.
fn write_hdr(path: &Path, environment: &Environment) -> Result<(), Box<dyn Error>> {
    let pixels: Vec<Rgb<f32>> = environment.pixels.iter().map(|&pixel| Rgb(pixel)).collect();
    image::codecs::hdr::HdrEncoder::new(File::create(path)?).encode(
        &pixels,
        environment.width as usize,
        environment.height as usize,
    )?;
    Ok(())
}

/// An EXR file of half floats.
fn write_exr(path: &Path, environment: &Environment) -> Result<(), Box<dyn Error>> {
    let channel = |(index, name): (usize, &str)| {
        let samples = environment.pixels.iter().map(|pixel| f16::from_f32(pixel[index])).collect();
        AnyChannel::new(name, FlatSamples::F16(samples))
    };
    let channels: SmallVec<_> = ["R", "G", "B"].into_iter().enumerate().map(channel).collect();
    let layer = Layer::new(
        (environment.width as usize, environment.height as usize),
        LayerAttributes::default(),
        Encoding { compression: Compression::ZIP16, ..Encoding::UNCOMPRESSED },
        AnyChannels::sort(channels),
    );
    Image::from_layer(layer).write().non_parallel().to_file(path)?;
    Ok(())
}
