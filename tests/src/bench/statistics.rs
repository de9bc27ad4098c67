//! Median and 95th percentile of times.

use serde::Serialize;

/// What a series of times says, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Times {
    /// Half of the times are below.
    pub(crate) median: f64,
    /// 95 of 100 times are not above (nearest rank).
    pub(crate) p95: f64,
    /// How many there are.
    pub(crate) count: usize,
}

/// `None` where there are no times.
pub(crate) fn times(values: &[f64]) -> Option<Times> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let middle = count.checked_sub(1)? / 2;
    let median = 0.5 * (sorted[middle] + sorted[count / 2]);
    let rank = (95 * count).div_ceil(100);
    Some(Times { median, p95: sorted[rank - 1], count })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_series() {
        assert_eq!(times(&[]), None);
        assert_eq!(times(&[3.0]), Some(Times { median: 3.0, p95: 3.0, count: 1 }));
        assert_eq!(times(&[4.0, 1.0]), Some(Times { median: 2.5, p95: 4.0, count: 2 }));
        assert_eq!(times(&[9.0, 1.0, 2.0]), Some(Times { median: 2.0, p95: 9.0, count: 3 }));
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(times(&hundred), Some(Times { median: 50.5, p95: 95.0, count: 100 }));
        let twenty: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(times(&twenty), Some(Times { median: 10.5, p95: 19.0, count: 20 }));
    }
}
