//! A file is one idea and says which.

use std::path::Path;

use crate::{complaints, sources};

const MAX_RUST_LINES: usize = 600;
const MAX_SHADER_LINES: usize = 300;

/// A generated file is as long as what it is generated from.
fn is_generated(path: &Path) -> bool {
    path.parent().is_some_and(|folder| folder.ends_with("generated"))
}

fn too_long(path: &Path, text: &str) -> Vec<String> {
    if is_generated(path) {
        return Vec::new();
    }
    let limit = if path.extension().is_some_and(|e| e == "wesl") { MAX_SHADER_LINES } else { MAX_RUST_LINES };
    let lines = text.lines().count();
    if lines > limit { vec![format!("{lines} lines, more than {limit}")] } else { Vec::new() }
}

#[test]
fn files_are_one_idea_long() {
    let sources = sources();
    assert!(sources.len() > 30, "the tree was not read");
    assert_eq!(complaints(&sources, too_long), Vec::<String>::new());
}

#[test]
fn a_long_file_is_found() {
    let lines = |count| "x\n".repeat(count);
    assert!(
        too_long(Path::new("a.rs"), &lines(600)).is_empty()
            && too_long(Path::new("a.wesl"), &lines(300)).is_empty()
    );
    assert_eq!(too_long(Path::new("a.rs"), &lines(601)).len(), 1);
    assert_eq!(too_long(Path::new("a.wesl"), &lines(301)).len(), 1);
    assert!(too_long(Path::new("generated/a.wesl"), &lines(301)).is_empty());
}

fn no_header(path: &Path, text: &str) -> Vec<String> {
    let marker = if path.extension().is_some_and(|extension| extension == "wesl") { "//" } else { "//!" };
    if text.starts_with(marker) {
        Vec::new()
    } else {
        vec![format!("does not open with {marker} and what it is")]
    }
}

#[test]
fn every_file_says_what_it_is() {
    assert_eq!(complaints(&sources(), no_header), Vec::<String>::new());
}

#[test]
fn a_file_without_a_header_is_found() {
    for (name, text, missing) in [
        ("a.rs", "//! A.\n", 0),
        ("a.rs", "// A.\n", 1),
        ("a.rs", "use b;\n", 1),
        ("a.wesl", "// A\n", 0),
        ("a.wesl", "fn a", 1),
    ] {
        assert_eq!(no_header(Path::new(name), text).len(), missing, "{name}: {text}");
    }
}
