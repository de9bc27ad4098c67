//! What is wrongly asked ends with status 2 and says how to ask.

use std::process::{Command, Output};

fn xtask(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).output().unwrap()
}

#[test]
fn wrong_usage_ends_with_status_2_and_the_usage() {
    for (arguments, complaint) in [
        (&[][..], "a command is missing"),
        (&["tset"], "unknown command \"tset\""),
        (&["lint", "--fast"], "unexpected argument \"--fast\" of lint"),
    ] {
        let output = xtask(arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(complaint) && text.contains("Usage: cargo xtask"), "{text}");
    }
}

#[test]
fn help_names_every_command() {
    let output = xtask(&["help"]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    for command in ["test", "compare", "bench", "stress", "figures", "lint", "ci", "help"] {
        assert!(text.contains(&format!("\n  {command} ")), "{text}");
    }
}

/// Starts the real program, so this also says that each of the four is built under its name.
#[test]
fn wrong_arguments_of_the_measuring_programs_end_with_status_2() {
    for program in ["compare", "bench", "stress", "figures"] {
        let output = xtask(&[program, "--help"]);
        assert!(output.status.success(), "{program}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("--technique") && text.contains("--quick"), "{text}");
    }
    let output = xtask(&["compare", "--technique", "no-such-thing", "--help-me"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
}
