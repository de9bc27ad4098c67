//! Which samples a film holds.

use super::MAX_SAMPLES_PER_PIXEL;
use scene::Error;
use std::fmt;
use std::ops::Range;

/// The most separate ranges. Whoever merges in order never has more than one.
const MAX_RANGES: usize = 1 << 16;

/// Sample indices as ranges: none empty, sorted, and with gaps between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleRanges(Vec<Range<u32>>);

/// Why a range cannot be added: what was found, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) found: String,
    pub(super) expected: String,
}

impl Refusal {
    pub(super) fn of(self, file: &str) -> Error {
        Error::new(file, "samples", self.found, self.expected)
    }
}

impl SampleRanges {
    /// The ranges in order.
    pub fn ranges(&self) -> &[Range<u32>] {
        &self.0
    }

    /// How many samples they are together.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|range| u64::from(range.end - range.start)).sum()
    }

    /// Samples that both have, the first range of them.
    pub fn overlap(&self, other: &Self) -> Option<Range<u32>> {
        self.0.iter().find_map(|range| other.overlap_with(range))
    }

    /// The first samples of a range that are in here.
    fn overlap_with(&self, range: &Range<u32>) -> Option<Range<u32>> {
        // The first of the ranges that ends behind the start of this one is the only candidate.
        let first = self.0.partition_point(|own| own.end <= range.start);
        let own = self.0.get(first)?;
        let both = own.start.max(range.start)..own.end.min(range.end);
        (!both.is_empty()).then_some(both)
    }

    /// Adds a range that does not overlap, and joins it to its neighbours. An empty one is nothing.
    pub(super) fn insert(&mut self, range: Range<u32>) -> Result<(), Refusal> {
        if range.is_empty() {
            return Ok(());
        }
        if let Some(both) = self.overlap_with(&range) {
            let found = format!("{} twice", display(&both));
            return Err(Refusal { found, expected: "each sample once".into() });
        }
        let count = self.count() + u64::from(range.end - range.start);
        if count > u64::from(MAX_SAMPLES_PER_PIXEL) {
            let found = format!("{count} samples a pixel");
            return Err(Refusal { found, expected: format!("at most {MAX_SAMPLES_PER_PIXEL}") });
        }
        let place = self.0.partition_point(|own| own.end <= range.start);
        self.0.insert(place, range);
        self.0.dedup_by(|next, own| {
            let touch = own.end == next.start;
            if touch {
                own.end = next.end;
            }
            touch
        });
        if self.0.len() > MAX_RANGES {
            let found = format!("{} separate ranges", self.0.len());
            return Err(Refusal { found, expected: format!("at most {MAX_RANGES}") });
        }
        Ok(())
    }

    /// The ranges of their own text.
    pub(super) fn parse(text: &str) -> Result<Self, Refusal> {
        let mut ranges = Self::default();
        if text == NONE {
            return Ok(ranges);
        }
        for part in text.split(", ") {
            let ends = part.split_once("..").and_then(|(start, end)| Some(number(start)?..number(end)?));
            let Some(range) = ends.filter(|range| !range.is_empty()) else {
                let expected = "ranges such as 0..16, 32..48".into();
                return Err(Refusal { found: format!("{part:?}"), expected });
            };
            ranges.insert(range)?;
        }
        Ok(ranges)
    }
}

const NONE: &str = "none";

fn number(text: &str) -> Option<u32> {
    text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok())?
}

pub(super) fn display(range: &Range<u32>) -> String {
    format!("{}..{}", range.start, range.end)
}

impl fmt::Display for SampleRanges {
    /// "0..16, 32..48", or "none".
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return formatter.write_str(NONE);
        }
        formatter.write_str(&self.0.iter().map(display).collect::<Vec<_>>().join(", "))
    }
}
