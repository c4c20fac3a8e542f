//! Figures from records: series, tables, pictures, the same in every study.
use super::chart::{Chart, Ink, Kind, Series};
use super::figure::{Part, Table};
use super::record::Record;
use super::select::Runs;
use super::text::{count, times};
use super::verdict::Verdict;

/// A series over the values of a setting.
pub(crate) fn series<T: Copy>(
    name: impl Into<String>,
    ink: Ink,
    over: &[T],
    value: impl Fn(T) -> Option<f64>,
) -> Series {
    Series { name: name.into(), ink, values: over.iter().map(|x| value(*x)).collect() }
}

/// The colour of a structure, with gaps on the GPU.
pub(crate) fn structure_ink<R: Record>(structure: &str, backend: &str) -> Ink {
    let index = R::STRUCTURES.iter().position(|name| *name == structure).unwrap_or(R::STRUCTURES.len());
    Ink::distinct(index).dashed(backend == "gpu")
}

/// A line per structure of one backend.
pub(crate) fn structure_lines<R: Record, T: Copy>(
    runs: &Runs<'_, R>,
    over: &[T],
    value: impl Fn(&Runs<'_, R>, T) -> Option<f64>,
) -> Vec<Series> {
    let backend = runs.first().map_or("cpu", |run| run.common().backend);
    let line = |name: &'static str| {
        let of_it = runs.with(name);
        series(R::label(name), structure_ink::<R>(name, backend), over, |x| value(&of_it, x))
    };
    runs.structures().into_iter().map(line).collect()
}

/// Ratios over columns as a table.
pub(crate) fn ratio_table(corner: &str, columns: Vec<String>, rows: Vec<(String, Vec<Option<f64>>)>) -> Part {
    let said = |ratio: Option<f64>| ratio.map_or_else(|| "–".to_owned(), times);
    let row = |(name, ratios): (String, Vec<Option<f64>>)| {
        std::iter::once(name).chain(ratios.into_iter().map(said)).collect()
    };
    let head = std::iter::once(corner.to_owned()).chain(columns).collect();
    Part::Table(Table { head, rows: rows.into_iter().map(row).collect() })
}

/// Numbers of things as categories.
pub(crate) fn count_names(counts: &[u32]) -> Vec<String> {
    counts.iter().map(|number| count(u64::from(*number))).collect()
}

/// Lines over categories.
pub(crate) fn lines(
    caption: String,
    x: &'static str,
    y: &'static str,
    is_log: bool,
    categories: Vec<String>,
    series: Vec<Series>,
) -> Part {
    Part::Chart(Chart { caption, kind: Kind::Lines, x, y, is_log, categories, series, level: None })
}

/// The picture of a run, if it has one.
pub(crate) fn picture<R: Record>(run: Option<&R>, alt: &str) -> Vec<Part> {
    let picture = run.and_then(|run| run.common().picture_png.map(str::to_owned));
    picture.map(|png| Part::Picture(png, alt.to_owned())).into_iter().collect()
}

/// The verdict of a figure with which nothing is claimed: what is to be said of it, if it was measured.
pub(crate) fn without_claim(because: Option<String>) -> Verdict {
    because.map_or_else(Verdict::not_measured, Verdict::no_claim)
}
