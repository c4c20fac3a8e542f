//! The figures, from records alone: what each shows, what the report claims with it or about it, and whether that holds.
mod build;
mod lost;
mod pictures;
mod reference;
mod shading;
mod speed;
#[cfg(test)]
mod tests;
mod views;

use super::record::Run;
use super::select::Runs;
use crate::kit::figure::{Figure, Part, Table};
use crate::kit::text::short;

/// The last figure of the report.
pub(crate) const LAST_OF_REPORT: u32 = 14;

/// Every figure, in the order of their numbers.
pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let mut figures = pictures::figures(runs);
    figures.push(shading::figure(runs));
    figures.push(reference::figure(runs));
    figures.extend(speed::figures(runs));
    figures.extend(build::figures(runs));
    figures.extend(views::figures(runs));
    figures.push(lost::figure(runs));
    figures.sort_by_key(|figure| figure.number);
    figures
}

/// Frame rates and rays per second of some runs.
fn rates<'a>(runs: impl Iterator<Item = &'a Run>) -> Part {
    let head = [
        "where",
        "structure",
        "ms per frame",
        "frames per second",
        "at 1920×1080",
        "million rays per second",
    ];
    let row = |run: &Run| {
        vec![
            format!("{}, {}×{}", run.place(), run.width, run.height),
            run.structure.clone(),
            short(run.frame_ms),
            short(run.fps),
            short(run.fps_of_report()),
            short(1e-6 * run.rays_per_sec),
        ]
    };
    Part::Table(Table { head: head.map(str::to_owned).to_vec(), rows: runs.map(row).collect() })
}

/// `12.3 on the CPU`, as it would be at the report's size.
fn rate_text(run: &Run) -> String {
    format!("{} on the {} ({})", short(run.fps_of_report()), run.place(), run.structure)
}
