//! `cargo xtask bench`: see [`validation::program`].

use std::process::ExitCode;
use validation::program::{Program, main as run};

fn main() -> ExitCode {
    run(Program::Bench)
}
