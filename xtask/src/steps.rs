//! The steps of the commands: each spawns a program, streams what it prints and says whether it
//! succeeded.

use crate::adapter;
use std::process::{Command, Stdio};

/// Every test of every package, with doc tests and examples, after making sure that the tests
/// find a graphics adapter.
pub(crate) fn test(arguments: &[String]) -> bool {
    adapter::set_up() && run(cargo(["test", "--release", "--workspace", "--no-fail-fast"]).args(arguments))
}

/// Runs one of the measuring programs and returns its exit status: 0 where all is well, 1 where not,
/// 2 for wrong arguments, 130 where it was stopped.
pub(crate) fn measure(program: &str, arguments: &[String]) -> u8 {
    let asks = |argument: &String| matches!(argument.as_str(), "--help" | "-h");
    if !arguments.iter().any(asks) && !adapter::set_up() {
        return 1;
    }
    // Cargo's own lines would only stand between the command and its report.
    let run = ["run", "--release", "--quiet", "-p", "validation", "--bin", program, "--"];
    status(cargo(run).args(arguments))
}

/// Everything that is checked without running the code. All of it runs, so that one round shows
/// everything that is to be mended.
pub(crate) fn lint() -> bool {
    let mut succeeded = has_components();
    if succeeded {
        succeeded &= run(&mut cargo(["fmt", "--all", "--check"]));
        // The release profile everywhere: one set of artefacts serves all steps.
        let clippy = ["clippy", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"];
        succeeded &= run(&mut cargo(clippy));
    }
    let mut doc = cargo(["doc", "--release", "--workspace", "--no-deps"]);
    succeeded &= run(doc.env("RUSTDOCFLAGS", "-D warnings"));
    if runs(&mut cargo(["deny", "--version"])) {
        succeeded &= run(&mut cargo(["deny", "check", "bans", "licenses", "sources"]));
    } else {
        eprintln!("cargo-deny is not installed: licences and sources were not checked");
    }
    succeeded
}

/// Whether rustfmt and clippy are there, after adding them to the toolchain if need be.
fn has_components() -> bool {
    let present = || runs(&mut cargo(["fmt", "--version"])) && runs(&mut cargo(["clippy", "--version"]));
    if present() {
        return true;
    }
    run(Command::new("rustup").args(["component", "add", "clippy", "rustfmt"]));
    if !present() {
        eprintln!("error: rustfmt or clippy is missing; install both: rustup component add clippy rustfmt");
    }
    present()
}

/// The cargo that started this program, in the workspace's root folder.
fn cargo<const N: usize>(arguments: [&str; N]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    command
}

/// Runs a command that prints as it goes; true where it ends with status 0.
pub(crate) fn run(command: &mut Command) -> bool {
    status(command) == 0
}

/// Runs a command that prints as it goes, and returns its exit status; 1 where it has none.
fn status(command: &mut Command) -> u8 {
    eprintln!("$ {}", line(command));
    match command.status() {
        Ok(status) if status.success() => 0,
        Ok(status) => {
            eprintln!("error: {} ended with {status}", line(command));
            status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1)
        }
        Err(error) => {
            eprintln!("error: {} did not start: {error}", line(command));
            1
        }
    }
}

/// Runs a command in silence; true where it ends with status 0.
fn runs(command: &mut Command) -> bool {
    let command = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// The command as it would be typed, without the program's folder.
fn line(command: &Command) -> String {
    let program = std::path::Path::new(command.get_program());
    let program = program.file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}
