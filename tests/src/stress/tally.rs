//! How far a function was from its model, over all inputs.

use super::inputs::Batch;
use crate::{
    report::number,
    technique::{Failure, StressCase, Tolerance},
};
use rayon::prelude::*;
use serde::Serialize;

/// Inputs that one thread compares.
const CHUNK: usize = 1 << 12;

/// What was seen of one output.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct OutputRow {
    pub(super) output: &'static str,
    /// Values that were compared, and values about which the function promises nothing.
    pub(super) compared: u64,
    pub(super) unpromised: u64,
    pub(super) largest_absolute: f64,
    /// Largest error over the model's value, where that is above the absolute tolerance.
    pub(super) largest_relative: f64,
    /// Values that are not finite although the model's are.
    pub(super) non_finite: u64,
    /// Values beyond the tolerance, those that are not finite included.
    pub(super) beyond: u64,
    /// The input whose error is the largest share of what is allowed.
    pub(super) worst: Option<Worst>,
}

/// An input and what came of it. Values that are not finite are written as text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Worst {
    pub(super) input: Vec<String>,
    pub(super) found: String,
    pub(super) expected: String,
    /// Error over what is allowed; infinite for what is not finite.
    pub(super) share: f64,
}

/// The sums over all batches.
pub(super) struct Tally<'a> {
    case: &'a StressCase,
    rows: Vec<OutputRow>,
}

impl<'a> Tally<'a> {
    pub(super) fn new(case: &'a StressCase) -> Self {
        Self { case, rows: empty(case.outputs) }
    }

    /// Compares a batch. Fails where the model does not return as many values as the case has outputs.
    pub(super) fn add(&mut self, batch: &Batch, answers: &[f32]) -> Result<(), Failure> {
        let outputs = self.case.outputs.len();
        // The case's bindings stay on this thread.
        let StressCase { model, tolerance, outputs: names, .. } = self.case;
        let chunks: Vec<Vec<OutputRow>> = answers
            .par_chunks(CHUNK * outputs.max(1))
            .enumerate()
            .map(|(chunk, answers)| {
                let mut rows = empty(names);
                for (index, found) in answers.chunks_exact(outputs).enumerate() {
                    let input = batch.values(chunk * CHUNK + index);
                    compare(tolerance, &input, &model(&input), found, &mut rows)?;
                }
                Ok(rows)
            })
            .collect::<Result<_, String>>()?;
        for rows in chunks {
            self.rows.iter_mut().zip(rows).for_each(|(sum, row)| sum.join(row));
        }
        Ok(())
    }

    pub(super) fn rows(self) -> Vec<OutputRow> {
        self.rows
    }
}

fn empty(outputs: &[&'static str]) -> Vec<OutputRow> {
    outputs.iter().map(|&output| OutputRow { output, ..OutputRow::default() }).collect()
}

fn compare(
    tolerance: &Tolerance,
    input: &[f64],
    expected: &[f64],
    found: &[f32],
    rows: &mut [OutputRow],
) -> Result<(), String> {
    if expected.len() != rows.len() {
        return Err(format!("the model gives {} values for {} outputs", expected.len(), rows.len()));
    }
    let slack = tolerance.slack.map_or(0.0, |slack| slack(input));
    for ((row, &found), &expected) in rows.iter_mut().zip(found).zip(expected) {
        let found = f64::from(found);
        if expected.is_nan() {
            row.unpromised += 1;
            continue;
        }
        row.compared += 1;
        let error = difference(found, expected);
        let allowed = tolerance.absolute + tolerance.relative * expected.abs() + slack;
        let share = if error == 0.0 { 0.0 } else { error / allowed };
        let share = if share.is_nan() || !found.is_finite() && error != 0.0 { f64::INFINITY } else { share };
        row.non_finite += u64::from(!found.is_finite() && expected.is_finite());
        row.beyond += u64::from(share > 1.0);
        if error.is_finite() {
            row.largest_absolute = row.largest_absolute.max(error);
            if expected.is_finite() && expected.abs() > tolerance.absolute {
                row.largest_relative = row.largest_relative.max(error / expected.abs());
            }
        }
        if row.worst.as_ref().is_none_or(|worst| share > worst.share) {
            row.worst = Some(Worst {
                input: input.iter().map(|value| format!("{value:e}")).collect(),
                found: format!("{found:e}"),
                expected: format!("{expected:e}"),
                share,
            });
        }
    }
    Ok(())
}

/// 0 also where both are the same infinity.
#[expect(clippy::float_cmp, reason = "only equal values have no difference at all")]
fn difference(found: f64, expected: f64) -> f64 {
    if found == expected { 0.0 } else { (found - expected).abs() }
}

impl OutputRow {
    fn join(&mut self, other: Self) {
        self.compared += other.compared;
        self.unpromised += other.unpromised;
        self.non_finite += other.non_finite;
        self.beyond += other.beyond;
        self.largest_absolute = self.largest_absolute.max(other.largest_absolute);
        self.largest_relative = self.largest_relative.max(other.largest_relative);
        let share = |worst: &Option<Worst>| worst.as_ref().map_or(-1.0, |worst| worst.share);
        if share(&other.worst) > share(&self.worst) {
            self.worst = other.worst;
        }
    }

    /// Whether all is well. A function of which nothing was compared was not stressed.
    pub(super) fn holds(&self) -> bool {
        self.compared > 0 && self.beyond == 0
    }

    /// What is wrong, `None` where nothing is.
    pub(super) fn complaint(&self, with_input: bool) -> Option<String> {
        let Self { output, compared, beyond, non_finite, .. } = self;
        if *compared == 0 {
            return Some(format!("{output}: nothing was compared"));
        }
        let worst = self.worst.as_ref().filter(|_| !self.holds())?;
        let share = number(worst.share);
        let input = if with_input {
            format!("; worst: f({}) = {}, expected {}", worst.input.join(", "), worst.found, worst.expected)
        } else {
            String::new()
        };
        Some(format!(
            "{output}: {beyond} of {compared} beyond the tolerance, by up to {share} times, {non_finite} not \
             finite{input}"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{stress::inputs::Inputs, technique::Input};

    fn case(model: fn(&[f64]) -> Vec<f64>) -> StressCase {
        StressCase {
            function: "square",
            library: &shaders::COMMON_MATH,
            inputs: vec![Input::Real { least: 0.0, greatest: 2.0 }],
            body: "y[0] = x[0] * x[0];",
            outputs: &["square"],
            model: Box::new(model),
            tolerance: Tolerance { absolute: 1e-6, relative: 1e-3, slack: None, reason: "a test" },
            bindings: None,
            samples: None,
        }
    }

    fn row(case: &StressCase, wrong: fn(f32) -> f32) -> OutputRow {
        let inputs = Inputs::new(&case.inputs, 10_000);
        let batch = inputs.batch(0..inputs.len());
        let answers: Vec<f32> =
            batch.words.iter().map(|&word| f32::from_bits(word)).map(|x| wrong(x) + x * x).collect();
        let mut tally = Tally::new(case);
        tally.add(&batch, &answers).unwrap();
        tally.rows().remove(0)
    }

    #[test]
    fn errors_within_the_tolerance_pass() {
        let row = row(&case(|x| vec![x[0] * x[0]]), |x| 5e-4 * x * x);
        assert_eq!((row.complaint(true), row.beyond, row.non_finite), (None, 0, 0));
        assert!(
            (row.largest_relative - 5e-4).abs() < 1e-5 && (row.largest_absolute - 2e-3).abs() < 1e-5,
            "{row:?}"
        );
    }

    #[test]
    fn one_wrong_value_is_found_and_named() {
        let row = row(&case(|x| vec![x[0] * x[0]]), |x| if x >= 2.0 { 0.5 } else { 0.0 });
        assert_eq!(row.beyond, 1);
        let worst = row.worst.clone().unwrap();
        assert_eq!((worst.input, worst.found), (vec!["2e0".to_owned()], "4.5e0".to_owned()));
        assert!(row.complaint(true).unwrap().contains("f(2e0) = 4.5e0, expected 4e0"));
    }

    #[test]
    fn what_is_not_finite_counts_unless_nothing_was_promised() {
        let nan = |x: f32| if x == 0.0 { f32::NAN } else { 0.0 };
        let found = row(&case(|x| vec![x[0] * x[0]]), nan);
        assert_eq!((found.non_finite, found.beyond), (2, 2));
        assert!(found.complaint(true).unwrap().contains("inf times"), "{:?}", found.complaint(true));
        let excused = row(&case(|x| vec![if x[0] == 0.0 { f64::NAN } else { x[0] * x[0] }]), nan);
        assert_eq!((excused.unpromised, excused.complaint(true)), (2, None));
        let infinite = row(&case(|x| vec![if x[0] == 0.0 { f64::INFINITY } else { x[0] * x[0] }]), |x| {
            if x == 0.0 { f32::INFINITY } else { 0.0 }
        });
        assert_eq!(infinite.complaint(true), None);
    }

    #[test]
    fn comparing_nothing_is_a_failure() {
        assert!(row(&case(|_| vec![f64::NAN]), |_| 0.0).complaint(true).is_some());
        let wrong = case(|_| vec![1.0, 2.0]);
        let inputs = Inputs::new(&wrong.inputs, 1);
        let batch = inputs.batch(0..1);
        assert!(Tally::new(&wrong).add(&batch, &[0.0]).is_err());
    }
}
