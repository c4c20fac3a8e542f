//! `cargo xtask bench`: runs the benches and keeps a compact table of them, with machine, date and commit.
//!
//! Criterion leaves `benchmark.json` (names, work per iteration) and `estimates.json` (times in nanoseconds) in a folder
//! `new` for each benchmark; the bench `compile` leaves `tmp/compile.json`. What those say goes to
//! `benches/results/DATE-MACHINE.json`, and the same as tables to the `.md` beside it.

mod table;

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::SystemTime;

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use serde_json::Value;

use crate::machine;

/// One run of the benches.
#[derive(Serialize)]
struct Record {
    date: String,
    machine: String,
    /// Processes that wanted a core when the run began: above the number of cores, times are noisy.
    load: String,
    rustc: String,
    commit: String,
    benchmarks: Vec<Benchmark>,
    /// What compiling the kernels cost, as the bench left it.
    compile: Option<Value>,
}

/// One benchmark: the median time of an iteration with its 95 % confidence interval.
#[derive(Debug, PartialEq, Serialize)]
struct Benchmark {
    name: String,
    median_ns: f64,
    low_ns: f64,
    high_ns: f64,
    /// Elements (rays, primitives, …) per second, where the benchmark says how many an iteration handles.
    elements_per_sec: Option<f64>,
}

/// Runs `cargo bench` with `arguments` for criterion, then writes the record of what has been measured.
pub(crate) fn run(arguments: &[&str]) -> Result<()> {
    let started = SystemTime::now();
    let load = load();
    let words = [&["bench", "--bench", "*", "--"], arguments].concat();
    machine::run(machine::cargo(&words)?.stdin(Stdio::null()))?;
    let mut benchmarks = Vec::new();
    collect(&machine::target().join("criterion"), started, &mut benchmarks)?;
    ensure!(!benchmarks.is_empty(), "no benchmark was measured");
    benchmarks.sort_by(|a, b| a.name.cmp(&b.name));
    write(&Record {
        date: date()?,
        machine: describe_machine(),
        load,
        rustc: output_or_unknown("rustc", &["--version"]),
        commit: output_or_unknown("git", &["describe", "--always", "--dirty"]),
        benchmarks,
        compile: compile_times(started)?,
    })
}

/// Adds the benchmarks under `folder` that were measured after `started`.
fn collect(folder: &Path, started: SystemTime, found: &mut Vec<Benchmark>) -> Result<()> {
    let estimates = folder.join("estimates.json");
    if folder.ends_with("new") && estimates.is_file() {
        if estimates.metadata()?.modified()? >= started {
            found.push(benchmark(&read_json(&folder.join("benchmark.json"))?, &read_json(&estimates)?)?);
        }
        return Ok(());
    }
    for entry in std::fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, started, found)?;
        }
    }
    Ok(())
}

/// What the bench `compile` wrote after `started`; nothing if it did not run or found no adapter.
fn compile_times(started: SystemTime) -> Result<Option<Value>> {
    let path = machine::target().join("tmp/compile.json");
    let written = path.metadata().and_then(|metadata| metadata.modified());
    if written.is_ok_and(|written| written >= started) { read_json(&path).map(Some) } else { Ok(None) }
}

fn read_json(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_str(&text).with_context(|| format!("{} is not JSON", path.display()))
}

fn benchmark(about: &Value, estimates: &Value) -> Result<Benchmark> {
    let name = about["full_id"].as_str().context("benchmark.json has no full_id")?.to_owned();
    let time = |pointer: &str| {
        let value = estimates.pointer(pointer).and_then(Value::as_f64);
        value.with_context(|| format!("{name}: estimates.json has no {pointer}"))
    };
    let median_ns = time("/median/point_estimate")?;
    let low_ns = time("/median/confidence_interval/lower_bound")?;
    let high_ns = time("/median/confidence_interval/upper_bound")?;
    let elements_per_sec =
        about["throughput"]["Elements"].as_f64().map(|elements| elements / (median_ns * 1e-9));
    Ok(Benchmark { name, median_ns, low_ns, high_ns, elements_per_sec })
}

fn write(record: &Record) -> Result<()> {
    let folder = machine::root().join("benches/results");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let stem = folder.join(format!("{}-{}", record.date, file_name(&record.machine)));
    let save = |extension: &str, text: String| -> Result<()> {
        let path = PathBuf::from(format!("{}.{extension}", stem.display()));
        std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
        println!("wrote {}", path.display());
        Ok(())
    };
    save("json", serde_json::to_string_pretty(record)? + "\n")?;
    save("md", table::markdown(record))
}

fn date() -> Result<String> {
    machine::output_of("date", &["-u", "+%F"]).context("cannot tell the date")
}

/// Processor and number of cores.
fn describe_machine() -> String {
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = about.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let model = model.map_or("unknown processor", |(_, model)| model.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{model}, {cores} cores")
}

/// The load average of the last minute.
fn load() -> String {
    let about = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    about.split_whitespace().next().unwrap_or("unknown").to_owned()
}

fn output_or_unknown(program: &str, arguments: &[&str]) -> String {
    machine::output_of(program, arguments).unwrap_or_else(|| "unknown".to_owned())
}

/// Lower-case words joined by `-`.
fn file_name(text: &str) -> String {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use serde_json::json;

    use super::*;

    fn leave_measurement(folder: &Path, name: &str) {
        let folder = folder.join(name).join("new");
        std::fs::create_dir_all(&folder).unwrap();
        let about = json!({"full_id": name, "throughput": {"Elements": 1000}});
        let estimates = json!({"median": {"point_estimate": 2000.0,
            "confidence_interval": {"lower_bound": 1900.0, "upper_bound": 2100.0}}});
        std::fs::write(folder.join("benchmark.json"), about.to_string()).unwrap();
        std::fs::write(folder.join("estimates.json"), estimates.to_string()).unwrap();
    }

    #[test]
    fn collects_what_this_run_measured() {
        let folder = tempfile::tempdir().unwrap();
        let before = SystemTime::now() - Duration::from_secs(60);
        leave_measurement(folder.path(), "bvh/build");
        let mut found = Vec::new();
        collect(folder.path(), before, &mut found).unwrap();
        assert_eq!((found.len(), found[0].name.as_str(), found[0].median_ns), (1, "bvh/build", 2000.0));
        assert!(found[0].elements_per_sec.is_some_and(|rate| (rate - 5e8).abs() < 1.0));

        found.clear();
        collect(folder.path(), SystemTime::now() + Duration::from_secs(60), &mut found).unwrap();
        assert_eq!(found, []);
    }

    #[test]
    fn file_names_are_plain() {
        assert_eq!(file_name("AMD EPYC(tm) 7B13, 2 cores"), "amd-epyc-tm-7b13-2-cores");
    }
}
