//! A record as text: how the structures compare, every benchmark, and what compiling the kernels costs.

use std::fmt::Write as _;

use serde_json::Value;

use super::{Benchmark, Record};

/// Whose benchmarks the others of their group are compared with.
const OWN: &str = "luxel";

pub(super) fn markdown(record: &Record) -> String {
    let Record { date, machine, load, rustc, commit, .. } = record;
    let mut text =
        format!("# Benches, {date}\n\n{machine}, load {load} when it began; {rustc}; commit {commit}\n");
    text.push_str(&comparisons(&record.benchmarks));
    text.push_str(&benchmarks(&record.benchmarks));
    if let Some(compile) = &record.compile {
        text.push_str(&compile_times(compile));
    }
    text
}

/// One sentence for each group that has a benchmark of ours and one of others.
fn comparisons(benchmarks: &[Benchmark]) -> String {
    let mut text = String::from("\n## Beside other crates\n\n");
    for own in benchmarks {
        let Some((group, OWN)) = own.name.rsplit_once('/') else { continue };
        let others: Vec<String> = benchmarks.iter().filter_map(|other| ratio(own, other, group)).collect();
        if !others.is_empty() {
            _ = writeln!(text, "- {group}: Luxel is {}.", others.join(", "));
        }
    }
    text
}

/// How fast `own` is in terms of `other`, if that belongs to the same group.
fn ratio(own: &Benchmark, other: &Benchmark, group: &str) -> Option<String> {
    let (their_group, name) = other.name.rsplit_once('/')?;
    let is_comparable = their_group == group && name != OWN;
    is_comparable.then(|| format!("{:.2} times as fast as `{name}`", other.median_ns / own.median_ns))
}

fn benchmarks(benchmarks: &[Benchmark]) -> String {
    let mut text = String::from(
        "\n## Every benchmark\n\n| benchmark | median | 95 % interval | millions per second |\n|---|---:|---:|---:|\n",
    );
    for row in benchmarks {
        let rate = row.elements_per_sec.map_or_else(String::new, |rate| format!("{:.3}", rate * 1e-6));
        let (median, low, high) = (time(row.median_ns), time(row.low_ns), time(row.high_ns));
        _ = writeln!(text, "| {} | {median} | {low} – {high} | {rate} |", row.name);
    }
    text
}

/// A row for each kernel of each scene.
fn compile_times(compile: &Value) -> String {
    let words = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let mut text = format!(
        "\n## Compiling the kernels\n\n{}, {}; nothing cached. A pipeline is made once and compiled to machine code in its \
         first run; the scene's CPU time is that of both, all kernels together.\n\n\
         | scene | features | CPU s | kernel | functions | bindings | made, CPU s | first run, s |\n\
         |---|---:|---:|---|---:|---:|---:|---:|\n",
        words(&compile["device"]),
        words(&compile["driver"])
    );
    for scene in compile["scenes"].as_array().into_iter().flatten() {
        let (name, features) = (words(&scene["scene"]), &scene["features"]);
        let mut lead = format!("{name} | {features} | {:.3}", seconds(&scene["cpu_ms"]));
        for row in scene["kernels"].as_array().into_iter().flatten() {
            let (kernel, functions, bindings) = (words(&row["kernel"]), &row["functions"], &row["bindings"]);
            let [made, first_run] = ["create_cpu_ms", "first_run_ms"].map(|key| seconds(&row[key]));
            _ = writeln!(
                text,
                "| {lead} | {kernel} | {functions} | {bindings} | {made:.3} | {first_run:.3} |"
            );
            lead = String::from(" | | ");
        }
    }
    text
}

/// Seconds from a value in milliseconds.
fn seconds(milliseconds: &Value) -> f64 {
    milliseconds.as_f64().unwrap_or(f64::NAN) * 1e-3
}

/// A time with the unit that suits it, four digits.
fn time(nanoseconds: f64) -> String {
    let units = [(1e9, "s"), (1e6, "ms"), (1e3, "µs")];
    let (scale, unit) = units.into_iter().find(|(scale, _)| nanoseconds >= *scale).unwrap_or((1.0, "ns"));
    let value = nanoseconds / scale;
    let digits = if value < 10.0 {
        3
    } else if value < 100.0 {
        2
    } else {
        1
    };
    format!("{value:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn benchmark(name: &str, median_ns: f64) -> Benchmark {
        let elements_per_sec = Some(1e12 / median_ns);
        Benchmark {
            name: name.to_owned(),
            median_ns,
            low_ns: median_ns,
            high_ns: median_ns,
            elements_per_sec,
        }
    }

    #[test]
    fn times_are_readable() {
        assert_eq!(
            [time(12.34), time(4_567.0), time(2.5e6), time(3e9)],
            ["12.34 ns", "4.567 µs", "2.500 ms", "3.000 s"]
        );
    }

    #[test]
    fn groups_are_compared() {
        let all = [benchmark("hit/luxel", 2e6), benchmark("hit/obvhs", 1e6), benchmark("build/luxel", 5.0)];
        let text = comparisons(&all);
        assert!(text.contains("- hit: Luxel is 0.50 times as fast as `obvhs`."), "{text}");
        assert!(!text.contains("build"), "there is nothing to compare with: {text}");
    }

    #[test]
    fn each_kernel_has_a_row() {
        let kernel = |name: &str| json!({"kernel": name, "functions": 2, "bindings": 1, "create_cpu_ms": 250.0, "first_run_ms": 40.0});
        let scene =
            json!({"scene": "a", "features": 3, "cpu_ms": 700.0, "kernels": [kernel("x"), kernel("y")]});
        let text = compile_times(&json!({"device": "d", "driver": "v", "scenes": [scene]}));
        assert!(text.contains("| a | 3 | 0.700 | x | 2 | 1 | 0.250 | 0.040 |"), "{text}");
        assert!(text.contains("|  | |  | y | 2 | 1 |"), "{text}");
    }
}
