//! What other projects publish of scenes that Luxel can trace too (`shared/data/reference-renders/REFERENCES.json`):
//! radiances in closed form (`known`), and pictures that Mitsuba 3 converged to (`pictures`).
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use std::path::{Path, PathBuf};

mod grid;
mod judge;
mod known;
mod mitsuba;
mod pictures;
mod reference;
mod single;
mod stage;
mod view;
#[path = "../support/welch.rs"]
mod welch;

/// A file of `shared/data`; where it is missing the test is left out, except under CI.
fn shared(file: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(file);
    if path.is_file() {
        return Some(path);
    }
    assert!(std::env::var_os("CI").is_none(), "{} is missing", path.display());
    println!("SKIPPED(1): {} is missing", path.display());
    None
}
