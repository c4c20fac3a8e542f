//! Adds up what many test binaries print.

use std::fmt;
use std::ops::Add;

/// How many tests passed, failed and were skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Summary {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    pub(crate) skipped: u64,
}

impl Summary {
    /// Counts what one line of output reports:
    ///
    /// * `test result: ok. 5 passed; 0 failed; 1 ignored; …` closes a test binary; ignored tests are skipped;
    /// * `SKIPPED(2): no adapter` says that the test that printed it left out so many checks;
    /// * `LUXEL-GPU-SKIP 7: no adapter` says that a test did nothing for want of a GPU (`luxel_gpu::testing`).
    pub(crate) fn read(&mut self, line: &str) {
        let line = line.trim();
        if let Some(counts) = line.strip_prefix("test result: ") {
            let count = |what: &str| {
                counts.split([';', '.']).find_map(|part| part.strip_suffix(what)?.trim().parse().ok())
            };
            self.passed += count(" passed").unwrap_or(0);
            self.failed += count(" failed").unwrap_or(0);
            self.skipped += count(" ignored").unwrap_or(0);
        } else if let Some(rest) = line.strip_prefix("SKIPPED(") {
            self.skipped += rest.split(')').next().and_then(|count| count.parse().ok()).unwrap_or(1);
        } else if line.starts_with("LUXEL-GPU-SKIP") {
            self.skipped += 1;
        }
    }
}

impl Add for Summary {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            passed: self.passed + other.passed,
            failed: self.failed + other.failed,
            skipped: self.skipped + other.skipped,
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adds_up_binaries_and_counted_skips() {
        let output = "\
running 3 tests
test a ... ok
test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.01s
---- gpu stdout ----
SKIPPED(4): no Vulkan adapter and LUXEL_ALLOW_NO_GPU=1
LUXEL-GPU-SKIP 1: no adapter
test result: FAILED. 5 passed; 2 failed; 0 ignored; 0 measured; 7 filtered out; finished in 1.50s";
        let mut summary = Summary::default();
        output.lines().for_each(|line| summary.read(line));
        assert_eq!(summary.to_string(), "17 passed, 2 failed, 6 skipped");
    }
}
