//! Runs the program as a user does, and looks at what it says and leaves behind.

mod common;
mod info;
mod render;
