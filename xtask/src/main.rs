//! Sheen's developer commands, run as `cargo xtask COMMAND`. Each spawns cargo; none links wgpu.

mod adapter;
mod steps;

use std::process::ExitCode;

const USAGE: &str = "\
Sheen's developer commands

Usage: cargo xtask COMMAND

  test [ARGUMENTS]  install what the tests need where that is missing, then run every test;
                    arguments are handed to `cargo test`
  compare [ARGUMENTS]  how wrong each method is: target/compare/index.html; fails where a limit is missed
  bench [ARGUMENTS]    what each method costs: target/bench/index.html
  stress [ARGUMENTS]   library functions and frames under hostile input: target/stress/index.html;
                       fails where anything breaks
  figures [ARGUMENTS]  the figures and tables of the papers: target/figures/index.html
                       arguments of these four: [--technique T] [--scene S] [--quick] [--fresh];
                       --help names them all
  lint              formatting, clippy, rustdoc, and licences where cargo-deny is installed
  ci                lint, compare --quick, stress --quick, test; fails where any of them fails
  help              this text
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (command, rest) = match arguments.split_first() {
        Some((command, rest)) => (command.as_str(), rest),
        None => return usage_error("a command is missing"),
    };
    let succeeded = match (command, rest) {
        ("compare" | "bench" | "stress" | "figures", arguments) => {
            return ExitCode::from(steps::measure(command, arguments));
        }
        ("test", arguments) => steps::test(arguments),
        ("lint", []) => steps::lint(),
        ("ci", []) => {
            let lint = steps::lint();
            let quick = ["--quick".to_owned()];
            let compare = steps::measure("compare", &quick) == 0;
            let stress = steps::measure("stress", &quick) == 0;
            // The tests run last whatever came before, so that their results are always seen.
            let test = steps::test(&[]);
            lint && compare && stress && test
        }
        ("help" | "--help" | "-h", _) => {
            print!("{USAGE}");
            true
        }
        ("lint" | "ci", [argument, ..]) => {
            return usage_error(&format!("unexpected argument \"{argument}\" of {command}"));
        }
        _ => return usage_error(&format!("unknown command \"{command}\"")),
    };
    if succeeded { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Bad usage ends with status 2.
fn usage_error(message: &str) -> ExitCode {
    eprintln!("error: {message}\n\n{USAGE}");
    ExitCode::from(2)
}
