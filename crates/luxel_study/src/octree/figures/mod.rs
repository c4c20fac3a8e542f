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

use super::record::Run;
use super::select::{Runs, backend_name};
use crate::kit::chart::{Chart, Ink, Kind, Series};
use crate::kit::draw::{count_names, ratio_table, series, structure_ink, structure_lines};
use crate::kit::figure::{Figure, Part};
use crate::kit::verdict::{AtCount, Noise};

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

/// The colour of a depth.
fn depth_ink(depth: u32) -> Ink {
    Ink::scale(f64::from(depth) / DEEPEST_INK)
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

    /// How far the ratios to a structure at some counts may be off.
    fn noise(&self, runs: &Runs<'_>, slow: &str, counts: &[u32]) -> Noise {
        runs.on(&self.backend).noise_between(self.structure, slow, counts)
    }

    fn line(&self, counts: &[u32]) -> Series {
        series(self.name(), structure_ink::<Run>(self.structure, &self.backend), counts, |count| {
            self.at(count)
        })
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
