//! The page of `stress`.

use super::{FunctionRow, Report};
use crate::report::{Cell, Page, number};

pub(super) fn page(report: &Report) -> Page {
    let mut page = Page::new("Sheen: what breaks", &report.header);
    page.paragraph(
        "Every library function runs in a compute shader over extremes, special values and random inputs, and \
         is compared with the same mathematics in f64. Then whole frames of hostile scenes: no value may be \
         NaN, infinite or negative, and the device may report no error.",
    );
    let complaints = report.complaints(false);
    if complaints.is_empty() {
        page.good(&format!(
            "{} function cases and {} hostile frames hold.",
            report.functions.len(),
            report.hostile_scenes.len()
        ));
    }
    for line in &complaints {
        page.bad(line);
    }
    if !report.not_run.is_empty() {
        page.bad(&format!("Not run: {}", report.not_run.join("; ")));
    }
    functions(&mut page, &report.functions);
    hostile(&mut page, report);
    exemptions(&mut page, report);
    page
}

fn functions(page: &mut Page, functions: &[FunctionRow]) {
    page.heading(2, "Functions", "functions");
    page.quiet(
        "Relative errors are taken where the model's value is above the absolute tolerance. The worst input is \
         the one whose error is the largest share of what is allowed.",
    );
    let head = [
        "function",
        "output",
        "inputs",
        "largest |error|",
        "largest relative",
        "not finite",
        "share of allowed",
        "worst input",
        "found",
        "expected",
        "",
    ];
    let mut rows = Vec::new();
    for function in functions {
        let inputs = function.extreme_inputs + function.random_inputs;
        if let Some(failure) = &function.failure {
            rows.push(vec![Cell::text(function.function), Cell::Bad(failure.clone())]);
        }
        for output in &function.outputs {
            let worst = output.worst.as_ref();
            let text = |value: Option<String>| Cell::Quiet(value.unwrap_or_default());
            rows.push(vec![
                Cell::text(function.function),
                Cell::text(output.output),
                Cell::Number(inputs.to_string()),
                Cell::number(output.largest_absolute),
                Cell::number(output.largest_relative),
                Cell::Number(output.non_finite.to_string()),
                worst.map_or(Cell::text(""), |worst| Cell::number(worst.share)),
                text(worst.map(|worst| short(&worst.input))),
                Cell::Number(worst.map_or(String::new(), |worst| shortened(&worst.found))),
                Cell::Number(worst.map_or(String::new(), |worst| shortened(&worst.expected))),
                if output.holds() { Cell::Good("holds".into()) } else { Cell::Bad("fails".into()) },
            ]);
        }
    }
    page.table(&head, &rows, |_| false);
    page.heading(3, "What is allowed", "tolerances");
    let rows: Vec<Vec<Cell>> = functions
        .iter()
        .map(|function| {
            let slack = if function.has_slack { " + slack by input" } else { "" };
            vec![
                Cell::text(function.function),
                Cell::text(format!("{}{slack}", number(function.absolute))),
                Cell::number(function.relative),
                Cell::Quiet(function.reason.to_owned()),
            ]
        })
        .collect();
    page.table(&["function", "absolute", "relative", "reason"], &rows, |_| false);
}

/// An input in few digits; the report has all of them.
fn short(input: &[String]) -> String {
    input.iter().map(|value| shortened(value)).collect::<Vec<_>>().join(", ")
}

fn shortened(value: &str) -> String {
    value.parse::<f64>().map_or_else(|_| value.to_owned(), |value| format!("{value:.4e}"))
}

fn hostile(page: &mut Page, report: &Report) {
    page.heading(2, "Hostile scenes", "scenes");
    let rows: Vec<Vec<Cell>> = report
        .hostile_scenes
        .iter()
        .map(|row| {
            let outcome = row.outcome.clone();
            vec![
                Cell::text(&row.scene),
                Cell::Quiet(row.why.to_owned()),
                Cell::text(&row.settings),
                if row.passed { Cell::Good(outcome) } else { Cell::Bad(outcome) },
                Cell::number(row.time_ms),
            ]
        })
        .collect();
    page.table(&["scene", "why", "settings", "what came of it", "ms in all"], &rows, |_| false);
}

fn exemptions(page: &mut Page, report: &Report) {
    if report.exemptions.is_empty() {
        return;
    }
    page.heading(2, "Functions without a case of their own", "exemptions");
    let rows: Vec<Vec<Cell>> = report
        .exemptions
        .iter()
        .map(|row| vec![Cell::text(row.function), Cell::Quiet(row.reason.to_owned())])
        .collect();
    page.table(&["function", "reason"], &rows, |_| false);
}
