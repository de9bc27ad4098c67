//! Runs the program as a user does, and looks at what it says and leaves behind.

#![allow(clippy::float_cmp, reason = "exact values are what is tested")]

mod common;
mod diff;
mod info;
mod merge;
mod output;
mod reference;
mod render;
