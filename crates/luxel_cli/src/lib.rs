//! Arguments to engine to files: the command line of Luxel.
//!
//! One file per command. Each turns its arguments into calls of `luxel_engine` or `luxel_study` and its answer into
//! text or one JSON object.
//!
//! Invariants: the answer goes to stdout, everything else (progress, notices, errors) to stderr; an error is exactly
//! one line that starts with `error: `; with `--json` stdout holds one JSON object or nothing; the exit code comes
//! from [`luxel_engine::ExitCode`]; a reader that closes the pipe is no error.
mod args;
mod compare;
mod doctor;
mod error;
mod graph;
mod ignored;
mod info;
mod interrupt;
mod log;
mod opened;
mod progress;
mod render;
mod reply;
mod showcase;
mod study;
mod targets;
mod values;

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use error::CliError;

/// Runs the program with its arguments (the first is its own name) and gives its exit code.
///
/// `source` is the folder that the program was built from: the last place where the showcase scene is looked for.
pub fn run(arguments: impl IntoIterator<Item = OsString>, source: &Path) -> ExitCode {
    log::to_stderr();
    let code = match Cli::try_parse_from(arguments) {
        Ok(cli) => answer(cli, source).unwrap_or_else(|error| error::tell(&error)),
        Err(error) => error::tell_usage(&error),
    };
    ExitCode::from(code as u8)
}

fn answer(cli: Cli, source: &Path) -> Result<luxel_engine::ExitCode, CliError> {
    match cli.command {
        None => showcase::showcase(source),
        Some(Command::Render(args)) => render::render(&args),
        Some(Command::Info(args)) => info::info(&args),
        Some(Command::Graph(args)) => graph::graph(&args),
        Some(Command::Compare(args)) => compare::compare(&args),
        Some(Command::Study(args)) => study::study(&args),
        Some(Command::Doctor(args)) => doctor::doctor(&args),
    }
}
