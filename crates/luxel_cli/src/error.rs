//! What can stop a command, and the one line that tells it.
use std::path::PathBuf;

use clap::error::ErrorKind;
use luxel_engine::output::OutputError;
use luxel_engine::{EngineError, ExitCode};
use luxel_study::StudyError;
use thiserror::Error;

use crate::reply::printable;

/// Why a command came to no answer.
#[derive(Debug, Error)]
pub(crate) enum CliError {
    /// Loading, rendering or describing a scene failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Two pictures cannot be compared, or a study cannot be made.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// Two options that exclude each other.
    #[error("{0}")]
    Usage(String),
    /// The showcase scene is nowhere.
    #[error("the showcase scene was not found; looked for {}", list(.0))]
    NoShowcase(Vec<PathBuf>),
    /// The answer could not be written to stdout.
    #[error("cannot write to stdout: {0}")]
    Stdout(std::io::Error),
    /// The answer could not be put into JSON.
    #[error("cannot write the answer as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Ctrl-C cannot be listened for.
    #[error("cannot listen for Ctrl-C: {0}")]
    Interrupt(#[from] ctrlc::Error),
}

impl From<OutputError> for CliError {
    fn from(error: OutputError) -> Self {
        Self::Engine(error.into())
    }
}

impl CliError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Engine(error) => error.exit_code(),
            Self::Study(StudyError::Engine(error)) => error.exit_code(),
            Self::Study(
                StudyError::Write { .. } | StudyError::Json(_) | StudyError::Csv(_) | StudyError::Page(_),
            ) => ExitCode::Machine,
            Self::Study(_) | Self::Usage(_) | Self::NoShowcase(_) => ExitCode::BadInput,
            Self::Stdout(_) | Self::Json(_) | Self::Interrupt(_) => ExitCode::Machine,
        }
    }
}

/// Prints the one line of an error and gives its exit code.
pub(crate) fn tell(error: &CliError) -> ExitCode {
    print_line(&one_line(&error.to_string()));
    error.exit_code()
}

/// Prints help and version as they are, a usage error as one line, and gives the exit code.
pub(crate) fn tell_usage(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // Nothing is left to do for a reader who has gone.
        _ = error.print();
        return ExitCode::Done;
    }
    let text = error.render().to_string();
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        print_line("a command is missing");
        print_help(&text);
        return ExitCode::BadInput;
    }
    let what = text.strip_prefix("error: ").unwrap_or(&text).split("\n\n").next().unwrap_or_default();
    print_line(&format!("{}; see --help", one_line(what)));
    ExitCode::BadInput
}

#[expect(clippy::print_stderr, reason = "what goes with an error belongs on stderr")]
fn print_help(text: &str) {
    eprint!("\n{text}");
}

#[expect(clippy::print_stderr, reason = "errors belong on stderr")]
fn print_line(message: &str) {
    eprintln!("error: {message}");
}

/// The message without line breaks and control characters, whatever a library or a file put into it.
pub(crate) fn one_line(message: &str) -> String {
    let line = message.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    printable(&line).into_owned()
}

fn list(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_of_many_lines_becomes_one() {
        assert_eq!(one_line("a file:\n  line 3\n\n  column 4\r\n"), "a file: line 3 column 4");
        assert_eq!(one_line(""), "");
    }

    #[test]
    fn every_error_has_its_exit_code() {
        let missing = StudyError::Io { path: "a.png".into(), source: std::io::ErrorKind::NotFound.into() };
        assert_eq!(CliError::from(missing).exit_code(), ExitCode::BadInput);
        let full = std::io::Error::from(std::io::ErrorKind::StorageFull);
        assert_eq!(CliError::Stdout(full).exit_code(), ExitCode::Machine);
        let ending = OutputError::UnknownFormat { path: "a.jpg".into() };
        assert_eq!(CliError::from(ending).exit_code(), ExitCode::BadInput);
    }
}
