//! `compare`: how wrong each method is, and whether that is within its limits.

mod errors;
mod noise;
mod page;
mod verdict;

pub(crate) use errors::{Map, measure};
pub(crate) use noise::Random;

use crate::{
    program::{Outcome, Run},
    report::{Header, automatic_exposure},
    technique::{Comparison, Failure, Kind, Metric, Picture, Role, TruthImage},
    truths,
};
use image_error::Image;
use serde::Serialize;
use std::collections::BTreeMap;
use verdict::{Judged, Verdict};

/// Errors by name.
pub(crate) type Errors = BTreeMap<&'static str, f64>;

/// The file `report.json`.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    passed: bool,
    comparisons: Vec<Compared>,
    /// Comparisons that an interrupted run did not come to.
    not_run: Vec<String>,
}

/// One comparison of the report.
#[derive(Debug, Serialize)]
struct Compared {
    technique: &'static str,
    scene: String,
    setting: String,
    kind: Kind,
    size: [usize; 2],
    /// Pixels that count.
    pixel_count: usize,
    truth: String,
    /// What is seen in the pictures.
    seen: &'static str,
    /// What the truth's own noise would show as each error; nothing where the truth is exact.
    noise: Option<Errors>,
    methods: Vec<MethodRow>,
    thresholds: Vec<Judged>,
    failures: Vec<String>,
    /// Units of the errors that have one.
    units: BTreeMap<&'static str, &'static str>,
    #[serde(skip)]
    shown: Option<ShownTruth>,
}

/// A method of a comparison.
#[derive(Debug, Serialize)]
struct MethodRow {
    method: String,
    role: Role,
    errors: Errors,
    /// Pixels that are not finite.
    non_finite: usize,
    #[serde(skip)]
    picture: Image,
    #[serde(skip)]
    map: Map,
}

/// What the page needs of a truth.
#[derive(Debug)]
struct ShownTruth {
    image: Image,
    exposure_ev: f32,
    is_table: bool,
}

pub(crate) fn run(run: &mut Run<'_>) -> Result<Outcome, Failure> {
    let mut planned: Vec<(&'static str, Comparison)> = Vec::new();
    for technique in &run.techniques {
        let comparisons = (technique.comparisons)(run.context.scope());
        planned.extend(comparisons.into_iter().map(|comparison| (technique.name, comparison)));
    }
    let scenes: Vec<String> = planned.iter().map(|(_, comparison)| comparison.scene.clone()).collect();
    run.check_scene(&scenes)?;
    planned.retain(|(_, comparison)| run.wants(&comparison.scene));
    run.progress.set_steps(planned.iter().map(|(_, comparison)| 1 + comparison.methods.len()).sum());
    let mut report =
        Report { header: run.header.clone(), passed: false, comparisons: Vec::new(), not_run: Vec::new() };
    for (technique, comparison) in planned {
        if !run.context.is_stopped() {
            let compared = compare(run, technique, &comparison);
            // Stopped half way, it would say things about methods that were never rendered.
            if !run.context.is_stopped() {
                report.comparisons.push(compared);
                continue;
            }
        }
        report.not_run.push(title(technique, &comparison));
    }
    report.header.interrupted = run.context.is_stopped();
    let complaints: Vec<String> = report.comparisons.iter().flat_map(Compared::complaints).collect();
    report.passed = complaints.is_empty() && !report.header.interrupted;
    run.write("report.json", &report, page::page(&report)?)?;
    if complaints.is_empty() {
        let limits: usize = report.comparisons.iter().map(|compared| compared.thresholds.len()).sum();
        let comparisons = report.comparisons.len();
        return Ok(Outcome::Passed(format!("{comparisons} comparisons, {limits} limits kept")));
    }
    Ok(Outcome::Failed(complaints))
}

fn title(technique: &str, comparison: &Comparison) -> String {
    format!("{technique} {} {}", comparison.scene, comparison.setting).trim_end().to_owned()
}

/// Runs one comparison; whatever goes wrong becomes part of it.
fn compare(run: &mut Run<'_>, technique: &'static str, comparison: &Comparison) -> Compared {
    let mut compared = Compared {
        technique,
        scene: comparison.scene.clone(),
        setting: comparison.setting.clone(),
        kind: comparison.kind,
        size: [0; 2],
        pixel_count: 0,
        truth: String::new(),
        seen: comparison.seen,
        noise: None,
        methods: Vec::new(),
        thresholds: Vec::new(),
        failures: Vec::new(),
        units: comparison.metrics.iter().map(|metric| (metric.name, metric.unit)).collect(),
        shown: None,
    };
    let title = title(technique, comparison);
    run.progress.begin(&format!("{title}: truth"));
    let truth = run.guard(|context| truths::get(context, &comparison.truth));
    run.progress.advance(1);
    match truth {
        Ok(truth) => against(run, comparison, &truth, &title, &mut compared),
        Err(error) => {
            run.progress.advance(comparison.methods.len());
            compared.failures.push(format!("the truth: {error}"));
        }
    }
    compared
}

/// Measures all methods against a truth.
fn against(
    run: &mut Run<'_>,
    comparison: &Comparison,
    truth: &TruthImage,
    title: &str,
    compared: &mut Compared,
) {
    let exposure = match comparison.picture {
        Picture::Radiance { exposure_ev } => {
            Some(exposure_ev.unwrap_or_else(|| automatic_exposure(&truth.image, truth.mask.as_deref())))
        }
        Picture::Table => None,
    };
    compared.size = [truth.image.width(), truth.image.height()];
    compared.pixel_count = match &truth.mask {
        Some(mask) => mask.iter().filter(|&&counts| counts).count(),
        None => truth.image.pixels().len(),
    };
    compared.truth.clone_from(&truth.how);
    compared.shown = Some(ShownTruth {
        image: truth.image.clone(),
        is_table: exposure.is_none(),
        exposure_ev: exposure.unwrap_or_else(|| automatic_exposure(&truth.image, truth.mask.as_deref())),
    });
    match noise::noise(truth, &comparison.metrics, exposure) {
        Ok(noise) => compared.noise = noise,
        Err(error) => compared.failures.push(format!("the truth's noise: {error}")),
    }
    for method in &comparison.methods {
        if run.context.is_stopped() {
            return;
        }
        run.progress.begin(&format!("{title}: {}", method.name));
        let row = run.guard(|context| {
            let picture = (method.render)(context)?;
            let measured = measure(&picture, truth, &comparison.metrics, exposure)?;
            Ok(MethodRow {
                method: method.name.clone(),
                role: method.role,
                errors: measured.errors,
                non_finite: measured.non_finite,
                picture,
                map: measured.map,
            })
        });
        run.progress.advance(1);
        match row {
            Ok(row) => compared.methods.push(row),
            Err(error) => compared.failures.push(format!("{}: {error}", method.name)),
        }
    }
    let errors = |method: &str| compared.methods.iter().find(|row| row.method == method);
    compared.thresholds = comparison
        .thresholds
        .iter()
        .map(|threshold| {
            Judged::new(threshold, errors(&threshold.method).map(|row| &row.errors), compared.noise.as_ref())
        })
        .collect();
}

impl Compared {
    fn title(&self) -> String {
        format!("{} {} {}", self.technique, self.scene, self.setting).trim_end().to_owned()
    }

    /// Everything that is not as it should be, one line each.
    fn complaints(&self) -> Vec<String> {
        let title = self.title();
        let mut lines: Vec<String> =
            self.failures.iter().map(|failure| format!("{title}: {failure}")).collect();
        for row in self.methods.iter().filter(|row| row.non_finite > 0) {
            lines.push(format!("{title}: {}: {} pixels are not finite", row.method, row.non_finite));
        }
        let missed = self.thresholds.iter().filter(|judged| judged.verdict != Verdict::Passed);
        lines.extend(missed.map(|judged| format!("{title}: {}", judged.explain())));
        lines
    }

    /// The errors of this comparison, in the order of the tables.
    fn metrics(&self) -> Vec<Metric> {
        let all = Metric::ALL.into_iter().chain(self.units.keys().map(|name| Metric::Custom(name)));
        all.filter(|metric| self.methods.iter().any(|row| row.errors.contains_key(metric.name()))).collect()
    }
}
