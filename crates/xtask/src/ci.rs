//! `cargo xtask ci`: everything that must pass, step by step, with the time that each step took.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

use crate::{albedo, generate, machine, vulkan};

type Step = (&'static str, fn() -> Result<()>);

/// In this order: what is quick to fail comes first.
const STEPS: [Step; 8] = [
    ("machine", vulkan::ensure),
    ("format", || cargo(&["fmt", "--all", "--check"])),
    ("generated files", || generate::check().and_then(|()| albedo::check())),
    ("clippy", || cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
    ("docs", docs),
    ("house rules", || cargo(&["test", "--package", "luxel", "--test", "house_rules"])),
    ("tests", || cargo(&["xtask", "test"])),
    ("examples", examples),
];

/// Runs the steps until one fails; prints how long each took.
pub(crate) fn run() -> Result<()> {
    let mut times = Vec::new();
    let mut result = Ok(());
    for (name, step) in STEPS {
        println!("\n=== {name}");
        let started = Instant::now();
        result = step().with_context(|| format!("step \"{name}\" failed"));
        times.push((name, started.elapsed()));
        if result.is_err() {
            break;
        }
    }
    print_times(&times);
    result
}

fn print_times(times: &[(&str, Duration)]) {
    println!("\n{:<18}{:>8}", "step", "seconds");
    let total = times.iter().map(|(_, time)| *time).sum();
    for (name, time) in times.iter().chain(&[("total", total)]) {
        println!("{name:<18}{:>8.1}", time.as_secs_f64());
    }
}

fn cargo(arguments: &[&str]) -> Result<()> {
    machine::run(machine::cargo(arguments)?.stdin(Stdio::null()))
}

fn docs() -> Result<()> {
    let mut command = machine::cargo(&["doc", "--workspace", "--no-deps"])?;
    machine::run(command.env("RUSTDOCFLAGS", "-Dwarnings").stdin(Stdio::null()))
}

/// Every example runs headless at small size and leaves at least one file.
fn examples() -> Result<()> {
    for name in example_names(&machine::root().join("examples"))? {
        let out = machine::target().join("example-output").join(&name);
        if out.exists() {
            std::fs::remove_dir_all(&out)?;
        }
        std::fs::create_dir_all(&out)?;
        let started = Instant::now();
        let mut command = machine::cargo(&["run", "--quiet", "--example", &name, "--", "--quick", "--out"])?;
        machine::run(command.arg(&out).stdin(Stdio::null())).with_context(|| format!("example {name}"))?;
        let written = std::fs::read_dir(&out)?.count();
        ensure!(written > 0, "example {name} wrote nothing to {}", out.display());
        println!("example {name}: {written} files, {:.1} s", started.elapsed().as_secs_f64());
    }
    Ok(())
}

/// The names of the examples in `folder`, sorted.
fn example_names(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>()?;
    let is_example = |path: &&std::path::PathBuf| {
        path.extension() == Some(OsStr::new("rs")) || path.join("main.rs").is_file()
    };
    let mut names: Vec<String> = paths
        .iter()
        .filter(is_example)
        .filter_map(|path| path.file_stem())
        .map(|stem| stem.to_string_lossy().into_owned())
        .collect();
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_files_or_folders_with_a_main() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("walk")).unwrap();
        std::fs::create_dir(folder.path().join("data")).unwrap();
        for name in ["walk/main.rs", "data/scene.ron", "mixed.rs", "notes.md"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(example_names(folder.path()).unwrap(), ["mixed", "walk"]);
    }
}
