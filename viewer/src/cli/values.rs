//! The values of options.

use crate::settings;
use compositor::ToneCurve;
use glam::Vec3;
use path_tracer::{Lobe, PixelFilter, film::MAX_SAMPLES_PER_PIXEL};
use std::ops::Range;

pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
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

pub(super) fn number(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|number: &f32| number.is_finite()).ok_or_else(|| "expected a number".into())
}

pub(super) fn vector(text: &str) -> Result<Vec3, String> {
    match settings::numbers(text).as_deref() {
        Some(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err("expected three numbers, such as 0,1.5,4".into()),
    }
}

pub(super) fn tone_curve(text: &str) -> Result<ToneCurve, String> {
    ToneCurve::ALL
        .into_iter()
        .find(|curve| curve.name() == text)
        .ok_or_else(|| format!("expected one of: {}", ToneCurve::ALL.map(ToneCurve::name).join(", ")))
}

pub(super) fn sample_count(text: &str) -> Result<u32, String> {
    let expected = || format!("expected 1 to {MAX_SAMPLES_PER_PIXEL}");
    text.parse().ok().filter(|count| (1..=MAX_SAMPLES_PER_PIXEL).contains(count)).ok_or_else(expected)
}

pub(super) fn samples(text: &str) -> Result<Range<u32>, String> {
    let ends = text.split_once("..").and_then(|(start, end)| Some(start.parse().ok()?..end.parse().ok()?));
    ends.filter(|range: &Range<u32>| range.start < range.end)
        .filter(|range| range.end - range.start <= MAX_SAMPLES_PER_PIXEL)
        .ok_or_else(|| {
            format!("expected a range of 1 to {MAX_SAMPLES_PER_PIXEL} samples, such as 0..64 or 64..128")
        })
}

pub(super) fn lobe(text: &str) -> Result<Lobe, String> {
    let lobes = [
        ("ggx", Lobe::Ggx),
        ("blinn", Lobe::Blinn),
        ("phong-cone", Lobe::PhongCone),
        ("diffused-environment", Lobe::DiffusedEnvironment),
    ];
    one_of(text, &lobes)
}

pub(super) fn pixel_filter(text: &str) -> Result<PixelFilter, String> {
    let gaussian = PixelFilter::Gaussian { sigma_pixels: 0.5 };
    one_of(text, &[("box", PixelFilter::Box), ("gaussian", gaussian), ("point", PixelFilter::Point)])
}

fn one_of<T: Copy>(text: &str, choices: &[(&str, T)]) -> Result<T, String> {
    choices.iter().find(|(name, _)| *name == text).map(|&(_, choice)| choice).ok_or_else(|| {
        format!("expected one of: {}", choices.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "))
    })
}
