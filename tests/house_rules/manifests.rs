//! Versions, editions and licences live in one place: the workspace table of the root manifest.

use std::path::{Path, PathBuf};

use crate::{complaints, root};

/// Manifest entries that must come from the workspace table.
const SHARED_KEYS: [&str; 5] = ["version", "edition", "rust-version", "license", "publish"];

fn own_versions(_path: &Path, manifest: &str) -> Vec<String> {
    let mut section = "";
    let mut found = Vec::new();
    for line in manifest.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if line.starts_with('[') {
            section = line;
            continue;
        }
        let key = line.split(['=', '.', ' ']).next().unwrap_or_default();
        let is_shared = line.replace(' ', "").contains("workspace=true");
        let is_dependency = section.contains("dependencies") && !section.contains("workspace.");
        let is_one_of_many = is_dependency && section.ends_with("dependencies]");
        let is_own_source = is_dependency && ["version", "path", "git", "registry"].contains(&key);
        let is_own_key = section == "[package]" && SHARED_KEYS.contains(&key);
        if is_own_source || ((is_one_of_many || is_own_key) && !is_shared) {
            found.push(format!("{section} {line}"));
        }
    }
    found
}

fn manifests() -> Vec<PathBuf> {
    let crates = std::fs::read_dir(root().join("crates")).unwrap();
    let of_crates =
        crates.map(|entry| entry.unwrap().path().join("Cargo.toml")).filter(|path| path.is_file());
    of_crates.chain([root().join("Cargo.toml")]).collect()
}

#[test]
fn versions_live_in_the_workspace_table() {
    assert!(manifests().len() > 10, "the tree was not read");
    assert_eq!(complaints(&manifests(), own_versions), Vec::<String>::new());
}

#[test]
fn a_version_of_its_own_is_found() {
    let of = |text: &str| own_versions(Path::new("Cargo.toml"), text);
    for own in [
        "[dependencies]\nglam = \"0.33\"",
        "[dev-dependencies]\nglam = { version = \"0.33\" }",
        "[target.'cfg(unix)'.dependencies]\nglam = { path = \"../glam\" }",
        "[dependencies.glam]\nversion = \"0.33\"",
        "[package]\nedition = \"2021\"",
    ] {
        assert_eq!(of(own).len(), 1, "{own}");
    }
    let shared = "[package]\nname = \"x\"\nversion.workspace = true\n[dependencies]\nglam.workspace = true\n\
        serde = { workspace = true, features = [\"derive\"] }\n[dependencies.image]\nworkspace = true\nfeatures = []\n\
        [workspace.dependencies]\nglam = \"0.33\"";
    assert_eq!(of(shared), Vec::<String>::new());
}
