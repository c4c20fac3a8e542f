//! `cargo xtask soak`: the hard cases at full size, in release.
//!
//! Test targets read `LUXEL_SOAK`, and `hard_cases` prints a line `HARD-CASE id | what | time` for every case that it ends;
//! `tests/hard_cases/table.rs` says how large each is. Lines are shown as they come, and again as one table.
use std::fmt;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::{machine, vulkan};

/// Begins the line of a case that ended well.
const MARK: &str = "HARD-CASE ";

/// What the tests said.
#[derive(Debug, Default, PartialEq)]
struct Report {
    /// Case, what was done, time.
    cases: Vec<[String; 3]>,
    /// Names of tests that failed.
    failed: Vec<String>,
}

/// Test targets with cases that are larger in the soak run: package, and target.
const TARGETS: [(&str, &str); 8] = [
    ("luxel", "hard_cases"),
    ("luxel", "edit_loop"),
    ("luxel", "lights"),
    ("luxel", "samples"),
    ("luxel", "reference_renders"),
    ("luxel_cpu", "bsdf"),
    ("luxel_geom", "sampling"),
    ("luxel_scene", "areas"),
];

/// Runs the cases, with `arguments` for the test targets (names to run, say), one test after the other.
pub(crate) fn run(arguments: &[&str]) -> Result<()> {
    vulkan::ensure()?;
    let started = Instant::now();
    let mut report = Report::default();
    for (package, target) in TARGETS {
        run_target(package, target, arguments, started, &mut report)?;
    }
    println!("\n{report}");
    ensure!(report.failed.is_empty(), "{} tests failed: {}", report.failed.len(), report.failed.join(", "));
    ensure!(!report.cases.is_empty(), "no case was run");
    Ok(())
}

/// Runs a test target, and takes note of what it says.
fn run_target(
    package: &str,
    target: &str,
    arguments: &[&str],
    started: Instant,
    report: &mut Report,
) -> Result<()> {
    let target = ["test", "--release", "--package", package, "--test", target, "--"];
    let words = [&target[..], &["--nocapture", "--test-threads=1"], arguments].concat();
    let mut command = machine::cargo(&words)?;
    command.env("LUXEL_SOAK", "1").stdin(Stdio::null()).stdout(Stdio::piped());
    let mut child = command.spawn().context("cannot start cargo test")?;
    let known = report.failed.len();
    for line in child.stdout.take().into_iter().flat_map(|out| BufReader::new(out).lines()) {
        let line = line.context("cannot read the output of cargo test")?;
        if report.read(&line) {
            println!("{:>7.0} s  {line}", started.elapsed().as_secs_f64());
        }
    }
    let status = child.wait().context("cannot wait for cargo test")?;
    // Where a test failed the other targets are run all the same.
    ensure!(status.success() || report.failed.len() > known, "cargo test ended with {status}");
    Ok(())
}

impl Report {
    /// Takes note of a line; true if it is worth showing.
    fn read(&mut self, line: &str) -> bool {
        // With output shown as it comes, a test's own lines follow its name on one line.
        if let Some(at) = line.find(MARK) {
            let mut parts = line[at + MARK.len()..].splitn(3, " | ").map(|part| part.trim().to_owned());
            self.cases.push(std::array::from_fn(|_| parts.next().unwrap_or_default()));
        }
        if let Some(name) = line.strip_prefix("test ").and_then(|rest| rest.strip_suffix(" ... FAILED")) {
            self.failed.push(name.to_owned());
        } else if line == "FAILED" {
            self.failed.push("a test that printed".to_owned());
        }
        line.contains(MARK) || line.contains("FAILED") || line.contains("panicked") || line.contains("SKIP")
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut cases: Vec<_> = self.cases.iter().collect();
        cases.sort();
        for [id, what, time] in cases {
            writeln!(f, "{id:<5}{time:>10}  {what}")?;
        }
        write!(f, "{} parts of cases passed, {} tests failed", self.cases.len(), self.failed.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_and_failures_are_read() {
        let mut report = Report::default();
        let lines = [
            "running 2 tests",
            "test rays::t02_no_ray ... HARD-CASE T02 | 100 rays on the CPU | 1.5 s",
            "ok",
            "HARD-CASE T01 | 7 rays | 0.1 s",
            "test odd::t05_zero ... FAILED",
        ];
        let shown = lines.into_iter().filter(|line| report.read(line)).count();
        assert_eq!(shown, 3);
        assert_eq!(report.failed, ["odd::t05_zero"]);
        let text = report.to_string();
        assert!(
            text.starts_with("T01       0.1 s  7 rays\nT02       1.5 s  100 rays on the CPU\n"),
            "{text}"
        );
    }
}
