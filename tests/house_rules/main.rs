//! The rules of the house that a compiler does not check: which room may open which door, how long a file may be, what
//! may not be written, where versions live, and that every file says what it is.
//!
//! Each rule is a function from text to complaints. One test runs it over the whole tree; another shows it failing.

#![allow(clippy::unwrap_used)]

mod doors;
mod files;
mod manifests;
mod words;

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap()
}

/// Every file with one of the `extensions` under `folder`, sorted; nothing if the folder is not there.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extensions));
        } else if path
            .extension()
            .is_some_and(|extension| extensions.iter().any(|wanted| extension == *wanted))
        {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Source files of the whole project.
fn sources() -> Vec<PathBuf> {
    let folders = ["crates", "examples", "tests", "benches", "shaders"];
    folders.iter().flat_map(|folder| files(&root().join(folder), &["rs", "wesl"])).collect()
}

/// What `rule` says about each file of `paths`, with the name of the file.
fn complaints(paths: &[PathBuf], rule: impl Fn(&Path, &str) -> Vec<String>) -> Vec<String> {
    let root = root();
    let of_file = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).unwrap();
        let name = path.strip_prefix(&root).unwrap_or(path).to_owned();
        rule(&name, &text).into_iter().map(move |complaint| format!("{}: {complaint}", name.display()))
    };
    paths.iter().flat_map(of_file).collect()
}
