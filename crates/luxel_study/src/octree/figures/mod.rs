//! The figures, from records alone: what each shows, what the report claims with it, and whether that holds.
mod best;
mod depth;
mod extra;
mod heat;
mod heights;
mod large;
mod leaves;
mod orders;
mod pictures;
mod small_depth;
#[cfg(test)]
mod tests;
mod versus;
mod wrong;

use super::chart::{Chart, Ink, Kind, Series};
use super::figure::{Figure, Part, Table};
use super::select::{Runs, STRUCTURES, backend_name, label};
use super::text::{count, times};
use super::verdict::AtCount;

/// The last figure of the report.
pub(crate) const LAST_OF_REPORT: u32 = 21;
/// Deeper octrees have the last colour of the scale.
const DEEPEST_INK: f64 = 10.0;

/// Every figure, in the order of their numbers.
pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let mut figures = pictures::figures(runs);
    figures.push(orders::figure());
    figures.extend(heat::figures(runs));
    figures.extend(versus::figures(runs));
    figures.extend(heights::figures(runs));
    figures.extend(depth::figures(runs));
    figures.extend(small_depth::figures(runs));
    figures.extend(leaves::figures(runs));
    figures.push(wrong::figure(runs));
    figures.extend(extra::figures(runs));
    figures.extend(large::figures(runs));
    figures.sort_by_key(|figure| figure.number);
    figures
}

/// A series over numbers of spheres, or any other setting.
fn series<T: Copy>(
    name: impl Into<String>,
    ink: Ink,
    over: &[T],
    value: impl Fn(T) -> Option<f64>,
) -> Series {
    Series { name: name.into(), ink, values: over.iter().map(|x| value(*x)).collect() }
}

/// The colour of a structure, with gaps on the GPU.
fn structure_ink(structure: &str, backend: &str) -> Ink {
    let index = STRUCTURES.iter().position(|name| *name == structure).unwrap_or(STRUCTURES.len());
    Ink::distinct(index).dashed(backend == "gpu")
}

/// The colour of a depth.
fn depth_ink(depth: u32) -> Ink {
    Ink::scale(f64::from(depth) / DEEPEST_INK)
}

/// A line per structure of one backend.
fn structure_lines<T: Copy>(
    runs: &Runs<'_>,
    over: &[T],
    value: impl Fn(&Runs<'_>, T) -> Option<f64>,
) -> Vec<Series> {
    let backend = runs.first().map_or("cpu", |run| run.backend.as_str());
    let line = |name: &'static str| {
        let of_it = runs.with(name);
        series(label(name), structure_ink(name, backend), over, |x| value(&of_it, x))
    };
    runs.structures().into_iter().map(line).collect()
}

/// A structure's speed against another's, by the number of spheres, on one backend.
struct Ratios {
    structure: &'static str,
    backend: String,
    ratios: Vec<AtCount>,
}

impl Ratios {
    fn name(&self) -> String {
        format!("{} on the {}", self.structure, backend_name(&self.backend))
    }

    fn at(&self, count: u32) -> Option<f64> {
        self.ratios.iter().find(|(c, _)| *c == count).map(|(_, ratio)| *ratio)
    }

    fn line(&self, counts: &[u32]) -> Series {
        series(self.name(), structure_ink(self.structure, &self.backend), counts, |count| self.at(count))
    }
}

/// How many times faster structures are than another, for each backend.
fn ratios_of(runs: &Runs<'_>, structures: &[&'static str], slow: &str) -> Vec<Ratios> {
    let mut all = Vec::new();
    for backend in runs.backends() {
        for &structure in structures {
            let ratios = runs.on(backend).ratios(structure, slow);
            if !ratios.is_empty() {
                all.push(Ratios { structure, backend: backend.to_owned(), ratios });
            }
        }
    }
    all
}

/// Ratios over columns as a table.
fn ratio_table(corner: &str, columns: Vec<String>, rows: Vec<(String, Vec<Option<f64>>)>) -> Part {
    let said = |ratio: Option<f64>| ratio.map_or_else(|| "–".to_owned(), times);
    let row = |(name, ratios): (String, Vec<Option<f64>>)| {
        std::iter::once(name).chain(ratios.into_iter().map(said)).collect()
    };
    let head = std::iter::once(corner.to_owned()).chain(columns).collect();
    Part::Table(Table { head, rows: rows.into_iter().map(row).collect() })
}

/// Numbers of spheres as categories.
fn count_names(counts: &[u32]) -> Vec<String> {
    counts.iter().map(|spheres| count(u64::from(*spheres))).collect()
}

/// Frames per second over numbers of spheres, as lines.
fn fps_over_counts(caption: String, counts: &[u32], is_log: bool, series: Vec<Series>) -> Part {
    over_counts(caption, Kind::Lines, "frames per second", counts, is_log, series)
}

fn over_counts(
    caption: String,
    kind: Kind,
    y: &'static str,
    counts: &[u32],
    is_log: bool,
    series: Vec<Series>,
) -> Part {
    let categories = count_names(counts);
    Part::Chart(Chart { caption, kind, x: "number of spheres", y, is_log, categories, series, level: None })
}
