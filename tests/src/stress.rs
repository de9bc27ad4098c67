//! `stress`: every library function against its f64 model, and scenes that try to break frames.

mod functions;
mod hostile;
mod inputs;
mod page;
mod probe;
mod tally;

use crate::{
    program::{Outcome, Run},
    report::Header,
    technique::{Failure, StressCase, Technique},
};
use hostile::HostileRow;
use serde::Serialize;
use tally::{OutputRow, Tally};

/// Random inputs of a function, and in a quick run.
const SAMPLES: usize = 1_000_000;
const QUICK_SAMPLES: usize = 1 << 15;
/// Inputs of one dispatch: short enough that a run stops soon when it is asked to.
const BATCH: usize = 1 << 17;

/// The file `report.json`.
#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    passed: bool,
    functions: Vec<FunctionRow>,
    hostile_scenes: Vec<HostileRow>,
    exemptions: Vec<ExemptRow>,
    /// Functions of a library that have neither a case nor an exemption, and cases and exemptions
    /// of functions that are not there.
    gaps: Vec<String>,
    not_run: Vec<String>,
}

/// A function's row.
#[derive(Debug, Serialize)]
struct FunctionRow {
    technique: &'static str,
    function: &'static str,
    /// Inputs made of extremes and special values, and random ones.
    extreme_inputs: usize,
    random_inputs: usize,
    /// Names of the places of an input are the places of `x`.
    outputs: Vec<OutputRow>,
    absolute: f64,
    relative: f64,
    has_slack: bool,
    reason: &'static str,
    passed: bool,
    failure: Option<String>,
}

/// A function without a case.
#[derive(Debug, Serialize)]
struct ExemptRow {
    technique: &'static str,
    function: &'static str,
    reason: &'static str,
}

pub(crate) fn run(run: &mut Run<'_>) -> Result<Outcome, Failure> {
    let techniques = run.techniques.clone();
    let scope = run.context.scope().clone();
    let mut report = Report {
        header: run.header.clone(),
        passed: false,
        functions: Vec::new(),
        hostile_scenes: Vec::new(),
        exemptions: Vec::new(),
        gaps: Vec::new(),
        not_run: Vec::new(),
    };
    let mut cases: Vec<(&Technique, StressCase)> = Vec::new();
    let mut scenes = Vec::new();
    for technique in techniques {
        let own = (technique.stress)(&scope);
        report.gaps.extend(functions::gaps(technique, &own)?);
        report.exemptions.extend(technique.exemptions.iter().map(|exemption| ExemptRow {
            technique: technique.name,
            function: exemption.function,
            reason: exemption.reason,
        }));
        cases.extend(own.into_iter().map(|case| (technique, case)));
        scenes.extend((technique.hostile_scenes)(&scope).into_iter().map(|scene| (technique.name, scene)));
    }
    let names = cases.iter().map(|(_, case)| case.function.to_owned());
    run.check_scene(&names.chain(scenes.iter().map(|(_, scene)| scene.name.clone())).collect::<Vec<_>>())?;
    cases.retain(|(_, case)| run.wants(case.function));
    scenes.retain(|(_, scene)| run.wants(&scene.name));
    run.progress.set_steps(cases.len() + scenes.len());
    for (technique, case) in cases {
        run.progress.begin(&format!("{}: {}", technique.name, case.function));
        let row = function(run, technique.name, &case);
        run.progress.advance(1);
        match row {
            Some(row) => report.functions.push(row),
            None => report.not_run.push(case.function.to_owned()),
        }
    }
    for (technique, scene) in scenes {
        if run.context.is_stopped() {
            report.not_run.push(scene.name);
            continue;
        }
        run.progress.begin(&format!("{technique}: {}", scene.name));
        report.hostile_scenes.extend(hostile::rows(run, technique, &scene));
        run.progress.advance(1);
    }
    finish(run, report)
}

fn finish(run: &Run<'_>, mut report: Report) -> Result<Outcome, Failure> {
    report.header.interrupted = run.context.is_stopped();
    let complaints = report.complaints(true);
    report.passed = complaints.is_empty() && !report.header.interrupted;
    run.write("report.json", &report, page::page(&report))?;
    if complaints.is_empty() {
        let (functions, scenes) = (report.functions.len(), report.hostile_scenes.len());
        return Ok(Outcome::Passed(format!("{functions} function cases and {scenes} hostile frames hold")));
    }
    Ok(Outcome::Failed(complaints))
}

impl Report {
    /// Everything that does not hold, one line each; with the worst inputs where they are not in a
    /// table beside it.
    fn complaints(&self, with_inputs: bool) -> Vec<String> {
        let complaint = |row: &FunctionRow| row.complaint(with_inputs);
        let functions = self.functions.iter().filter(|row| !row.passed).map(complaint);
        let scenes = self.hostile_scenes.iter().filter_map(HostileRow::complaint);
        self.gaps.iter().cloned().chain(functions).chain(scenes).collect()
    }
}

impl FunctionRow {
    fn complaint(&self, with_inputs: bool) -> String {
        let name = format!("{}: {}", self.technique, self.function);
        if let Some(failure) = &self.failure {
            return format!("{name}: {failure}");
        }
        let outputs: Vec<String> =
            self.outputs.iter().filter_map(|output| output.complaint(with_inputs)).collect();
        format!("{name}: {}", outputs.join("; "))
    }
}

/// Runs one function; `None` where the run was stopped meanwhile.
fn function(run: &mut Run<'_>, technique: &'static str, case: &StressCase) -> Option<FunctionRow> {
    if run.context.is_stopped() {
        return None;
    }
    let usual = if run.context.scope().quick { QUICK_SAMPLES } else { SAMPLES };
    let samples = case.samples.map_or(usual, |samples| samples.min(usual));
    let inputs = inputs::Inputs::new(&case.inputs, samples);
    let mut tally = Tally::new(case);
    let result = run.guard(|context| {
        let probe = probe::Probe::new(context, case)?;
        for first in (0..inputs.len()).step_by(BATCH) {
            if context.is_stopped() {
                return Ok(());
            }
            let batch = inputs.batch(first..inputs.len().min(first + BATCH));
            let answers = probe.run(context, &batch)?;
            tally.add(&batch, &answers)?;
        }
        Ok(())
    });
    if run.context.is_stopped() {
        return None;
    }
    let outputs = tally.rows();
    Some(FunctionRow {
        technique,
        function: case.function,
        extreme_inputs: inputs.extremes(),
        random_inputs: samples,
        passed: result.is_ok() && outputs.iter().all(OutputRow::holds),
        outputs,
        absolute: case.tolerance.absolute,
        relative: case.tolerance.relative,
        has_slack: case.tolerance.slack.is_some(),
        reason: case.tolerance.reason,
        failure: result.err(),
    })
}
