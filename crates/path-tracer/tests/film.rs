//! Films: exact sums, statistics, merging, files.

#![allow(clippy::float_cmp, reason = "exact values are what is tested")]

#[path = "film/common.rs"]
mod common;
#[path = "film/file.rs"]
mod file;
#[path = "film/merge.rs"]
mod merge;
#[path = "film/statistics.rs"]
mod statistics;
