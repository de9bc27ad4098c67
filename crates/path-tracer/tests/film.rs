//! Films: exact sums, statistics, merging, files.

#[path = "film/common.rs"]
mod common;
#[path = "film/file.rs"]
mod file;
#[path = "film/merge.rs"]
mod merge;
#[path = "film/statistics.rs"]
mod statistics;
