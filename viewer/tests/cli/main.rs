//! Runs the program as a user does, and looks at what it says and leaves behind.

mod common;
mod diff;
mod info;
mod merge;
mod output;
mod reference;
mod render;
