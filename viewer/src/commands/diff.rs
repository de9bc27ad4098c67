//! `sheen diff`: how far a picture is from its reference.

use super::{Failure, print};
use crate::cli::{DiffArguments, METRICS};
use crate::output::{Format, png};
use crate::pictures::Picture;
use compositor::{ToneCurve, tone_map};
use image_error::flip::{self, ErrorMap, PIXELS_PER_DEGREE};
use image_error::{Errors, Image};
use scene::{Error, output::write_whole};

pub(crate) fn run(arguments: &DiffArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.heatmap {
        Format::of_path(path, &[Format::Png])?;
    }
    let found = Picture::read(&arguments.found)?;
    let reference = Picture::read(&arguments.reference)?;
    check_same_kind(&found, &reference)?;
    let metrics = metrics(arguments, &found)?;
    let heatmap_metric = heatmap_metric(arguments, &metrics)?;

    let errors = image_error::compare(&found.image, &reference.image)?;
    let mut lines = title(&found, &reference, &errors);
    for metric in metrics {
        let (line, map) = measure(metric, &found, &reference, &errors)?;
        lines.push(row(metric, &line));
        if let (Some(path), Some(map)) = (&arguments.heatmap, map)
            && heatmap_metric == Some(metric)
        {
            let size = [map.width() as u32, map.height() as u32];
            write_whole(path, &png(map.heat_map().as_flattened(), size).map_err(Failure::Other)?)?;
        }
    }
    lines.extend(noise(&found, &reference, &errors)?);
    print(&(lines.join("\n") + "\n"));
    Ok(())
}

fn row(name: &str, text: &str) -> String {
    format!("  {name:<10} {text}")
}

/// Refuses pictures of other sizes, and one made for displays beside one that is not: their
/// difference would be that of the tone curve.
fn check_same_kind(found: &Picture, reference: &Picture) -> Result<(), Error> {
    let kind = |picture: &Picture| if picture.is_displayed { "8-bit sRGB" } else { "linear" };
    let size = |picture: &Picture| format!("{} x {} pixels", picture.image.width(), picture.image.height());
    for (place, own, expected) in
        [("values", kind(found).into(), kind(reference).into()), ("size", size(found), size(reference))]
    {
        let (own, expected): (String, String) = (own, expected);
        if own != expected {
            return Err(Error::new(&found.name, place, own, format!("{expected} as in {}", reference.name)));
        }
    }
    Ok(())
}

/// What to print, in the usual order.
fn metrics(arguments: &DiffArguments, found: &Picture) -> Result<Vec<&'static str>, Failure> {
    let is_named = |metric: &str| arguments.metrics.iter().any(|named| named == metric);
    if found.is_displayed && is_named(HDR_FLIP) {
        let message = "hdr-flip needs linear pictures (.exr, .hdr), found 8-bit ones; expected --metric flip";
        return Err(Failure::Usage(message.into()));
    }
    let all = METRICS.into_iter().filter(|&metric| !found.is_displayed || metric != HDR_FLIP);
    Ok(all.filter(|metric| arguments.metrics.is_empty() || is_named(metric)).collect())
}

const FLIP: &str = "flip";
const HDR_FLIP: &str = "hdr-flip";

/// What a heat map shows, if there is to be one: HDR-FLIP where it is named and FLIP is not.
fn heatmap_metric(
    arguments: &DiffArguments,
    metrics: &[&'static str],
) -> Result<Option<&'static str>, Failure> {
    if arguments.heatmap.is_none() {
        return Ok(None);
    }
    match [FLIP, HDR_FLIP].into_iter().find(|metric| metrics.contains(metric)) {
        Some(metric) => Ok(Some(metric)),
        None => Err(Failure::Usage(
            "a heat map shows flip or hdr-flip; expected one of them among the metrics".into(),
        )),
    }
}

fn title(found: &Picture, reference: &Picture, errors: &Errors) -> Vec<String> {
    let (width, height) = (found.image.width(), found.image.height());
    let mut lines = vec![format!("{} against {}: {width} x {height} pixels", found.name, reference.name)];
    if errors.non_finite > 0 {
        lines.push(row("non-finite", &format!("{} pixels, left out of all that follows", errors.non_finite)));
    }
    lines
}

/// One line of the report, and what a heat map of it would show.
fn measure(
    metric: &str,
    found: &Picture,
    reference: &Picture,
    errors: &Errors,
) -> Result<(String, Option<ErrorMap>), Failure> {
    let of_map = |map: &ErrorMap| {
        let numbers = map.statistics();
        format!(
            "{:.5} on average, weighted median {:.5}, largest {:.5}",
            numbers.mean, numbers.weighted_median, numbers.max
        )
    };
    Ok(match metric {
        "relmse" => (format!("{:.4e}", errors.relative_mse), None),
        "mae" => {
            let Errors { mean_absolute, percentile_99_9, largest, .. } = errors;
            (
                format!(
                    "{mean_absolute:.4e}, 99.9 % of pixels within {percentile_99_9:.4e}, largest {largest:.4e}"
                ),
                None,
            )
        }
        "bias" => {
            let percent = 100.0 * errors.relative_bias;
            (format!("{:+.4e}, {percent:+.4} % of the reference", errors.mean_signed), None)
        }
        FLIP => {
            let map = flip::ldr(&displayed(found)?, &displayed(reference)?, PIXELS_PER_DEGREE)?;
            (of_map(&map), Some(map))
        }
        _ => match flip::hdr(&found.image, &reference.image, PIXELS_PER_DEGREE) {
            Ok(flip::Hdr { map, exposures, .. }) => {
                let line =
                    format!("{}, from {:+.1} to {:+.1} stops", of_map(&map), exposures.start, exposures.stop);
                (line, Some(map))
            }
            Err(error @ image_error::Error::BlackReference) => (format!("none: {error}"), None),
            Err(error) => return Err(error.into()),
        },
    })
}

/// The picture as a display shows it, in linear values of 0 to 1: by the same curve as `sheen render`
/// does. Pixels that are not finite stay so.
fn displayed(picture: &Picture) -> Result<Image, image_error::Error> {
    if picture.is_displayed {
        return Ok(picture.image.clone());
    }
    let display = |&pixel: &[f32; 3]| {
        if pixel.iter().all(|value| value.is_finite()) {
            tone_map::display_linear(pixel, 0.0, ToneCurve::PbrNeutral)
        } else {
            [f32::NAN; 3]
        }
    };
    let pixels = picture.image.pixels().iter().map(display).collect();
    Image::new(picture.image.width(), picture.image.height(), pixels)
}

/// How much of the relative squared error is noise of the reference, and of the picture where it is
/// one too; a warning where the noise is the larger part.
fn noise(found: &Picture, reference: &Picture, errors: &Errors) -> Result<Option<String>, Failure> {
    let Some(variance) = &reference.variance else { return Ok(None) };
    let mut variance = variance.clone();
    for (own, other) in variance.iter_mut().zip(found.variance.iter().flatten()) {
        *own = std::array::from_fn(|channel| own[channel] + other[channel]);
    }
    let noise = image_error::noise_relative_mse(&reference.image, &variance)?;
    // What was found is the error itself and, on average, the noise.
    if noise >= errors.relative_mse - noise {
        eprintln!(
            "warning: {}: its own noise is {noise:.4e} of the relmse of {:.4e}; expected more samples per pixel",
            reference.name, errors.relative_mse
        );
    }
    Ok(Some(row("noise", &format!("{noise:.4e} of the relmse, on average"))))
}
