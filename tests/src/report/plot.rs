//! Plots as SVG.

use super::number;
use crate::technique::{Axis, Failure, Plot, Series};
use plotters::{
    coord::{
        Shift,
        ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
    },
    prelude::*,
};
use std::ops::Range;

const SIZE: (u32, u32) = (920, 440);
/// Pixels of the legend, to the right of the axes.
const LEGEND: u32 = 220;

/// Colours that people with a colour deficiency tell apart (Okabe and Ito).
const COLORS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
    RGBColor(0, 0, 0),
];

/// The plot as an SVG element; fails where it has no point that can be drawn.
pub(crate) fn svg(plot: &Plot) -> Result<String, Failure> {
    let drawable = |point: &[f64; 2]| can_draw(point[0], &plot.x) && can_draw(point[1], &plot.y);
    let series: Vec<Series> = plot
        .series
        .iter()
        .map(|series| Series {
            points: series.points.iter().copied().filter(drawable).collect(),
            ..series.clone()
        })
        .filter(|series| !series.points.is_empty())
        .collect();
    let range = |axis: &Axis, index: usize| {
        let values = series.iter().flat_map(|series| &series.points).map(|point| point[index]);
        range_of(values, axis.is_log)
    };
    let (Some(x), Some(y)) = (range(&plot.x, 0), range(&plot.y, 1)) else {
        return Err(format!("nothing to draw in the plot \"{}\"", plot.title).into());
    };
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        match (plot.x.is_log, plot.y.is_log) {
            (true, true) => draw(&area, plot, &series, x.log_scale(), y.log_scale()),
            (true, false) => draw(&area, plot, &series, x.log_scale(), y),
            (false, true) => draw(&area, plot, &series, x, y.log_scale()),
            (false, false) => draw(&area, plot, &series, x, y),
        }?;
        area.present()?;
    }
    Ok(text)
}

/// Whether a value has a place on an axis.
fn can_draw(value: f64, axis: &Axis) -> bool {
    value.is_finite() && (!axis.is_log || value > 0.0)
}

/// The range of values with some room around it; `None` where there are none.
fn range_of(values: impl Iterator<Item = f64>, is_log: bool) -> Option<Range<f64>> {
    let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if least > greatest {
        return None;
    }
    if is_log {
        // At least a decade, so that there are marks on the axis.
        let room = (greatest / least).powf(0.06).max(if greatest < 10.0 * least { 3.2 } else { 1.0 });
        return Some(least / room..greatest * room);
    }
    let room = 0.06 * (greatest - least);
    let room = if room > 0.0 { room } else { 0.5 * least.abs().max(1.0) };
    Some(least - room..greatest + room)
}

/// The names of the series beside their colours.
fn legend(area: &DrawingArea<SVGBackend<'_>, Shift>, series: &[Series]) -> Result<(), Failure> {
    for (line, (series, color)) in series.iter().zip(COLORS.iter().cycle()).enumerate() {
        let y = 56 + 20 * line as i32;
        area.draw(&Circle::new((14, y), 4, color.filled()))?;
        area.draw(&Text::new(series.name.clone(), (26, y - 6), ("sans-serif", 13)))?;
    }
    Ok(())
}

/// Axes, series and legend on any two kinds of axis.
fn draw<X, Y>(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    plot: &Plot,
    series: &[Series],
    x: X,
    y: Y,
) -> Result<(), Failure>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    // The legend has its own place, where it hides nothing.
    let (area, beside) = area.split_horizontally(SIZE.0 - LEGEND);
    legend(&beside, series)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(&plot.title, ("sans-serif", 17))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(74)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .light_line_style(RGBColor(240, 240, 240))
        .bold_line_style(RGBColor(215, 215, 215))
        .x_desc(&plot.x.label)
        .y_desc(&plot.y.label)
        .axis_desc_style(("sans-serif", 14))
        .label_style(("sans-serif", 12))
        .x_label_formatter(&|value| number(*value))
        .y_label_formatter(&|value| number(*value))
        .draw()?;
    for (series, color) in series.iter().zip(COLORS.iter().cycle()) {
        let points = || series.points.iter().map(|&[x, y]| (x, y));
        if series.is_line {
            chart.draw_series(LineSeries::new(points(), color.stroke_width(2)))?;
        }
        chart.draw_series(points().map(|point| Circle::new(point, 4, color.filled())))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(is_log: bool, points: Vec<[f64; 2]>) -> Plot {
        let axis = |label: &str| Axis { label: label.into(), is_log };
        let line = Series { name: "ours <b>".into(), points, is_line: true };
        let dot = Series { name: "paper".into(), points: vec![[3.0, 3.0]], is_line: false };
        Plot { title: "error & time".into(), x: axis("ms"), y: axis("relMSE"), series: vec![line, dot] }
    }

    #[test]
    fn points_that_have_no_place_are_left_out() {
        let points = vec![[1.0, 1e-3], [0.0, 1.0], [10.0, -1.0], [f64::NAN, 1.0], [100.0, 1e-5]];
        let text = svg(&plot(true, points.clone())).unwrap();
        // Two of the line, one of the dot, and one each in the legend.
        assert_eq!(text.matches("<circle").count(), 5, "{text}");
        assert_eq!(svg(&plot(false, points)).unwrap().matches("<circle").count(), 7);
        let empty = Plot { series: Vec::new(), ..plot(true, Vec::new()) };
        assert!(svg(&empty).is_err());
    }

    #[test]
    fn labels_are_escaped() {
        let text = svg(&plot(true, vec![[1.0, 1.0]])).unwrap();
        assert!(!text.contains("<b>") && text.contains("error &amp; time"), "{text}");
    }
}
