//! The program as a user meets it: started in a folder, judged by exit code, stdout, stderr and files.
#![allow(clippy::unwrap_used, dead_code)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// What a finished program left.
pub(crate) struct Outcome {
    /// Exit code; none if a signal ended it.
    pub(crate) code: Option<i32>,
    /// Everything on stdout.
    pub(crate) stdout: String,
    /// Everything on stderr.
    pub(crate) stderr: String,
}

/// The program, to be started in `folder`.
pub(crate) fn luxel(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_luxel"));
    // Without this folder Mesa's layer that selects Vulkan devices complains on stderr, and Luxel cannot stop it.
    command.current_dir(folder).env("XDG_RUNTIME_DIR", std::env::temp_dir()).env_remove("LUXEL_LOG");
    command
}

/// Runs to the end.
pub(crate) fn run(command: &mut Command) -> Outcome {
    let output = command.output().unwrap();
    Outcome {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

impl Outcome {
    /// Insists on success and gives stdout.
    pub(crate) fn succeeded(self) -> String {
        assert_eq!(self.code, Some(0), "stderr: {}", self.stderr);
        self.stdout
    }
}

/// A scene that comes with the program.
pub(crate) fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name)
}

/// Names of everything in a folder, hidden or not, sorted.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
