//! `bench`: what each method costs, beside the others in the same run.
//!
//! Subjects take turns, so that whatever slows the machine down slows all of them; the order of a
//! round changes from round to round. `results.json` is a list of rows.

mod page;
mod statistics;
mod turns;

use crate::{
    compare::{Errors, measure},
    program::{Outcome, Run},
    report::Header,
    technique::{Benchmark, Fact, Failure, Measurement, Role, SkipPair, Subject, TruthImage, WorkDone},
    truths,
};
use image_error::Image;
use serde::Serialize;
use statistics::Times;
use turns::{Clock, Timed, take_turns};

/// Everything that was measured, for the page; `results.json` holds the rows alone.
#[derive(Debug)]
struct Report {
    header: Header,
    benchmarks: Vec<Benched>,
    measurements: Vec<Measured>,
    not_run: Vec<String>,
}

/// One benchmark of the page.
#[derive(Debug)]
struct Benched {
    title: String,
    rows: Vec<Row>,
    series: Vec<Option<String>>,
    skips: Vec<SkipRow>,
    truth: Option<String>,
    failures: Vec<String>,
}

/// A row of `results.json`.
#[derive(Clone, Debug, Serialize)]
struct Row {
    technique: &'static str,
    method: String,
    scene: String,
    setting: String,
    size: [u32; 2],
    time_ms: Option<Times>,
    clock: Option<Clock>,
    /// The same by each clock, where it was read.
    wall_ms: Option<Times>,
    adapter_ms: Option<Times>,
    prepare_ms: Option<f64>,
    memory_bytes: Option<u64>,
    error: Errors,
    work: WorkDone,
    adapter: String,
    role: Role,
    /// Time over that of our own method in the same benchmark.
    ratio: Option<f64>,
    /// Units per second, by unit.
    rate: Option<Rate>,
}

/// Anything that stands in `results.json`.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum AnyRow<'a> {
    Frame(&'a Row),
    Skip {
        of: &'a str,
        #[serde(flatten)]
        skip: &'a SkipRow,
    },
    Facts {
        technique: &'static str,
        measurement: &'a str,
        how: &'a str,
        facts: &'a [Fact],
        adapter: &'a str,
        threads: usize,
    },
}

/// How fast something is done.
#[derive(Clone, Debug, Serialize)]
struct Rate {
    unit: &'static str,
    per_second: f64,
}

/// An entry of the skip ledger.
#[derive(Clone, Debug, Serialize)]
struct SkipRow {
    #[serde(rename = "skip")]
    name: String,
    skipping_ms: f64,
    whole_ms: f64,
    /// Largest difference of a channel of the displayed pictures, in units of 1/255.
    #[serde(rename = "difference_of_255")]
    difference: f64,
    skipped: Vec<String>,
}

/// A measurement and what came of it.
#[derive(Debug)]
struct Measured {
    technique: &'static str,
    name: String,
    how: String,
    facts: Result<Vec<Fact>, String>,
}

/// What can be in the queue of a run.
enum Job {
    Benchmark(Benchmark),
    Measurement(Measurement),
}

pub(crate) fn run(run: &mut Run<'_>) -> Result<Outcome, Failure> {
    let scope = run.context.scope().clone();
    let mut jobs: Vec<(&'static str, Job)> = Vec::new();
    for technique in &run.techniques {
        let benchmarks = (technique.benchmarks)(&scope).into_iter().map(Job::Benchmark);
        let measurements = (technique.measurements)(&scope).into_iter().map(Job::Measurement);
        jobs.extend(benchmarks.chain(measurements).map(|job| (technique.name, job)));
    }
    run.check_scene(&jobs.iter().map(|(_, job)| job.scene().to_owned()).collect::<Vec<_>>())?;
    jobs.retain(|(_, job)| run.wants(job.scene()));
    run.progress.set_steps(jobs.len());
    let mut report = Report {
        header: run.header.clone(),
        benchmarks: Vec::new(),
        measurements: Vec::new(),
        not_run: Vec::new(),
    };
    for (technique, job) in jobs {
        let title = format!("{technique} {}", job.title());
        if !run.context.is_stopped() {
            run.progress.begin(&title);
            match &job {
                Job::Benchmark(benchmark) => {
                    let benched = bench(run, technique, benchmark, title.clone());
                    // Rounds that were cut short are no statistics.
                    if !run.context.is_stopped() {
                        report.benchmarks.push(benched);
                    }
                }
                Job::Measurement(measurement) => {
                    let facts = run.guard(|context| (measurement.run)(context));
                    if !run.context.is_stopped() {
                        report.measurements.push(Measured {
                            technique,
                            name: measurement.name.clone(),
                            how: measurement.how.clone(),
                            facts,
                        });
                    }
                }
            }
            run.progress.advance(1);
        }
        if run.context.is_stopped() {
            report.not_run.push(title);
        }
    }
    finish(run, report)
}

fn finish(run: &Run<'_>, mut report: Report) -> Result<Outcome, Failure> {
    report.header.interrupted = run.context.is_stopped();
    run.write("results.json", &report.rows(), page::page(&report))?;
    let complaints = report.complaints();
    if complaints.is_empty() {
        return Ok(Outcome::Passed(format!("{} rows", report.rows().len())));
    }
    Ok(Outcome::Failed(complaints))
}

impl Job {
    fn scene(&self) -> &str {
        match self {
            Self::Benchmark(benchmark) => &benchmark.scene,
            Self::Measurement(measurement) => &measurement.name,
        }
    }

    fn title(&self) -> String {
        match self {
            Self::Benchmark(Benchmark { scene, setting, .. }) => {
                format!("{scene} {setting}").trim_end().to_owned()
            }
            Self::Measurement(measurement) => measurement.name.clone(),
        }
    }
}

impl Measured {
    fn title(&self) -> String {
        format!("{} {}", self.technique, self.name)
    }
}

impl Report {
    /// The rows of `results.json`.
    fn rows(&self) -> Vec<AnyRow<'_>> {
        let benchmarks = self.benchmarks.iter().flat_map(|benched| &benched.rows).map(AnyRow::Frame);
        let skips = self.benchmarks.iter().flat_map(|benched| {
            benched.skips.iter().map(move |skip| AnyRow::Skip { of: &benched.title, skip })
        });
        let facts = self.measurements.iter().filter_map(|measured| {
            let Measured { technique, name, how, facts } = measured;
            let facts = facts.as_ref().ok()?;
            let Header { adapter, threads, .. } = &self.header;
            Some(AnyRow::Facts { technique, measurement: name, how, facts, adapter, threads: *threads })
        });
        benchmarks.chain(skips).chain(facts).collect()
    }

    fn complaints(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for benched in &self.benchmarks {
            lines.extend(benched.failures.iter().map(|failure| format!("{}: {failure}", benched.title)));
        }
        for measured in &self.measurements {
            if let Err(error) = &measured.facts {
                lines.push(format!("{} {}: {error}", measured.technique, measured.name));
            }
        }
        lines
    }
}

/// Times the subjects of a benchmark and its skips, then takes their errors.
fn bench(run: &mut Run<'_>, technique: &'static str, benchmark: &Benchmark, title: String) -> Benched {
    let mut benched = Benched {
        title,
        rows: Vec::new(),
        series: Vec::new(),
        skips: Vec::new(),
        truth: None,
        failures: Vec::new(),
    };
    let truth =
        benchmark.truth.as_ref().and_then(|truth| match run.guard(|context| truths::get(context, truth)) {
            Ok(truth) => Some(truth),
            Err(error) => {
                benched.failures.push(format!("the truth: {error}"));
                None
            }
        });
    benched.truth = truth.as_ref().map(|truth| truth.how.clone());
    let subjects: Vec<&Subject> = benchmark.subjects.iter().collect();
    let timed = run.guard(|context| take_turns(context, &subjects));
    match timed {
        Ok(timed) => rows(run, technique, benchmark, truth.as_ref(), timed, &mut benched),
        Err(error) => benched.failures.push(error),
    }
    for skip in &benchmark.skips {
        if run.context.is_stopped() {
            break;
        }
        match run.guard(|context| skip_row(context, skip)) {
            Ok(row) => {
                if row.difference > 1.0 {
                    let by = row.difference;
                    benched
                        .failures
                        .push(format!("skip \"{}\": the picture changes by {by:.1}/255", row.name));
                }
                benched.skips.push(row);
            }
            Err(error) => benched.failures.push(format!("skip \"{}\": {error}", skip.name)),
        }
    }
    benched
}

fn rows(
    run: &Run<'_>,
    technique: &'static str,
    benchmark: &Benchmark,
    truth: Option<&TruthImage>,
    timed: Vec<Timed>,
    benched: &mut Benched,
) {
    let ours = benchmark.subjects.iter().position(|subject| subject.role == Role::Ours);
    let time_of = |timed: &Timed| timed.time_ms.map(|times| times.median);
    let own_time = ours.and_then(|index| time_of(timed.get(index)?));
    for (subject, timed) in benchmark.subjects.iter().zip(timed) {
        let error = match (truth, &timed.picture) {
            (Some(truth), Some(picture)) => errors(picture, truth),
            _ => Ok(Errors::new()),
        };
        let error = error.unwrap_or_else(|error| {
            benched.failures.push(format!("{}: {error}", subject.method));
            Errors::new()
        });
        let time = time_of(&timed);
        benched.series.push(subject.series.clone());
        benched.rows.push(Row {
            technique,
            method: subject.method.clone(),
            scene: benchmark.scene.clone(),
            setting: benchmark.setting.clone(),
            size: benchmark.size,
            time_ms: timed.time_ms,
            clock: timed.clock,
            wall_ms: timed.wall_ms,
            adapter_ms: timed.adapter_ms,
            prepare_ms: timed.prepare_ms,
            memory_bytes: timed.memory_bytes,
            error,
            work: timed.work,
            adapter: run.header.adapter.clone(),
            role: subject.role,
            ratio: time.zip(own_time).map(|(time, own)| time / own).filter(|ratio| ratio.is_finite()),
            rate: timed.throughput.zip(time).map(|(throughput, time)| Rate {
                unit: throughput.unit,
                per_second: throughput.per_frame / (1e-3 * time),
            }),
        });
    }
}

fn errors(picture: &Image, truth: &TruthImage) -> Result<Errors, Failure> {
    let measured = measure(picture, truth, &[], None)?;
    if measured.non_finite > 0 {
        return Err(format!("{} pixels are not finite", measured.non_finite).into());
    }
    Ok(measured.errors)
}

/// Times a frame with and without its skip, and compares the pictures as they are displayed.
fn skip_row(context: &mut crate::Context, skip: &SkipPair) -> Result<SkipRow, Failure> {
    let mut timed = take_turns(context, &[&skip.skipping, &skip.whole])?.into_iter();
    let (Some(skipping), Some(whole)) = (timed.next(), timed.next()) else {
        return Err("a skip takes two subjects".into());
    };
    let time = |timed: &Timed| {
        let time = if skip.in_prepare { timed.prepare_ms } else { timed.time_ms.map(|times| times.median) };
        time.unwrap_or(0.0)
    };
    let (Some(a), Some(b)) = (&skipping.picture, &whole.picture) else {
        return Err("a skip needs both pictures".into());
    };
    Ok(SkipRow {
        name: skip.name.clone(),
        skipping_ms: time(&skipping),
        whole_ms: time(&whole),
        difference: displayed_difference(a, b)?,
        skipped: skipping.work.skipped,
    })
}

/// The largest difference of a channel of two pictures as they are displayed, in units of 1/255.
fn displayed_difference(a: &Image, b: &Image) -> Result<f64, Failure> {
    use compositor::{ToneCurve, tone_map};
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return Err("the pictures differ in size".into());
    }
    let exposure = crate::report::automatic_exposure(b, None);
    let shown = |pixel: [f32; 3]| {
        tone_map::display_linear(pixel, exposure, ToneCurve::PbrNeutral).map(tone_map::srgb_encoded)
    };
    let mut largest = 0.0_f32;
    for (&a, &b) in a.pixels().iter().zip(b.pixels()) {
        if a.iter().chain(&b).any(|value| !value.is_finite()) {
            return Err("a picture has pixels that are not finite".into());
        }
        for (a, b) in shown(a).into_iter().zip(shown(b)) {
            largest = largest.max((a - b).abs());
        }
    }
    Ok(255.0 * f64::from(largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_compared_as_they_are_displayed() {
        let grey = |value: f32| Image::row(vec![[0.18; 3], [value; 3], [0.18; 3]]).unwrap();
        assert!(displayed_difference(&grey(0.18), &grey(0.18)).unwrap() == 0.0);
        let small = displayed_difference(&grey(0.1805), &grey(0.18)).unwrap();
        assert!(small > 0.05 && small < 0.5, "{small}");
        // Both are white on the display.
        assert!(displayed_difference(&grey(4e5), &grey(5e5)).unwrap() < 0.1);
        assert!(displayed_difference(&grey(0.3), &grey(0.18)).unwrap() > 20.0);
        assert!(displayed_difference(&grey(f32::NAN), &grey(0.18)).is_err());
    }
}
