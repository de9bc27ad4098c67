//! The page of `compare`.

use super::{Compared, Report, Verdict};
use crate::{
    report::{Cell, Page, png, radiance_png},
    technique::{Failure, Kind, Metric, Role},
};

/// Figures that a limit does not depend on have three digits; errors below the truth's noise are
/// marked.
pub(super) fn page(report: &Report) -> Result<Page, Failure> {
    let mut page = Page::new("Sheen: how wrong each method is", &report.header);
    page.paragraph(
        "Two errors, always apart. Approximation: against the converged value of the technique's own integral. \
         Model: against full light transport in the path tracer.",
    );
    summary(&mut page, report);
    for (index, compared) in report.comparisons.iter().enumerate() {
        comparison(&mut page, index, compared)?;
    }
    Ok(page)
}

fn summary(page: &mut Page, report: &Report) {
    page.heading(2, "Limits", "limits");
    let judged = report.comparisons.iter().flat_map(|compared| &compared.thresholds);
    let kept = judged.clone().filter(|judged| judged.verdict == Verdict::Passed).count();
    let line = format!("{kept} of {} limits are kept.", judged.count());
    if report.passed {
        page.good(&line);
    } else {
        page.bad(&line);
    }
    for complaint in report.comparisons.iter().flat_map(Compared::complaints) {
        page.bad(&complaint);
    }
    if !report.not_run.is_empty() {
        page.bad(&format!("Not run: {}", report.not_run.join("; ")));
    }
    page.heading(3, "All comparisons", "all");
    let links: Vec<(String, String)> = report
        .comparisons
        .iter()
        .enumerate()
        .map(|(index, compared)| (compared.title(), format!("comparison-{index}")))
        .collect();
    page.links(&links);
    let mut rows = Vec::new();
    for compared in &report.comparisons {
        for row in compared.methods.iter().filter(|row| row.role == Role::Ours) {
            let error = |metric: Metric| row.errors.get(metric.name()).copied().map_or(none(), Cell::number);
            rows.push(vec![
                Cell::text(compared.title()),
                Cell::text(kind(compared.kind)),
                Cell::text(&row.method),
                error(Metric::RelativeMse),
                error(Metric::MeanAbsolute),
                error(Metric::Flip),
            ]);
        }
    }
    let head = ["comparison", "error", "method", "relMSE", "mean |error|", "FLIP"];
    page.table(&head, &rows, |_| false);
}

fn comparison(page: &mut Page, index: usize, compared: &Compared) -> Result<(), Failure> {
    page.heading(2, &compared.title(), &format!("comparison-{index}"));
    page.quiet(&format!(
        "{} error; {} x {} pixels, {} of them compared. Truth: {}",
        kind(compared.kind),
        compared.size[0],
        compared.size[1],
        compared.pixel_count,
        compared.truth
    ));
    for line in compared.complaints() {
        page.bad(&line);
    }
    errors(page, compared);
    limits(page, compared);
    pictures(page, compared)
}

fn errors(page: &mut Page, compared: &Compared) {
    let metrics = compared.metrics();
    let ours = compared.methods.iter().find(|row| row.role == Role::Ours);
    let title = |metric: &Metric| match compared.units.get(metric.name()) {
        Some(unit) if !unit.is_empty() => format!("{}, {unit}", metric.title()),
        _ => metric.title().to_owned(),
    };
    let titles: Vec<String> = metrics.iter().map(title).collect();
    let mut head = vec!["method"];
    head.extend(titles.iter().map(String::as_str));
    head.push("relMSE / ours");
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for row in &compared.methods {
        let error = |metric: &Metric| row.errors.get(metric.name()).copied();
        let mut cells = vec![Cell::text(&row.method)];
        cells.extend(metrics.iter().map(|metric| error(metric).map_or(none(), Cell::number)));
        let name = Metric::RelativeMse.name();
        let ratio = ours.and_then(|ours| Some(row.errors.get(name)? / ours.errors.get(name)?));
        cells.push(ratio.filter(|ratio| ratio.is_finite()).map_or(none(), Cell::number));
        rows.push(cells);
    }
    if let Some(noise) = &compared.noise {
        let mut cells = vec![Cell::Quiet("noise of the truth".into())];
        let value = |metric: &Metric| noise.get(metric.name()).copied();
        cells.extend(metrics.iter().map(|metric| value(metric).map_or(none(), Cell::number)));
        cells.push(none());
        rows.push(cells);
    }
    let is_ours = |index: usize| compared.methods.get(index).is_some_and(|row| row.role == Role::Ours);
    page.table(&head, &rows, is_ours);
}

fn limits(page: &mut Page, compared: &Compared) {
    if compared.thresholds.is_empty() {
        return;
    }
    let rows: Vec<Vec<Cell>> = compared
        .thresholds
        .iter()
        .map(|judged| {
            let verdict = match judged.verdict {
                Verdict::Passed => Cell::Good("kept".into()),
                Verdict::Missed => Cell::Bad("missed".into()),
                Verdict::Refused => Cell::Bad("cannot be judged".into()),
                Verdict::Unknown => Cell::Bad("nothing to judge".into()),
            };
            vec![
                Cell::text(&judged.method),
                Cell::text(judged.title),
                judged.found.map_or(none(), Cell::number),
                Cell::number(judged.at_most),
                verdict,
                Cell::Quiet(judged.reason.to_owned()),
            ]
        })
        .collect();
    page.table(&["method", "error", "found", "at most", "", "reason"], &rows, |_| false);
}

fn pictures(page: &mut Page, compared: &Compared) -> Result<(), Failure> {
    let Some(truth) = &compared.shown else { return Ok(()) };
    let size = [truth.image.width(), truth.image.height()];
    let mut pictures = vec![(radiance_png(&truth.image, truth.exposure_ev)?, size, "truth".to_owned())];
    for row in &compared.methods {
        let shown = radiance_png(&row.picture, truth.exposure_ev)?;
        pictures.push((shown, size, row.method.clone()));
        let what = if truth.is_table { "relative error" } else { "FLIP" };
        let map = png(row.map.width, row.map.height, &row.map.rgb)?;
        pictures.push((map, size, format!("{what} of {}", row.method)));
    }
    page.pictures(&pictures);
    if !compared.seen.is_empty() {
        page.paragraph(compared.seen);
    }
    Ok(())
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Approximation => "approximation",
        Kind::Model => "model",
    }
}

fn none() -> Cell {
    Cell::Quiet("-".into())
}
