//! The collected data beside the workspace.
#![allow(dead_code, clippy::print_stdout)]

use std::fs;
use std::path::{Path, PathBuf};

/// A file or folder of the collected data.
pub(crate) fn shared(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    root.canonicalize().unwrap_or(root).join(name)
}

/// Fails under CI if fewer than `expected` of the data are there; says so elsewhere.
pub(crate) fn require(found: usize, expected: usize, what: &str) {
    let is_ci = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(found >= expected || (found == 0 && !is_ci), "{found} of {expected} {what} are there");
    if found == 0 {
        println!("skipped: none of {expected} {what} are there");
    }
}

/// All files below a folder whose names end in one of `endings` (any, if there are none), sorted.
pub(crate) fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![shared(folder)]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
            if path.is_dir() {
                folders.push(path);
            } else if endings.is_empty() || endings.contains(&ending.as_str()) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
