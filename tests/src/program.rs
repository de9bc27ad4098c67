//! What the four programs have in common: arguments, the progress bar, Ctrl-C, the exit status.

mod progress;

pub(crate) use progress::Progress;

use crate::{
    Context, Scope, bench, compare, figures,
    report::{Header, Page, load, now},
    stress,
    technique::{Failure, Technique},
};
use clap::Parser;
use scene::output::{check_place, write_whole};
use serde::Serialize;
use std::{
    ffi::OsString,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

/// Everything was done and is well.
pub const PASSED: u8 = 0;
/// A limit was missed, or something could not be measured or written.
pub const FAILED: u8 = 1;
/// The arguments make no sense.
pub const USAGE: u8 = 2;
/// The run was stopped, as by Ctrl-C; what was finished is in the report.
pub const INTERRUPTED: u8 = 130;

/// Which of the programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// How wrong each method is.
    Compare,
    /// What each method costs.
    Bench,
    /// What breaks.
    Stress,
    /// The figures and tables of the papers.
    Figures,
}

#[derive(Debug, Parser)]
#[command(disable_help_subcommand = true)]
struct Arguments {
    /// Only this technique
    #[arg(long, value_name = "T")]
    technique: Option<String>,
    /// Only scenes (of figures: the figure) of this name
    #[arg(long, value_name = "S")]
    scene: Option<String>,
    /// Smaller and fewer: for every change
    #[arg(long)]
    quick: bool,
    /// Make every truth anew instead of taking what earlier runs kept
    #[arg(long)]
    fresh: bool,
    /// Folder of the report; target/PROGRAM if not given
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

/// A run of one program.
pub(crate) struct Run<'a> {
    /// What every closure gets.
    pub(crate) context: Context,
    /// What is to be measured.
    pub(crate) techniques: Vec<&'a Technique>,
    /// What the report says of the run.
    pub(crate) header: Header,
    /// The bar.
    pub(crate) progress: Progress,
    folder: PathBuf,
}

/// How a run ended, besides what its report says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All is well; one line.
    Passed(String),
    /// What is not, one line each.
    Failed(Vec<String>),
}

/// `--scene` names nothing that there is.
#[derive(Debug, thiserror::Error)]
#[error("unknown scene \"{wanted}\"; known are: {known}")]
struct UnknownScene {
    wanted: String,
    known: String,
}

impl Program {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Compare => "compare",
            Self::Bench => "bench",
            Self::Stress => "stress",
            Self::Figures => "figures",
        }
    }
}

/// Runs a program over techniques, with the arguments of the command line after the program's name,
/// and returns the exit status.
///
/// `stop` ends the run early, with what was finished in the report.
pub fn run(
    program: Program,
    techniques: &[Technique],
    arguments: impl IntoIterator<Item = OsString>,
    stop: &Arc<AtomicBool>,
) -> u8 {
    let words = std::iter::once(program.name().into()).chain(arguments);
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Where even the standard streams are closed there is nobody to tell.
            error.print().ok();
            return if error.use_stderr() { USAGE } else { PASSED };
        }
    };
    match chosen(techniques, arguments.technique.as_deref()) {
        Err(message) => {
            eprintln!("error: {message}");
            USAGE
        }
        Ok(techniques) => match start(program, techniques, arguments, stop) {
            Ok(status) => status,
            Err(error) => {
                eprintln!("error: {error}");
                if error.is::<UnknownScene>() { USAGE } else { FAILED }
            }
        },
    }
}

/// Runs a program for the command line of this process: Ctrl-C stops it, and a second one ends it.
pub fn main(program: Program) -> std::process::ExitCode {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        eprintln!("\nstopping: what is finished will be in the report (once more: at once)");
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        eprintln!("warning: Ctrl-C ends this run without a report: {error}");
    }
    run(program, crate::techniques::TECHNIQUES, std::env::args_os().skip(1), &stop).into()
}

fn chosen<'a>(techniques: &'a [Technique], name: Option<&str>) -> Result<Vec<&'a Technique>, String> {
    let chosen: Vec<&Technique> =
        techniques.iter().filter(|technique| name.is_none_or(|name| name == technique.name)).collect();
    if chosen.is_empty() {
        let known: Vec<&str> = techniques.iter().map(|technique| technique.name).collect();
        return Err(format!(
            "unknown technique \"{}\"; known are: {}",
            name.unwrap_or_default(),
            known.join(", ")
        ));
    }
    Ok(chosen)
}

fn start(
    program: Program,
    techniques: Vec<&Technique>,
    arguments: Arguments,
    stop: &Arc<AtomicBool>,
) -> Result<u8, Failure> {
    let target = target_folder();
    let folder = arguments.out.unwrap_or_else(|| target.join(program.name()));
    // Before anything is measured, so that nobody waits for what cannot be kept.
    make_folder(&folder)?;
    check_place(&folder.join("index.html"))?;
    let progress = Progress::new();
    let scope = Scope { quick: arguments.quick, scene: arguments.scene, fresh: arguments.fresh };
    let status = progress.clone();
    let context = Context::new(scope.clone(), target.join("references"))?
        .with_progress(Arc::clone(stop), move |line| status.detail(line));
    let header = Header {
        program: program.name(),
        version: env!("CARGO_PKG_VERSION"),
        date: now(),
        adapter: context.gpu().adapter_label(),
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        load: load(),
        quick: scope.quick,
        interrupted: false,
    };
    let mut run = Run { context, techniques, header, progress, folder };
    let outcome = match program {
        Program::Compare => compare::run(&mut run),
        Program::Bench => bench::run(&mut run),
        Program::Stress => stress::run(&mut run),
        Program::Figures => figures::run(&mut run),
    };
    run.progress.finish();
    let outcome = outcome?;
    let page = run.folder.join("index.html");
    println!("{}", page.canonicalize().unwrap_or(page).display());
    let failed = match outcome {
        Outcome::Passed(line) => {
            println!("{line}");
            false
        }
        Outcome::Failed(lines) => {
            for line in lines {
                eprintln!("failed: {line}");
            }
            true
        }
    };
    Ok(match (run.context.is_stopped(), failed) {
        (true, _) => INTERRUPTED,
        (false, true) => FAILED,
        (false, false) => PASSED,
    })
}

/// Makes a folder and those that it is in; the error names it.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|error| format!("{}: the folder cannot be made: {error}", folder.display()).into())
}

/// The folder of build outputs, in which reports and truths lie too.
fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"), PathBuf::from)
}

impl Run<'_> {
    /// Runs a closure of a registration; a panic in it is a failure like any other.
    pub(crate) fn guard<T>(
        &mut self,
        work: impl FnOnce(&mut Context) -> Result<T, Failure>,
    ) -> Result<T, String> {
        let context = &mut self.context;
        match catch_unwind(AssertUnwindSafe(|| work(context))) {
            Ok(result) => result.map_err(|error| error.to_string()),
            Err(panic) => {
                let text = panic.downcast_ref::<String>().cloned();
                let text = text.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string));
                Err(format!("panicked: {}", text.unwrap_or_else(|| "without a text".into())))
            }
        }
    }

    /// Whether a scene of this name is asked for.
    pub(crate) fn wants(&self, scene: &str) -> bool {
        self.context.scope().scene.as_deref().is_none_or(|wanted| wanted == scene)
    }

    /// Fails where `--scene` leaves nothing to do, with the names that there are.
    pub(crate) fn check_scene(&self, scenes: &[String]) -> Result<(), Failure> {
        let Some(wanted) = &self.context.scope().scene else { return Ok(()) };
        if scenes.contains(wanted) {
            return Ok(());
        }
        let mut known = scenes.to_vec();
        known.sort();
        known.dedup();
        Err(UnknownScene { wanted: wanted.clone(), known: known.join("; ") }.into())
    }

    /// Writes the report: JSON under `json_name`, and the page.
    pub(crate) fn write(&self, json_name: &str, json: &impl Serialize, page: Page) -> Result<(), Failure> {
        write_whole(&self.folder.join(json_name), &serde_json::to_vec_pretty(json)?)?;
        write_whole(&self.folder.join("index.html"), page.finish().as_bytes())?;
        Ok(())
    }
}
