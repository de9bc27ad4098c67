//! Whether a limit is kept.

use super::Errors;
use crate::{report::number, technique::Threshold};
use serde::Serialize;

/// What became of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Verdict {
    /// The error is within the limit, and the truth is good enough to say so.
    Passed,
    /// The error is beyond the limit.
    Missed,
    /// The truth's own noise is larger than the limit: nothing was shown.
    Refused,
    /// The method or the error is not there.
    Unknown,
}

/// A limit, and what became of it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Judged {
    pub(super) method: String,
    pub(super) metric: &'static str,
    pub(super) found: Option<f64>,
    pub(super) at_most: f64,
    pub(super) noise: Option<f64>,
    pub(super) verdict: Verdict,
    pub(super) reason: &'static str,
    #[serde(skip)]
    pub(super) title: &'static str,
}

impl Judged {
    /// Judges a limit by the method's errors (`None` where there is no such method) and by those of
    /// the truth's noise (`None` where the truth is exact).
    pub(super) fn new(threshold: &Threshold, errors: Option<&Errors>, noise: Option<&Errors>) -> Self {
        let name = threshold.metric.name();
        let found = errors.and_then(|errors| errors.get(name)).copied();
        let noise = noise.and_then(|noise| noise.get(name)).copied();
        let verdict = match (found, noise) {
            (None, _) => Verdict::Unknown,
            (_, Some(noise)) if noise.is_nan() || noise > threshold.at_most => Verdict::Refused,
            (Some(found), _) if found <= threshold.at_most => Verdict::Passed,
            _ => Verdict::Missed,
        };
        Self {
            method: threshold.method.clone(),
            metric: name,
            found,
            at_most: threshold.at_most,
            noise,
            verdict,
            reason: threshold.reason,
            title: threshold.metric.title(),
        }
    }

    /// The verdict in a sentence.
    pub(super) fn explain(&self) -> String {
        let Self { method, title, .. } = self;
        let [found, noise] = [self.found, self.noise].map(|value| value.map_or("none".into(), number));
        let limit = number(self.at_most);
        match self.verdict {
            Verdict::Passed => format!("{method}: {title} {found} is within {limit}"),
            Verdict::Missed => format!("{method}: {title} {found} is beyond {limit} ({})", self.reason),
            Verdict::Refused => format!(
                "{method}: {title} {found} cannot be judged: the truth's own noise of {noise} is beyond the limit \
                 of {limit}; give it more samples"
            ),
            Verdict::Unknown => {
                format!("{method}: there is no such method, or it has no {title}, for the limit {limit}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Metric;

    fn verdict(found: Option<f64>, noise: Option<f64>) -> Verdict {
        let limit =
            Threshold { method: "ours".into(), metric: Metric::RelativeMse, at_most: 1e-3, reason: "a test" };
        let errors = |value| Errors::from([("rel_mse", value)]);
        let judged = Judged::new(&limit, found.map(errors).as_ref(), noise.map(errors).as_ref());
        assert!(judged.explain().contains("ours: "), "{}", judged.explain());
        judged.verdict
    }

    #[test]
    fn a_limit_is_kept_missed_or_cannot_be_judged() {
        assert_eq!(verdict(Some(1e-3), None), Verdict::Passed);
        assert_eq!(verdict(Some(1.1e-3), None), Verdict::Missed);
        assert_eq!(verdict(Some(f64::NAN), None), Verdict::Missed);
        assert_eq!(verdict(Some(5e-4), Some(9e-4)), Verdict::Passed);
        assert_eq!(verdict(Some(5e-4), Some(1.1e-3)), Verdict::Refused);
        assert_eq!(verdict(Some(5e-4), Some(f64::INFINITY)), Verdict::Refused);
        assert_eq!(verdict(Some(5e-4), Some(f64::NAN)), Verdict::Refused);
        assert_eq!(verdict(None, None), Verdict::Unknown);
    }
}
