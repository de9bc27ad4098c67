//! The page of `bench`.

use super::{Benched, Clock, Measured, Report, Row, SkipRow};
use crate::{
    report::{Cell, Page, number, svg},
    technique::{Axis, Metric, Plot, Role, Series},
};
use std::collections::BTreeMap;

pub(super) fn page(report: &Report) -> Page {
    let mut page = Page::new("Sheen: what each method costs", &report.header);
    page.paragraph(
        "The subjects of a table took turns in one process. Ratios hold on this adapter; times of a software \
         adapter are no times of a GPU. Time is the median of a frame and its 95th percentile; preparing is what \
         has to be made anew when the environment changes.",
    );
    for line in report.complaints() {
        page.bad(&line);
    }
    if !report.not_run.is_empty() {
        page.bad(&format!("Not run: {}", report.not_run.join("; ")));
    }
    let links: Vec<(String, String)> = report
        .benchmarks
        .iter()
        .enumerate()
        .map(|(index, benched)| (benched.title.clone(), format!("benchmark-{index}")))
        .chain(report.measurements.iter().map(|measured| (measured.title(), measured.name.clone())))
        .collect();
    page.links(&links);
    for (index, benched) in report.benchmarks.iter().enumerate() {
        benchmark(&mut page, index, benched);
    }
    skips(&mut page, report);
    for measured in &report.measurements {
        measurement(&mut page, measured);
    }
    page
}

fn benchmark(page: &mut Page, index: usize, benched: &Benched) {
    page.heading(2, &benched.title, &format!("benchmark-{index}"));
    let Some(first) = benched.rows.first() else { return };
    let clock = match first.clock {
        Some(Clock::Adapter) => "by the adapter's own clock",
        _ => "by the wall clock, from recording to completion",
    };
    let rounds = first.time_ms.map_or(0, |times| times.count);
    page.quiet(&format!(
        "{} x {} pixels, {rounds} rounds after warm-up, {clock}",
        first.size[0], first.size[1]
    ));
    if let Some(truth) = &benched.truth {
        page.quiet(&format!("Errors against: {truth}"));
    }
    table(page, &benched.rows);
    for metric in [Metric::RelativeMse, Metric::MeanAbsolute] {
        if let Some(plot) = error_over_time(benched, metric).and_then(|plot| svg(&plot).ok()) {
            page.plot(&plot);
        }
    }
}

fn table(page: &mut Page, rows: &[Row]) {
    let has = |is: fn(&Row) -> bool| rows.iter().any(is);
    let has_error = has(|row| !row.error.is_empty());
    let (has_rate, has_prepare) = (has(|row| row.rate.is_some()), has(|row| row.prepare_ms.is_some()));
    let has_memory = has(|row| row.memory_bytes.is_some());
    let mut head = vec!["method", "median, ms", "95 %, ms", "time / ours"];
    head.extend(has_prepare.then_some("preparing, ms"));
    head.extend(has_memory.then_some("memory, MiB"));
    if has_error {
        head.extend(["relMSE", "mean |error|", "99.9 %"]);
    }
    head.extend(has_rate.then_some("per second"));
    head.extend(["passes", "skipped"]);
    let cells = |row: &Row| {
        let error = |metric: Metric| optional(row.error.get(metric.name()).copied());
        let mut cells = vec![
            Cell::text(&row.method),
            optional(row.time_ms.map(|times| times.median)),
            optional(row.time_ms.map(|times| times.p95)),
            optional(row.ratio),
        ];
        cells.extend(has_prepare.then(|| optional(row.prepare_ms)));
        cells.extend(
            has_memory.then(|| optional(row.memory_bytes.map(|bytes| bytes as f64 / (1 << 20) as f64))),
        );
        if has_error {
            cells.extend([Metric::RelativeMse, Metric::MeanAbsolute, Metric::Percentile999].map(error));
        }
        if has_rate {
            let rate = row.rate.as_ref().map(|rate| format!("{} {}", number(rate.per_second), rate.unit));
            cells.push(Cell::Number(rate.unwrap_or_default()));
        }
        cells.push(Cell::Number(row.work.passes.to_string()));
        cells.push(Cell::Quiet(row.work.skipped.join("; ")));
        cells
    };
    let cells: Vec<Vec<Cell>> = rows.iter().map(cells).collect();
    page.table(&head, &cells, |index| rows.get(index).is_some_and(|row| row.role == Role::Ours));
}

fn optional(value: Option<f64>) -> Cell {
    value.map_or(Cell::Quiet("-".into()), Cell::number)
}

/// Error against time; `None` where fewer than two rows have both.
fn error_over_time(benched: &Benched, metric: Metric) -> Option<Plot> {
    let mut series: BTreeMap<String, Series> = BTreeMap::new();
    let mut points = 0;
    for (row, name) in benched.rows.iter().zip(&benched.series) {
        let (Some(times), Some(&error)) = (row.time_ms, row.error.get(metric.name())) else { continue };
        points += 1;
        let name = name.clone().unwrap_or_else(|| row.method.clone());
        let one = series.entry(name.clone()).or_default();
        one.name = name;
        one.points.push([times.median, error]);
        one.is_line = one.points.len() > 1;
    }
    for one in series.values_mut() {
        one.points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    (points > 1).then(|| Plot {
        title: format!("{} over time: {}", metric.title(), benched.title),
        x: Axis { label: "time of a frame, ms".into(), is_log: true },
        y: Axis { label: metric.title().into(), is_log: true },
        series: series.into_values().collect(),
    })
}

fn skips(page: &mut Page, report: &Report) {
    if report.benchmarks.iter().all(|benched| benched.skips.is_empty()) {
        return;
    }
    page.heading(2, "What is skipped", "skips");
    page.quiet(
        "The same frame with the work left out and with it done. The picture changes by the largest difference of \
         a channel on the display; up to 1/255 nobody can see it.",
    );
    let ledger =
        report.benchmarks.iter().flat_map(|benched| benched.skips.iter().map(move |skip| (benched, skip)));
    let rows: Vec<Vec<Cell>> = ledger.map(|(benched, skip)| skip_cells(benched, skip)).collect();
    let head =
        ["skip", "scene", "skipping, ms", "whole, ms", "saved, ms", "saved", "picture, 1/255", "said why"];
    page.table(&head, &rows, |_| false);
}

fn skip_cells(benched: &Benched, skip: &SkipRow) -> Vec<Cell> {
    let saved = skip.whole_ms - skip.skipping_ms;
    let share =
        if skip.whole_ms > 0.0 { format!("{:.0} %", 100.0 * saved / skip.whole_ms) } else { "-".into() };
    vec![
        Cell::text(&skip.name),
        Cell::Quiet(benched.title.clone()),
        Cell::number(skip.skipping_ms),
        Cell::number(skip.whole_ms),
        Cell::number(saved),
        Cell::Number(share),
        if skip.difference <= 1.0 {
            Cell::Good(number(skip.difference))
        } else {
            Cell::Bad(number(skip.difference))
        },
        Cell::Quiet(skip.skipped.join("; ")),
    ]
}

fn measurement(page: &mut Page, measured: &Measured) {
    page.heading(2, &measured.title(), &measured.name);
    page.quiet(&measured.how);
    if let Ok(facts) = &measured.facts {
        let rows: Vec<Vec<Cell>> = facts
            .iter()
            .map(|fact| {
                vec![
                    Cell::text(&fact.name),
                    Cell::number(fact.value),
                    Cell::text(&fact.unit),
                    Cell::Quiet(fact.note.clone()),
                ]
            })
            .collect();
        page.table(&["", "value", "unit", "note"], &rows, |_| false);
    }
}
