//! The sheen program: a window and a command line over the compositor.
//!
//! `cli` is what can be asked for, `commands` does it, `app` is the window. Everything that a
//! technique adds stands in one file under `settings` and one under `panels`.

mod app;
mod cli;
mod commands;
mod drawing;
mod inputs;
mod loader;
mod orbit;
mod output;
mod panels;
mod path_tracing;
mod pictures;
mod progress;
mod settings;
mod state;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    let result = match &cli.command {
        Some(cli::Command::Render(arguments)) => commands::render::run(arguments),
        Some(cli::Command::Reference(arguments)) => commands::reference::run(arguments),
        Some(cli::Command::Merge(arguments)) => commands::merge::run(arguments),
        Some(cli::Command::Diff(arguments)) => commands::diff::run(arguments),
        Some(cli::Command::Info(arguments)) => commands::info::run(arguments),
        None => commands::window::run(&cli.files),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_status())
        }
    }
}
