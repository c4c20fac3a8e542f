//! The table at the top of the page: the machine, and what came out.
use super::record::Sweep;
use super::select::{NAIVE, OURS, REPORTS, Runs, backend_name};
use crate::kit::figure::{Figure, Table};
use crate::kit::page::{machine_rows, tally};
use crate::kit::text::{count, percent, short, times};
use crate::kit::verdict::crossover_text;

/// What is known in a few lines.
pub(crate) fn summary(runs: &Runs<'_>, figures: &[Figure]) -> Table {
    let mut rows = machine_rows(runs);
    let mut row = |name: &str, value: String| rows.push(vec![name.to_owned(), value]);
    let counts = runs.of(Sweep::Counts);
    for backend in counts.backends() {
        for (name, value) in findings(&counts.on(backend), &runs.of(Sweep::Mixed).on(backend)) {
            row(&format!("{} on the {}", name, backend_name(backend)), value);
        }
    }
    row("Claims", tally(figures));
    Table { head: Vec::new(), rows }
}

/// Crossover, advantage, price of the heuristic and the fastest structure of a backend.
fn findings(on: &Runs<'_>, mixed: &Runs<'_>) -> Vec<(&'static str, String)> {
    let mut found = Vec::new();
    let small = on.filter(|run| run.spheres <= 2000);
    for (name, structure) in [
        ("Crossover: our octree becomes faster than naive", OURS),
        ("Crossover: the report's octree becomes faster than naive", REPORTS),
    ] {
        let noise = |count: u32| small.noise_between(structure, NAIVE, &[count]);
        found.push((name, crossover_text(noise, &small.ratios(structure, NAIVE), "spheres")));
    }
    let advantage = small.ratios(OURS, NAIVE);
    if let Some((spheres, ratio)) = advantage.last() {
        found.push((
            "Our octree against naive",
            format!("{} at {} spheres", times(*ratio), count(u64::from(*spheres))),
        ));
    }
    let wrong = on.iter().chain(mixed.iter()).filter_map(|run| Some((run.wrong_pixels?, run)));
    if let Some((most, run)) = wrong.max_by(|a, b| a.0.total_cmp(&b.0)) {
        let of = if run.sweep == Sweep::Mixed { mixed } else { on };
        let ratios = of.ratios(REPORTS, OURS);
        let against = ratios.into_iter().find(|(count, _)| *count == run.spheres);
        let speed =
            against.map_or_else(String::new, |(_, ratio)| format!(", at {} the speed of ours", times(ratio)));
        let sizes = if run.sweep == Sweep::Mixed { " of mixed sizes" } else { "" };
        let rays = run
            .wrong_rays
            .map_or_else(String::new, |rays| format!("; {} of rays from anywhere", percent(rays)));
        found.push((
            "Wrong pixels of the report's heuristic",
            format!(
                "up to {} ({} spheres{sizes}){speed}{rays}",
                percent(most),
                count(u64::from(run.spheres))
            ),
        ));
    }
    if let Some(largest) = on.counts().last() {
        let at = on.at(*largest);
        if let Some(fastest) =
            at.filter(|run| run.structure != REPORTS).iter().min_by(|a, b| a.frame_ms.total_cmp(&b.frame_ms))
        {
            found.push((
                "Fastest exact structure",
                format!(
                    "{} at {} spheres: {} ms per frame, {} million rays per second",
                    fastest.structure,
                    count(u64::from(*largest)),
                    short(fastest.frame_ms),
                    short(1e-6 * fastest.rays_per_sec)
                ),
            ));
        }
    }
    found
}
