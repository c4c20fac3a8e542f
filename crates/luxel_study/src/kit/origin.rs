//! Where and when a study was made.
use std::time::SystemTime;

/// What all runs of a study share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// UTC, as RFC 3339 has it.
    pub date: String,
    /// Version of Luxel.
    pub version: String,
    /// Commit of its source, or `unknown`.
    pub commit: String,
    /// Processor, number of hardware threads, operating system.
    pub machine: String,
}

impl Origin {
    /// Here and now; the commit is what the caller knows of it.
    pub fn now(commit: Option<String>) -> Self {
        Self {
            date: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: commit.unwrap_or_else(|| "unknown".to_owned()),
            machine: machine(),
        }
    }
}

fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find(|line| line.starts_with("model name"));
    let name = name.and_then(|line| line.split(':').nth(1)).map_or(std::env::consts::ARCH, str::trim);
    format!("{name}, {threads} hardware threads, {}", std::env::consts::OS)
}
